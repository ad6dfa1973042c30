"""What the theme leaves open: names for its arrows, and a look whether a page would load anything from elsewhere."""

from __future__ import annotations

import re
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util import logging

LOADED = re.compile(
    r"""<(?:script|img|iframe|source)\b[^>]*\bsrc="(?:https?:)?//|<link\b(?![^>]*canonical)[^>]*href="(?:https?:)?//"""
)
ARROW = '<summary><span class="toctree-toggle"'


def finished(app: Sphinx, exception: Exception | None) -> None:
    """Look through all pages that were written."""
    if exception is not None:
        return
    for path in Path(app.outdir).rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        if found := LOADED.search(text):
            logging.getLogger(__name__).warning("%s loads what lies outside of the site: %s", path.name, found[0])
        if ARROW in text:
            named = ARROW.replace("<summary>", '<summary aria-label="Pages of this part">')
            path.write_text(text.replace(ARROW, named), encoding="utf-8")


def setup(app: Sphinx) -> dict[str, object]:
    """Register with Sphinx."""
    app.connect("build-finished", finished)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
