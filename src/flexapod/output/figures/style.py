"""House style of all figures: colours that colour-blind readers tell apart, units in labels, width, files.

Figures are as wide as a page of a journal (170 mm); `save` writes them as wide as a column (85 mm), too.
Letters have the size at which they are read, 7 points at least. Rows of PNG files are not filtered: where most
of a figure is white they deflate as well.
"""

from __future__ import annotations

import logging
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import wraps
from numbers import Real
from pathlib import Path
from struct import pack
from typing import Any, ParamSpec, TypeVar

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, check_kind
from flexapod.common.files import path_of, replace_file
from flexapod.output.figures.column_width import resize_figure
from flexapod.output.figures.dual_renderer import Canvas, UnsupportedArtist, draw_both
from flexapod.output.figures.fast_axes import NOTE as NOTE
from flexapod.output.figures.fast_axes import SMALL as SMALL
from flexapod.output.figures.fast_axes import TEXT as TEXT
from flexapod.output.figures.fast_axes import Panels, cached_ticks, rc_settings

INCH = 0.0254  # [m]
LEVEL = 1  # of deflating: higher ones take longer for a few per cent
_RGB = 2  # kind of colours: red, green, blue of 8 bits each


def png(colors: NDArray[np.uint8], dpi: float, words: Mapping[str, str | None]) -> bytes:
    """A picture (row, column, at least red, green, blue) as a PNG file, with its dots per inch and words about it."""
    high, wide = colors.shape[:2]
    rows = np.zeros((high, 1 + 3 * wide), dtype=np.uint8)  # each begins with 0: no filter
    for part in range(3):  # a colour at a time: in a third of the time that pixels take
        rows[:, 1 + part :: 3] = colors[:, :, part]
    metre = round(dpi / INCH)
    said = (_part(b"tEXt", f"{key}\0{value}".encode("latin-1")) for key, value in words.items())
    return b"".join(
        [
            b"\x89PNG\r\n\x1a\n",
            _part(b"IHDR", pack(">IIBBBBB", wide, high, 8, _RGB, 0, 0, 0)),
            *said,
            _part(b"pHYs", pack(">IIB", metre, metre, 1)),
            _part(b"IDAT", zlib.compress(rows.data, LEVEL)),
            _part(b"IEND", b""),
        ]
    )


def _part(kind: bytes, data: bytes) -> bytes:
    return pack(">I", len(data)) + kind + data + pack(">I", zlib.crc32(kind + data))


P = ParamSpec("P")
T = TypeVar("T")

LINE_STYLES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (3, 1)), (0, (1, 3)), (0, (7, 2)))
COLORS = "cividis"  # of maps: even in lightness, and for colour-blind readers
COLUMN, PAGE = 3.35, 6.7  # widths of a column and of a page [in]: 85 and 170 mm

CONTRAST = 4.6  # of words; a little above what is asked for, as colours are rounded
FINEST, WIDEST = 2400, 2.0  # dots an inch, and [m]: a picture of more has no room in the memory
# What files say of themselves: no dates, so that the same figure is the same file.
_METADATA: dict[str, dict[str, str | None]] = {
    "png": {"Software": "flexapod"},
    "svg": {"Date": None, "Creator": "flexapod"},
    "pdf": {"CreationDate": None, "Creator": "flexapod", "Producer": None},
}


def figure(width: float = PAGE, height: float = 4.0, gap: float = 0.02) -> Figure:
    """Empty figure [in] on the Agg canvas, without pyplot's global state; `gap` between columns, as a share of one."""
    made = Panels(figsize=(width, height), layout=ConstrainedLayoutEngine(wspace=gap))
    Canvas(made)
    return made


def require_variables(*names: str) -> Callable[[Callable[P, Figure]], Callable[P, Figure]]:
    """Refuse a first argument that is no Dataset, or mapping of Datasets, with these variables, or has no instant.

    Without names any Dataset will do.
    """

    def decorate(draw: Callable[P, Figure]) -> Callable[P, Figure]:
        @wraps(draw)
        def draw_checked(*args: P.args, **kwargs: P.kwargs) -> Figure:
            given: Any = args[0] if args else next(iter(kwargs.values()), None)
            several = isinstance(given, Mapping) and not hasattr(given, "data_vars")
            for data in (given.values() or (None,)) if several else (given,):
                missing = [name for name in names if name not in getattr(data, "data_vars", ())]
                if not (missing or hasattr(data, "data_vars")):
                    what = f"cannot be drawn: it is a {type(data).__name__}"
                    raise InputError(what, key=draw.__name__.lstrip("_"), allowed="a result, a Dataset")
                if missing:
                    raise InputError(
                        f"cannot be drawn: the result has no {missing[0]!r}",
                        key=draw.__name__.lstrip("_"),
                        allowed=f"a result with {', '.join(names)}",
                    )
                if getattr(data, "sizes", {}).get("time") == 0:
                    raise InputError("has no instant", key="time", allowed="one at least")
            return draw(*args, **kwargs)

        return draw_checked

    return decorate


def house_style(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a figure in the house style, whatever the user's matplotlib settings."""

    @wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with matplotlib.rc_context(rc_settings()):
            return draw(*args, **kwargs)

    return wrapper


def share_flat_scale(panels: Sequence[Axes], sizes: Sequence[float]) -> None:
    """Give panels of `sizes` 0 the vertical limits of the panel of the largest: zero is drawn as a flat line."""
    limits = panels[max(range(len(panels)), key=lambda i: sizes[i])].get_ylim()
    for panel, size in zip(panels, sizes, strict=True):
        if size == 0 and max(sizes) > 0:
            panel.set_ylim(limits)


def cell_edges(centres: Array) -> Array:
    """Edges of cells around values (n,): half-way between neighbours, as wide beyond the first and the last."""
    if len(centres) == 1:
        return centres[0] + np.array([-0.5, 0.5])
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])


