"""The documentation names only what exists: links, files, chapters."""

import re
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

from flexapod.common.version import __version__

pytestmark = pytest.mark.meta

ROOT = Path(__file__).parents[2]
PAGES = sorted([*(ROOT / "docs").rglob("*.md"), *ROOT.glob("*.md")])
LINK = re.compile(r"\]\((?!https?://|mailto:|#)([^)#\s]+)")
CODE = re.compile(r"`([\w./-]+\.(?:py|c|h|toml|md)|[\w-]+/)`")
ROOTS = (ROOT, ROOT / "src" / "flexapod", ROOT / "src" / "flexapod" / "solve", ROOT / "docs", ROOT / "tests")
EXAMPLES = {"study.toml", "robot.toml", "NAME.toml", "SWEEP.toml"}  # files of users


def name(page):
    return str(page.relative_to(ROOT))


def exists(path, page):
    if "/" in path:
        return any((root / path).exists() for root in (*ROOTS, page.parent))
    sources = (ROOT / "src" / "flexapod", ROOT / "tests", ROOT / "docs")
    return (ROOT / path).exists() or any(next(root.rglob(path), None) for root in sources)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    broken = [link for link in LINK.findall(text) if not (page.parent / link).exists()]
    assert not broken


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_files_that_are_named_exist(page):
    named = set(CODE.findall(page.read_text(encoding="utf-8"))) - EXAMPLES
    ours = [path for path in sorted(named) if not path.startswith("DIR/")]  # results in a folder of the user's choice
    assert not [path for path in ours if not exists(path, page)]


def test_every_chapter_is_in_the_table_of_contents():
    contents = (ROOT / "docs" / "theory" / "T0-notation.md").read_text(encoding="utf-8")
    chapters = [page.name for page in (ROOT / "docs" / "theory").glob("T*.md") if not page.name.startswith("T0")]
    assert len(chapters) >= 9
    assert not [chapter for chapter in chapters if f"({chapter})" not in contents]


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "theory").glob("T*.md")), ids=name)
def test_a_chapter_tags_only_its_own_equations(page):
    chapter = page.name.split("-")[0]
    tags = re.findall(r"\\tag\{(T\d+)\.\d+[a-z]?\}", page.read_text(encoding="utf-8"))
    assert set(tags) <= {chapter}


@pytest.mark.parametrize("page", sorted((ROOT / "docs").rglob("*.md")), ids=name)
def test_equations_that_are_referred_to_exist(page):
    pages = (ROOT / "docs" / "theory").glob("*.md")
    tagged = {tag for p in pages for tag in re.findall(r"\\tag\{(T\d+\.\d+[a-z]?)\}", p.read_text(encoding="utf-8"))}
    used = set(re.findall(r"\((T\d+\.\d+[a-z]?)\)", page.read_text(encoding="utf-8")))
    assert not sorted(used - tagged)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_formulas_show_on_github(page):
    """GitHub refuses some macros, and reads Markdown before mathematics."""
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    displayed = re.findall(r"\$\$(.*?)\$\$", text, flags=re.DOTALL)
    inline = [line for line in re.sub(r"\$\$.*?\$\$", "", text, flags=re.DOTALL).splitlines() if "$" in line]
    assert text.count("$$") % 2 == 0
    assert not re.findall(r"\\(?:operatorname|mbox|def|newcommand)\b", text)  # refused
    assert not [f for f in displayed if re.search(r"\n\s*\n|\n\s*[-+*] ", f)]  # a new paragraph, a list
    assert not [line for line in inline if line.count("$") % 2]  # a formula does not go over a line's end
    emphasis = {"em_open", "strong_open"}  # underscores that Markdown would take for italics: use a fence ```math
    assert not [f for f in displayed if emphasis & {x.type for x in MarkdownIt().parseInline(f)[0].children or ()}]
    formulas = [f for line in inline for f in re.findall(r"\$([^$]*)\$", line)]
    assert not [f for f in formulas if f != f.strip() or re.search(r"\\[,;:!{}]|\\tag", f)]  # backslashes are eaten


def test_the_readme_is_read_in_a_minute():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 100


def test_the_recipe_cites_what_the_repository_says():
    said = (ROOT / "docs" / "how-to" / "cite.md").read_text(encoding="utf-8")
    stated = dict(
        re.findall(r'^([\w-]+): "?(.*?)"?$', (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    )
    assert stated["version"] == __version__
    for name in ("title", "version", "license"):
        assert f"{name} = {{{stated[name]}}}" in said


def test_every_source_package_is_in_the_folder_map():
    text = (ROOT / "docs" / "ARCHITECTURE.md").read_text(encoding="utf-8")
    packages = [p.parent.name for p in (ROOT / "src" / "flexapod").glob("*/__init__.py")]
    assert len(packages) >= 8
    assert not [package for package in packages if f"`{package}/`" not in text]


def test_the_pattern_finds_files():
    assert CODE.findall("see `solve/time/march.py`, `model/` and `names.py`, not `v_dot`") == [
        "solve/time/march.py",
        "model/",
        "names.py",
    ]


PROGRAMS = sorted((ROOT / "src" / "flexapod" / "examples").rglob("*.py"))
SURGERY = re.compile(
    r"source_text(\.replace|\[|\s*\+)|(?<!\w)(\w+) = [^\n]*source_text\n(?:.*\n)*?.*\b\2(\.replace|\[|\.index)"
)


@pytest.mark.parametrize("path", [*PAGES, *PROGRAMS], ids=name)
def test_nobody_changes_a_study_by_cutting_its_text(path):
    """A text that is replaced by another one in a file that does not hold it does nothing, and says nothing."""
    if path.name != "messages.md":  # which shows what a wrong text is told
        assert not SURGERY.search(path.read_text(encoding="utf-8")), "use study.with_values"
