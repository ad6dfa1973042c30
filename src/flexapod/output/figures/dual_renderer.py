"""One drawing that becomes a picture and an SVG file: artists draw once, and words are laid out once in a process.

Matplotlib sets each word anew for each figure, and the size of a font anew for each letter, which makes its
hints anew. What is drawn is the same. Formulas, rotated words and versions of matplotlib that draw otherwise
are left to it.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from matplotlib.backend_bases import GraphicsContextBase, RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg, get_hinting_flag
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.ft2font import FT2Font
from matplotlib.transforms import Affine2D, Bbox, TransformedPath

_BY_LETTER = all(hasattr(FT2Font, name) for name in ("_layout", "_set_transform", "_render_glyph"))
_UPRIGHT = np.array([[0x10000, 0], [0, 0x10000]])
MOST = 4096  # words whose setting is kept


@lru_cache(MOST)
def _size(font: Any, words: str, points: float, dpi: float, flags: Any) -> tuple[float, float, float]:
    """Width, height and descent [pixel] of words in a font of this size."""
    font.set_text(words, 0.0, flags=flags)
    width, height = font.get_width_height()
    return width / 64, height / 64, font.get_descent() / 64


@lru_cache(MOST)
def _letters(font: Any, words: str, points: float, dpi: float, flags: Any) -> list[tuple[int, float, float]] | None:
    """Letters of words and their places [pixel]; None where they are not all in this font."""
    found = list(font._layout(words, flags=flags))
    return [(item.glyph_index, item.x, item.y) for item in found] if all(x.ft_object is font for x in found) else None


class AggTextRenderer(RendererAgg):
    """Agg that remembers how words are set."""

    def get_text_width_height_descent(self, s: str, prop: FontProperties, ismath: Any) -> tuple[float, float, float]:
        if ismath:
            return super().get_text_width_height_descent(s, prop, ismath)
        return _size(self._prepare_font(prop), s, prop.get_size_in_points(), self.dpi, get_hinting_flag())

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: FontProperties, angle: float, ismath: Any = False,
        mtext: Any = None,
    ) -> None:  # fmt: skip
        letters, flags = None, get_hinting_flag()
        font: Any = self._prepare_font(prop)
        if _BY_LETTER and not ismath and not angle and gc.get_antialiased() and _is_plain(mtext):
            letters = _letters(font, s, prop.get_size_in_points(), self.dpi, flags)
        if letters is None:
            super().draw_text(gc, x, y, s, prop, angle, ismath, mtext)
            return
        for glyph, right, up in letters:
            font._set_transform(_UPRIGHT, [round(64 * (x + right)), round(64 * (self.height - y + up))])
            drawn = font._render_glyph(glyph, flags, _NORMAL)
            low = int(self.height) - drawn.top + drawn.buffer.shape[0]
            self._renderer.draw_text_image(drawn.buffer, drawn.left, low, 0, gc)


if _BY_LETTER:
    from matplotlib.ft2font import RenderMode

    _NORMAL = RenderMode.NORMAL


def _is_plain(text: Any) -> bool:
    """Test whether a text asks for no features of its font, where matplotlib knows of them."""
    return not any(vars(text).get(name) for name in ("_features", "_language")) if text is not None else True


class Canvas(FigureCanvasAgg):
    """A canvas of such an Agg."""

    renderer: AggTextRenderer

    def get_renderer(self) -> AggTextRenderer:
        size = (*self.get_width_height(physical=True), self.figure.dpi)
        if self._lastKey != size:
            self.renderer, self._lastKey = AggTextRenderer(*size), size
        return self.renderer


@lru_cache(MOST)
def _outlines(font: Any, words: str, text2path: Any) -> tuple[str, dict[str, Any]]:
    """Uses of letters in an SVG file, and the outlines of the letters by their names."""
    letters, outlines, _ = text2path.get_glyphs_with_font(font, words)
    places = (f' transform="translate({x:g} {y:g})"' if x or y else "" for _, x, y, _ in letters)
    uses = (f'<use xlink:href="#{name}"{place}/>' for (name, *_), place in zip(letters, places, strict=True))
    return "".join(uses), outlines


class SvgTextRenderer(RendererSVG):
    """An SVG file in whose words the letters of a word are one line."""

    def __init__(self, width: float, height: float, file: TextIO, **more: Any) -> None:
        super().__init__(width, height, file, **more)
        self.file = file

    def _draw_text_as_path(
        self, gc: Any, x: float, y: float, s: str, prop: FontProperties, angle: float, ismath: Any, mtext: Any = None
    ) -> None:
        if ismath or not _is_plain(mtext) or (gc.get_alpha() if gc.get_forced_alpha() else gc.get_rgb()[3]) != 1:
            super()._draw_text_as_path(gc, x, y, s, prop, angle, ismath, mtext)
            return
        size = prop.get_size_in_points() / self._text2path.FONT_SCALE
        text2path: Any = self._text2path
        uses, outlines = _outlines(text2path._get_font(prop), s, text2path)
        self._update_glyph_map_defs({name: path for name, path in outlines.items() if name not in self._glyph_map})
        self.writer.comment(s)
        turned = f" rotate({-angle:g})" if angle else ""
        color = to_hex(gc.get_rgb())
        filled = "" if color == "#000000" else f' style="fill: {color}"'
        self.file.write(
            f'<g{filled} transform="translate({x:.6f} {y:.6f}){turned} scale({size:g} {-size:g})">{uses}</g>\n'
        )


POINTS = 72  # of an inch: the unit of SVG files


class UnsupportedArtist(Exception):
    """A figure with images or coloured cells, which the two kinds of files treat differently."""


class DualRenderer(RendererBase):
    """Renderer that draws on Agg and, in points, into an SVG file at once."""

    pixels: AggTextRenderer
    points: SvgTextRenderer
    smaller: Affine2D

    def __init__(self, pixels: AggTextRenderer, points: SvgTextRenderer, dpi: float) -> None:
        super().__init__()
        self.pixels, self.points = pixels, points
        self.dpi = dpi
        self.smaller = Affine2D().scale(POINTS / dpi)
        self._clip: tuple[Any, Any] = (None, None)

    def _in_points(self, gc: GraphicsContextBase) -> GraphicsContextBase:
        """Style of a line with its clipping in points; widths are in points already."""
        place, clip = gc.get_clip_rectangle(), gc.get_clip_path()
        path: Any = clip[0]
        placed: Any = clip[1]
        if place is None and path is None:
            return gc
        made = self.points.new_gc()
        made.copy_properties(gc)
        if place is not None:
            if self._clip[0] is not place:
                self._clip = place, Bbox(place.get_points() * POINTS / self.dpi)
            made.set_clip_rectangle(self._clip[1])
        if path is not None:
            inner: Any = TransformedPath(path, placed + self.smaller)
            made.set_clip_path(inner)
        return made

    def draw_path(self, gc: Any, path: Any, transform: Any, rgbFace: Any = None) -> None:
        self.pixels.draw_path(gc, path, transform, rgbFace)
        self.points.draw_path(self._in_points(gc), path, transform + self.smaller, rgbFace)

    def draw_markers(
        self, gc: Any, marker_path: Any, marker_trans: Any, path: Any, trans: Any, rgbFace: Any = None
    ) -> None:
        self.pixels.draw_markers(gc, marker_path, marker_trans, path, trans, rgbFace)
        small = self.smaller
        self.points.draw_markers(self._in_points(gc), marker_path, marker_trans + small, path, trans + small, rgbFace)

    def draw_path_collection(
        self, gc: Any, master_transform: Any, paths: Any, all_transforms: Any, offsets: Any, offset_trans: Any,
        *look: Any, **more: Any,
    ) -> None:  # fmt: skip
        what, small = (paths, all_transforms, offsets), self.smaller
        self.pixels.draw_path_collection(gc, master_transform, *what, offset_trans, *look, **more)
        self.points.draw_path_collection(
            self._in_points(gc), master_transform + small, *what, offset_trans + small, *look, **more
        )

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: Any, angle: float, ismath: Any = False, mtext: Any = None
    ) -> None:
        self.pixels.draw_text(gc, x, y, s, prop, angle, ismath, mtext)
        share = POINTS / self.dpi
        up = self.points.height - share * (self.pixels.height - y)
        self.points.draw_text(self._in_points(gc), share * x, up, s, prop, angle, ismath, mtext)

    def open_group(self, s: str, gid: str | None = None) -> None:
        self.points.open_group(s, gid)

    def close_group(self, s: str) -> None:
        self.points.close_group(s)

    def flipy(self) -> bool:
        return self.pixels.flipy()

    def get_canvas_width_height(self) -> tuple[float, float]:
        return self.pixels.get_canvas_width_height()

    def get_text_width_height_descent(self, s: str, prop: Any, ismath: Any) -> tuple[float, float, float]:
        return self.pixels.get_text_width_height_descent(s, prop, ismath)

    def points_to_pixels(self, points: Any) -> Any:
        return self.pixels.points_to_pixels(points)

    def draw_image(self, *_: Any, **__: Any) -> None:
        raise UnsupportedArtist

    def draw_tex(self, *_: Any, **__: Any) -> None:
        raise UnsupportedArtist

    def draw_quad_mesh(self, *_: Any, **__: Any) -> None:
        raise UnsupportedArtist

    def draw_gouraud_triangles(self, *_: Any, **__: Any) -> None:
        raise UnsupportedArtist

    def start_rasterizing(self) -> None:
        raise UnsupportedArtist


def draw_both(fig: Figure, file: Path, metadata: dict[str, str | None]) -> None:
    """Draw a figure that has its places on its canvas of Agg, and as an SVG file.

    Raises
    ------
    Unsuited
        It has images or coloured cells; nothing is of use then.
    """
    width, height = (POINTS * float(size) for size in fig.get_size_inches())
    pixels: AggTextRenderer = fig.canvas.get_renderer()  # type: ignore[attr-defined]
    pixels.clear()
    with file.open("w", encoding="utf-8") as text:
        points = SvgTextRenderer(width, height, text, image_dpi=fig.dpi, metadata=metadata)
        fig.draw(DualRenderer(pixels, points, fig.dpi))
        points.finalize()
