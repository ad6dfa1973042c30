"""One drawing that becomes a picture and an SVG file: the artists of a figure are asked once what they draw."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.backend_bases import GraphicsContextBase, RendererBase
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D, Bbox, TransformedPath

from flexapod.output.figures.letters import WordsInSvg, WordsOnAgg

POINTS = 72  # of an inch: the unit of SVG files


class Unsuited(Exception):
    """A figure with images or coloured cells, which the two kinds of files treat differently."""


class Twice(RendererBase):
    """Passes what is drawn on Agg on to an SVG file, in points."""

    pixels: WordsOnAgg
    points: WordsInSvg
    smaller: Affine2D

    def __init__(self, pixels: WordsOnAgg, points: WordsInSvg, dpi: float) -> None:
        super().__init__()
        self.pixels, self.points = pixels, points
        self.dpi = dpi
        self.smaller = Affine2D().scale(POINTS / dpi)
        self._clip: tuple[Any, Any] = (None, None)

    def _in_points(self, gc: GraphicsContextBase) -> GraphicsContextBase:
        """What a line looks like, with its clipping in points; widths are in points already."""
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
        raise Unsuited

    def draw_tex(self, *_: Any, **__: Any) -> None:
        raise Unsuited

    def draw_quad_mesh(self, *_: Any, **__: Any) -> None:
        raise Unsuited

    def draw_gouraud_triangles(self, *_: Any, **__: Any) -> None:
        raise Unsuited

    def start_rasterizing(self) -> None:
        raise Unsuited


def draw_both(fig: Figure, file: Path, metadata: dict[str, str | None]) -> None:
    """Draw a figure that has its places on its canvas of Agg, and as an SVG file.

    Raises
    ------
    Unsuited
        It has images or coloured cells; nothing is of use then.
    """
    width, height = (POINTS * float(size) for size in fig.get_size_inches())
    pixels: WordsOnAgg = fig.canvas.get_renderer()  # type: ignore[attr-defined]
    pixels.clear()
    with file.open("w", encoding="utf-8") as text:
        points = WordsInSvg(width, height, text, image_dpi=fig.dpi, metadata=metadata)
        fig.draw(Twice(pixels, points, fig.dpi))
        points.finalize()
