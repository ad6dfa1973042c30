"""Building blocks of a self-contained HTML page: text, tables, figures, code."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

__all__ = ["bullets", "code", "figure", "page", "paragraph", "section", "table", "values"]

_STYLE = """
:root { color-scheme: light dark; --ink: #1d232b; --soft: #5a6572; --line: #d9dee4; --paper: #ffffff; --wash: #f4f6f8;
  --link: #0b5c94; --good: #1c6b45; --bad: #a3341f; --open: #6b5310; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e8ec; --soft: #a3adb8; --line: #3a424b; --paper: #16191d;
  --wash: #20252b; --link: #7cc0ee; --good: #74cfa2; --bad: #f19c86; --open: #e0c268; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.55 system-ui, "Segoe UI", Roboto,
  "Helvetica Neue", Arial, sans-serif; }
main { max-width: 62rem; margin: 0 auto; padding: 1.5rem 1.25rem 4rem; }
h1 { font-size: 1.45rem; line-height: 1.35; font-weight: 650; margin: 1rem 0 .6rem; }
h2 { font-size: 1.15rem; margin: 2.6rem 0 .6rem; padding-top: .6rem; border-top: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.6rem 0 .4rem; }
p { margin: .5rem 0; max-width: 46rem; }
a { color: var(--link); }
.soft, figcaption { color: var(--soft); font-size: .92rem; }
nav { font-size: .92rem; } nav a { margin-right: 1rem; white-space: nowrap; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; line-height: 1.45; }
th, td { text-align: left; vertical-align: top; padding: .42rem .7rem .42rem 0; border-bottom: 1px solid var(--line);
  overflow-wrap: break-word; font-variant-numeric: tabular-nums; }
th { color: var(--soft); font-weight: 600; }
td:first-child { font-weight: 600; }

td.good, td.bad, td.open { min-width: 6.2rem; }
.good { color: var(--good); font-weight: 600; } .bad { color: var(--bad); font-weight: 600; }
.open { color: var(--open); font-weight: 600; }
figure { margin: 1.2rem 0 2rem; }
figure img { display: block; max-width: 100%; height: auto; background: #fff; border: 1px solid var(--line);
  border-radius: 6px; padding: 6px; }
figcaption { margin-top: .4rem; max-width: 46rem; }
pre { background: var(--wash); border: 1px solid var(--line); border-radius: 6px; padding: .8rem; overflow-x: auto;
  font: .82rem/1.45 ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
details { margin: .5rem 0; } summary { cursor: pointer; font-weight: 600; }
@media (max-width: 46rem) { main { padding: 1rem .9rem 3rem; } thead { display: none; }
  tr { display: block; padding: .5rem 0; border-bottom: 1px solid var(--line); }
  td { display: block; border: 0; padding: .12rem 0; } td:empty { display: none; }
  td[data-label]:not(:first-child)::before { content: attr(data-label) ": "; color: var(--soft); font-weight: 400; } }
@media print { pre, figure { break-inside: avoid; } nav { display: none; } }
"""


_QUANTITY = re.compile(r"(?<=\d) (?=(?:[µnmk]?m|k?N|[mk]?J|Hz|deg|ms|s|%|GPa|MPa)(?![\w]))")


def escape(text: str) -> str:
    """Text for a page: markup escaped, no line break between a number and its unit."""
    return _QUANTITY.sub("\N{NO-BREAK SPACE}", html.escape(text))


def page(title: str, lead: str, body: Sequence[str]) -> str:
    """A whole page; `lead` is its first sentence."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{escape(lead)}</h1>\n"
        + "\n".join(body)
        + "\n</main>\n</body>\n</html>\n"
    )


def section(name: str, title: str, *parts: str) -> str:
    """A titled section with an anchor."""
    return f'<section id="{escape(name)}">\n<h2>{escape(title)}</h2>\n' + "\n".join(parts) + "\n</section>"


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph of plain text."""
    style = f' class="{kind}"' if kind else ""
    return f"<p{style}>{escape(text)}</p>"


def bullets(texts: Sequence[str]) -> str:
    """A list of plain texts."""
    return "<ul>" + "".join(f"<li>{escape(text)}</li>" for text in texts) + "</ul>"


def code(text: str, title: str | None = None) -> str:
    """Text as it is; folded away under a title if there is one."""
    block = f"<pre>{escape(text)}</pre>"
    return block if title is None else f"<details><summary>{escape(title)}</summary>{block}</details>"


def table(head: Sequence[str], rows: Sequence[Sequence[str]], marks: Mapping[str, str] | None = None) -> str:
    """A table of plain text; `marks` gives a style (good, bad, open) to cells by their text."""
    marks = marks or {}
    top = "".join(f"<th>{escape(name)}</th>" for name in head)
    lines = ["".join(_cell(text, label, marks) for text, label in zip(row, head, strict=True)) for row in rows]
    body = "".join(f"<tr>{line}</tr>\n" for line in lines)
    return f"<table><thead><tr>{top}</tr></thead>\n<tbody>\n{body}</tbody></table>"


def _cell(text: str, label: str, marks: Mapping[str, str]) -> str:
    style = f' class="{marks[text]}"' if text in marks else ""
    return f'<td data-label="{escape(label)}"{style}>{escape(text)}</td>'


def values(pairs: Mapping[str, object]) -> str:
    """Names and values, a row each."""
    rows = "".join(f"<tr><td>{escape(name)}</td><td>{escape(str(value))}</td></tr>\n" for name, value in pairs.items())
    return f"<table><tbody>\n{rows}</tbody></table>"


def figure(title: str, png: Path) -> str:
    """A picture with its title, held in the page itself."""
    data = base64.b64encode(png.read_bytes()).decode("ascii")
    return (
        f'<figure><img alt="{escape(title)}" src="data:image/png;base64,{data}">'
        f"<figcaption>{escape(title)}</figcaption></figure>"
    )
