"""Items of `parts` as a self-contained HTML page: text, tables, code; figures that zoom, a replay."""

from __future__ import annotations

import base64
import html
import json
import re
import zlib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files
from itertools import repeat
from pathlib import Path

from flexapod.common.quantities import brief
from flexapod.mechanics.symbolic.cache import kept_text
from flexapod.output.text.parts import Bullets, Chapter, Item, Lines, Remarks, Text, TextTable

# What a browser may do with a page: run and show what is in it, and fetch nothing.
_POLICY = (
    "default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; font-src data:; "
    "base-uri 'none'; form-action 'none'"
)
LEVEL = 4  # of deflating
_QUANTITY = re.compile(
    r"(?<=\d) (?=(?:[µnmkc]?m|[kM]?N|[mk]?J|Hz|deg|ms|s|%|GPa|MPa)(?![\w]))|(?<=\d N) (?=m²?(?!\w)|s/m)"
    r"|(?<=\b[xyz]) (?=\d)"
)


def escape(text: str) -> str:
    """Text for a page: markup escaped, no line break between a number and its unit, nor an axis and its number."""
    return _QUANTITY.sub("\N{NO-BREAK SPACE}", html.escape(text))


def page(title: str, lead: str, body: Iterable[Item]) -> str:
    """A whole page; `lead` is its first sentence. Figures that zoom bring their library with them."""
    inner = parts(body)
    script = f'<script type="text/plain" id="plotly">{library()}</script>\n' if 'class="plot"' in inner else ""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{_asset('report.css')}</style>\n</head>\n<body>\n"
        f'<main>\n<h1>{escape(lead)}</h1>\n<button id="theme" type="button" hidden>Dark page</button>\n'
        f"{inner}\n</main>\n{script}<script>\n{_asset('report.js')}</script>\n</body>\n</html>\n"
    )


def _asset(name: str) -> str:
    return files("flexapod.output.text").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def library() -> str:
    """The script of plotly, deflated, in base64: 2 MB in place of 4.8; the last 4 % of that would double the time.

    It is kept from one process to the next.
    """
    place = Path(str(files("plotly").joinpath("package_data", "plotly.min.js")))
    found = place.stat()
    return kept_text(f"{place} {found.st_size} {found.st_mtime_ns} {LEVEL}", lambda: _deflated(place.read_bytes()))


def _deflated(script: bytes) -> str:
    return base64.b64encode(zlib.compress(script, LEVEL)).decode("ascii")


class Html(str):
    """Text that is markup already: a figure, a replay, links, a section."""


def parts(told: Iterable[Item]) -> str:
    """Markup of items, a block each; an inner section has a smaller title and is left out if it is empty."""
    return "\n".join(filter(None, map(_part, told)))


def _part(item: Item) -> str:
    match item:
        case Html():
            return item
        case str():
            return f"<p>{escape(item)}</p>"
        case Text():
            return f'<p class="{item.kind}">{escape(item.words)}</p>'
        case TextTable():
            return _table(item)
        case Bullets():
            return "<ul>" + "".join(f"<li>{escape(text)}</li>" for text in item.lines) + "</ul>"
        case Remarks():
            return "<ul>" + "".join(map(_remark, item.lines)) + "</ul>"
        case Lines():
            return _lines(item)
        case Chapter():
            inner = parts(item.items)
            return f"<h3>{escape(item.title)}</h3>\n{inner}" if inner else ""


def section(name: str, title: str, told: Iterable[Item]) -> Html:
    """A titled section with an anchor."""
    return Html(f'<section id="{escape(name)}">\n<h2>{escape(title)}</h2>\n{parts(told)}\n</section>')


def _remark(text: str) -> str:
    """Markup of a remark: its first sentence, and its explanation folded away behind it."""
    first, rest = map(escape, brief(text))
    return f"<li><details><summary>{first}</summary>{rest}</details></li>" if rest else f"<li>{first}</li>"


