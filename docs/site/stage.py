"""The sources of the site: pages of the repository, links led to where things lie in it, pages made of tables."""

from __future__ import annotations

import re
import shutil
from os.path import normpath, relpath
from pathlib import Path

from docs.site import commands, gallery, python, studyfile, variables

ROOT = Path(__file__).parents[2]
#: Pages that lie outside of docs/, with their places in the site.
OUTSIDE = {
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "benchmarks/RESULTS.md": "benchmarks.md",
}
#: Pages that the site makes anew of the same source.
ANEW = {"docs/study-file.md": "reference/study-file/index.md", "docs/gallery.md": "gallery/index.md"}
LINK = re.compile(r"\[([^\]\n]*)\]\((?!https?:|mailto:|#)([^)#\s]+)(#[^)\s]*)?\)")
MADE = (gallery.pages, studyfile.pages, commands.pages, variables.pages, python.pages)


def staged(folder: Path) -> Path:
    """Write all sources into a folder; what has not changed keeps its date, so that Sphinx builds only what is new."""
    written: set[Path] = set()
    pages = {path: path.relative_to(ROOT / "docs") for path in sorted((ROOT / "docs").rglob("*.md"))}
    pages |= {ROOT / name: Path(place) for name, place in OUTSIDE.items()}
    for name in ANEW:
        pages.pop(ROOT / name)
    for path, place in pages.items():
        files: set[Path] = set()
        text = _relinked(path.read_text(encoding="utf-8"), path, place, files)
        written.add(_write(folder / place, text))
        written |= {_copy(file, folder / "files" / file.relative_to(ROOT)) for file in files}
    for make in MADE:
        written |= {_write(folder / place, text) for place, text in make().items()}
    written |= gallery.pictures(folder)
    notebooks = ROOT / "src" / "flexapod" / "examples/notebooks"
    written |= {_copy(path, folder / "notebooks" / path.name) for path in notebooks.glob("*.py")}
    for image in (ROOT / "docs").rglob("*.png"):
        written.add(_copy(image, folder / image.relative_to(ROOT / "docs")))
    for old in set(folder.rglob("*.*")) - written:
        if old.is_file():
            old.unlink()
    return folder


def _relinked(text: str, page: Path, place: Path, files: set[Path]) -> str:
    def led(found: re.Match[str]) -> str:
        words, link, anchor = found[1], found[2], found[3] or ""
        target = (page.parent / link).resolve()
        if not target.exists():
            return found[0]  # Sphinx complains
        name = target.relative_to(ROOT).as_posix()
        if target.is_dir():
            return f"[{words}]({_to(place, f'{target.name}/index.md')})" if (target / "index.md").exists() else words
        if name in OUTSIDE | ANEW:
            return f"[{words}]({_to(place, (OUTSIDE | ANEW)[name])}{anchor})"
        if name.startswith("docs/"):
            return f"[{words}]({_to(place, name.removeprefix('docs/'))}{anchor})"
        if target.parent == gallery.EXAMPLES:
            return f"[{words}]({_to(place, f'gallery/{target.stem}.md')})"
        files.add(target)
        return f"[{words}]({_to(place, f'files/{name}')})"

    text = re.sub(r"^(\S+\*)(?=\n```)", lambda found: _named(found[1], page), text, flags=re.MULTILINE)
    parts = re.split(r"(^```.*?^```)", text, flags=re.MULTILINE | re.DOTALL)
    return "".join(part if part.startswith("```") else LINK.sub(led, part) for part in parts)


def _named(pattern: str, page: Path) -> str:
    """The pages of a pattern in a table of contents, one a line, T9 before T10."""
    names = {path.stem for path in page.parent.glob(f"{pattern}.md")}
    return "\n".join(sorted(names, key=lambda name: [int(x) if x.isdigit() else x for x in re.split(r"(\d+)", name)]))


def _to(page: Path, place: str) -> str:
    return Path(relpath(place, page.parent)).as_posix()


def to_root(page: str, name: str) -> str:
    """A page that another one names, from the root of the site."""
    return Path(normpath(Path(page).parent / name)).as_posix()


def _write(path: Path, text: str) -> Path:
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return path


def _copy(source: Path, path: Path) -> Path:
    if not path.exists() or path.read_bytes() != source.read_bytes():
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, path)
    return path