def legend_columns(entries: int, most: int = 6) -> int:
    """Columns of a legend with a number of entries: in one row, or in rows of about the same length."""
    rows = -(-entries // most)
    return -(-entries // rows)


def readable_color(color: str) -> str:
    """A colour for words on white: as it is, or darker, so that its contrast is 4.5 at least (WCAG 2.2, 1.4.3)."""
    red, green, blue = to_rgb(color)
    while 1.05 / (_luminance(red, green, blue) + 0.05) < CONTRAST:
        red, green, blue = (0.97 * part for part in (red, green, blue))
    return to_hex((red, green, blue))


def _luminance(*parts: float) -> float:
    """Relative luminance of an sRGB colour (WCAG 2.2)."""
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def mark_end(axes: Axes, instant: float | None, text: str = "") -> None:
    """Mark the end of the commanded motion by a fine line; with a word, on the first of a column, below its title."""
    if instant is None:
        return
    axes.axvline(instant, color="#888888", linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
    if text:
        place = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
        axes.set_title(axes.get_title(loc="left"), pad=15)
        axes.annotate(text, (instant, 1.0), xytext=(4, 3), va="bottom", fontsize=SMALL, color="#555555", **place)


def save(
    fig: Figure,
    stem: str | Path,
    *,
    dpi: int = 200,
    formats: Sequence[str] = ("png", "svg"),
    width: float | None = None,
) -> tuple[Path, ...]:
    """Write a figure as ``stem.png``, ``stem.svg``, ``stem.pdf``; existing files are replaced by complete ones.

    Parameters
    ----------
    fig : matplotlib.figure.Figure
    stem : path
        Without ending; the folder is made if needed.
    dpi : int
        Of the PNG file.
    formats : sequence of str
        Of png, svg, pdf.
    width : float, optional
        Width on paper [m], as 0.085 for a column: letters keep their size, panels beside each other go below each
        other, long titles and legends are broken. The figure itself stays as it is.

    Returns
    -------
    tuple of Path
        A file for each of `formats`, in their order.

    Raises
    ------
    InputError
        The folder cannot be made or written to, a format is unknown, or the width is not positive.
    """
    check_kind(fig, Figure, "fig", "a figure of matplotlib, as calls of flexapod.output.figures give it")
    stem = path_of(stem, "stem")
    if not stem.name:
        raise InputError("names no file", key="stem", value=str(stem), allowed='a name without ending, as "figure"')
    check_formats(formats)
    if isinstance(dpi, bool) or not isinstance(dpi, Real) or not 1 <= dpi <= FINEST:
        raise InputError("is not a number of dots", key="dpi", value=dpi, allowed=f"1 to {FINEST} an inch")
    if width is not None and (isinstance(width, bool) or not isinstance(width, Real) or not 0 < width <= WIDEST):
        raise InputError(
            "is not a width", key="width", value=width, allowed=f"above 0 m, as 0.085 or 0.17, up to {WIDEST:g} m"
        )
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    written = [stem.with_name(f"{stem.name}.{name}") for name in formats]
    with matplotlib.rc_context(rc_settings()):
        shown = fig if width is None else resize_figure(fig, width / INCH)
        with _laid_out(shown, dpi):
            _write(shown, dict(zip(formats, written, strict=True)), dpi)
    return tuple(written)


def _write(fig: Figure, files: Mapping[str, Path], dpi: int) -> None:
    """All files of a figure that has its places; picture and SVG file from one drawing, where they can be."""
    with ExitStack() as stack:
        places = {name: stack.enter_context(replace_file(path)) for name, path in files.items()}
        if "png" in places:
            svg = _draw(fig, places.get("svg"))
            picture = np.asarray(fig.canvas.buffer_rgba())  # type: ignore[attr-defined]  # of Agg
            places.pop("png").write_bytes(png(picture, dpi, _METADATA["png"]))
            if svg:
                del places["svg"]
        for name, place in places.items():
            fig.savefig(place, dpi=dpi, format=name, metadata=_METADATA[name])


def _draw(fig: Figure, svg: Path | None) -> bool:
    """Draw a figure on its canvas of Agg, and into an SVG file on the way; whether that could be done."""
    canvas, face = fig.canvas, fig.get_facecolor()
    fig.set_facecolor(matplotlib.rcParams["savefig.facecolor"])
    try:
        with suppress(UnsupportedArtist):
            if svg is not None:
                draw_both(fig, svg, _METADATA["svg"])
                return True
        canvas.draw()
    finally:
        fig.set_facecolor(face)
    return False


def check_formats(formats: Sequence[str]) -> None:
    """Refuse formats of figures that are unknown, and none.

    Raises
    ------
    InputError
    """
    check_kind(formats, (list, tuple), "formats", f"a list of {', '.join(_METADATA)}")
    unknown = [name for name in formats if not isinstance(name, str) or name not in _METADATA]
    if unknown or not formats:
        value = unknown[0] if unknown else "none"
        raise InputError("is not a format of figures", key="formats", value=value, allowed=", ".join(_METADATA))


@contextmanager
def _laid_out(fig: Figure, dpi: float) -> Iterator[None]:
    """The figure on a canvas of Agg with its places found, once for all of its files: that takes as long as drawing."""
    engine, before = fig.get_layout_engine(), fig.dpi
    if type(fig.canvas) is not Canvas:
        Canvas(fig)
    fig.dpi = dpi  # widths of letters depend on it a little
    with cached_ticks(fig):
        try:
            if engine is not None:
                engine.execute(fig)
            fig.set_layout_engine(None)
            yield
        finally:
            fig.set_layout_engine(engine)
            fig.dpi = before
