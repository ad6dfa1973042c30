"""Labels of equations in text, (T3.4): each leads to its formula."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

from docs.site.katex import TAG
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util import logging

LABEL = re.compile(r"\((T\d+\.\d+[a-z]?)\)")


@cache
def places() -> dict[str, str]:
    """The page of each label, as Sphinx names it."""
    theory = Path(__file__).parents[1] / "theory"
    return {tag: f"theory/{p.stem}" for p in theory.glob("T*.md") for tag in TAG.findall(p.read_text(encoding="utf-8"))}


def linked(app: Sphinx, doctree: Any, docname: str) -> None:
    """Turn labels in the text of a page into links."""
    for text in list(doctree.findall(nodes.Text)):
        apart = (nodes.math, nodes.math_block, nodes.literal_block, nodes.reference, nodes.title)
        if not LABEL.search(text) or any(isinstance(x, apart) for x in _above(text)):
            continue
        pieces: list[Any] = []
        for i, piece in enumerate(LABEL.split(text)):
            if i % 2 == 0:
                pieces.append(nodes.Text(piece))
                continue
            if piece not in places():
                logging.getLogger(__name__).warning("no equation has the label %s", piece, location=text)
            page = places().get(piece, docname)
            address = "" if page == docname else app.builder.get_relative_uri(docname, page)
            link = nodes.reference("", f"({piece})", internal=True, refuri=f"{address}#{piece}", classes=["equation"])
            pieces.append(link)
        text.parent.replace(text, pieces)


def _above(node: Any) -> Any:
    while node is not None:
        yield node
        node = node.parent


def setup(app: Sphinx) -> dict[str, object]:
    """Register with Sphinx."""
    app.connect("doctree-resolved", linked)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