def _lines(lines: Lines) -> str:
    """Text as it is; long lines are scrolled, by keys too."""
    title = escape(lines.title)
    block = f'<pre tabindex="0" role="group" aria-label="{title or "Text"}">{html.escape(lines.text)}</pre>'
    return f"<details><summary>{title}</summary>{block}</details>" if title else block


def _table(table: TextTable) -> str:
    head = [table.of.capitalize(), *table.head] if table.of else table.head
    top = "".join(f"<th>{escape(name)}</th>" for name in head)
    labels = [f' data-label="{escape(name)}"' for name in head] or [""] * max(map(len, table.rows), default=0)
    rows = "".join(f"<tr>{''.join(map(_cell, row, labels, repeat(table.marks)))}</tr>\n" for row in table.rows)
    return f"<table>{f'<thead><tr>{top}</tr></thead>' if head else ''}\n<tbody>\n{rows}</tbody></table>"


def _cell(text: str, label: str, marks: Mapping[str, str]) -> str:
    style = f' class="{marks[text]}"' if text in marks else ""
    return f"<td{label}{style}>{escape(text)}</td>"


def contents(links: Mapping[str, str]) -> Html:
    """Links to the sections of a page: words by anchor."""
    inner = " ".join(f'<a href="#{escape(anchor)}">{escape(words)}</a>' for anchor, words in links.items())
    return Html(f'<nav aria-label="Contents">{inner}</nav>')


def figure(title: str, png: bytes, plot: Mapping[str, object] | None = None) -> Html:
    """A picture with its title, held in the page itself; with `plot` (from `plotly_figure`) scripts can zoom it."""
    image, caption = _image(title, png), f"<figcaption>{escape(title)}</figcaption>"
    tall = ["tall"] * _is_tall(png)
    if plot is None:
        return Html(f"<figure{_classes(tall)}>{image}{caption}</figure>")
    keys = "Plus and minus zoom, arrow keys move along the horizontal axis, 0 shows all"
    return Html(f"<figure{_classes(['chart', *tall])}>{image}{_plot(title, keys)}{caption}{_json(plot)}</figure>")


def replay(title: str, told: Mapping[str, object], still: tuple[str, bytes] | None = None) -> Html:
    """A moving picture with its controls; `told` is from `flexapod.output.report.replay.replay`.

    `still`: title and picture (PNG) that stand in its place on paper and where no scripts run.
    """
    keys = "Space plays and stops, arrow keys step, Home and End go to the ends"
    controls = (
        '<div class="controls"><button type="button" data-part="play" aria-pressed="false">Play</button>'
        '<input type="range" data-part="scrub" aria-label="Time"><label>Speed '
        '<select data-part="speed"><option value="0.1">0.1 x</option><option value="0.25" selected>0.25 x</option>'
        '<option value="1">1 x</option></select></label><label>Shown <select data-part="choice">'
        '<option value="-1">Motion</option></select></label></div><p data-part="readout"></p>'
    )
    image = "" if still is None else _image(*still)
    words = f'<figcaption class="moving">{escape(title)}</figcaption>'
    words += "" if still is None else f'<figcaption class="still">{escape(still[0])}</figcaption>'
    return Html(f'<figure class="replay">{image}{_plot(title, keys)}{controls}{words}{_json(told)}</figure>')


def _classes(names: Sequence[str]) -> str:
    return f' class="{" ".join(names)}"' if names else ""


def _is_tall(png: bytes) -> bool:
    """Test whether a picture would be too small on half a printed page, from the size at the head of its file."""
    width, height = (int.from_bytes(png[at : at + 4], "big") for at in (16, 20))
    return height > 0.9 * width


def _image(title: str, png: bytes) -> str:
    data = base64.b64encode(png).decode("ascii")
    return f'<img alt="{escape(title)}" src="data:image/png;base64,{data}">'


def _plot(title: str, keys: str) -> str:
    words = escape(f"{title.rstrip('.')}. {keys}.")
    return f'<div class="plot" hidden tabindex="0" role="group" aria-label="{words}"></div>'


def _json(value: Mapping[str, object]) -> str:
    """Data in a page; no text in them can end their element."""
    text = json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    return f'<script type="application/json">{text}</script>'
