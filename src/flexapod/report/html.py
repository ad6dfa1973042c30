"""Building blocks of a self-contained HTML page: text, tables, code, figures that zoom, a replay."""

from __future__ import annotations

import base64
import html
import json
import re
import zlib
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files

# What a browser may do with a page: run and show what is in it, and fetch nothing.
_POLICY = (
    "default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; font-src data:; "
    "base-uri 'none'; form-action 'none'"
)
_QUANTITY = re.compile(
    r"(?<=\d) (?=(?:[µnmkc]?m|[kM]?N|[mk]?J|Hz|deg|ms|s|%|GPa|MPa)(?![\w]))|(?<=\d N) (?=m²?(?!\w)|s/m)"
    r"|(?<=\b[xyz]) (?=\d)"
)


def escape(text: str) -> str:
    """Text for a page: markup escaped, no line break between a number and its unit, nor an axis and its number."""
    return _QUANTITY.sub("\N{NO-BREAK SPACE}", html.escape(text))


def page(title: str, lead: str, body: Sequence[str]) -> str:
    """A whole page; `lead` is its first sentence. Figures that zoom bring their library with them."""
    inner = "\n".join(body)
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
    return files("flexapod.report").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def library() -> str:
    """The script of plotly, deflated, in base64: 2 MB in place of 4.8; the last 4 % of that would double the time."""
    script = files("plotly").joinpath("package_data", "plotly.min.js").read_bytes()
    return base64.b64encode(zlib.compress(script, 4)).decode("ascii")


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


def remarks(texts: Sequence[tuple[str, str]]) -> str:
    """A list of remarks: what each says, and folded away behind it what explains it."""
    items = (
        f"<li><details><summary>{escape(first)}</summary>{escape(rest)}</details></li>" if rest
        else f"<li>{escape(first)}</li>"
        for first, rest in texts
    )  # fmt: skip
    return "<ul>" + "".join(items) + "</ul>"


def code(text: str, title: str | None = None) -> str:
    """Text as it is; folded away under a title if there is one."""
    name = escape(title or "Text")  # long lines are scrolled, by keys too
    block = f'<pre tabindex="0" role="group" aria-label="{name}">{html.escape(text)}</pre>'  # every space as it is
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


def heading(text: str) -> str:
    """A title within a section."""
    return f"<h3>{escape(text)}</h3>"


def contents(links: Mapping[str, str]) -> str:
    """Links to the sections of a page: words by anchor."""
    inner = " ".join(f'<a href="#{escape(anchor)}">{escape(words)}</a>' for anchor, words in links.items())
    return f'<nav aria-label="Contents">{inner}</nav>'


def figure(title: str, png: bytes, plot: Mapping[str, object] | None = None) -> str:
    """A picture with its title, held in the page itself; with `plot` (from `interactive`) scripts can zoom it."""
    image, caption = _image(title, png), f"<figcaption>{escape(title)}</figcaption>"
    tall = ["tall"] * _is_tall(png)
    if plot is None:
        return f"<figure{_classes(tall)}>{image}{caption}</figure>"
    keys = "Plus and minus zoom, arrow keys move along the horizontal axis, 0 shows all"
    return f"<figure{_classes(['chart', *tall])}>{image}{_plot(title, keys)}{caption}{_json(plot)}</figure>"


def replay(title: str, told: Mapping[str, object], still: tuple[str, bytes] | None = None) -> str:
    """A moving picture with its controls; `told` is from `flexapod.report.replay.replay`.

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
    return f'<figure class="replay">{image}{_plot(title, keys)}{controls}{words}{_json(told)}</figure>'


def _classes(names: Sequence[str]) -> str:
    return f' class="{" ".join(names)}"' if names else ""


def _is_tall(png: bytes) -> bool:
    """Whether a picture would be too small on half a printed page; its size is at the head of its file."""
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
