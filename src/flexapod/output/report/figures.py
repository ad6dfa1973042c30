"""The standard figures of a run, drawn and stored."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from flexapod import model
from flexapod.analysis.results.attributes import carried_study, robot_of
from flexapod.analysis.results.element_outputs import element_names
from flexapod.analysis.results.summary import has_separate_tool
from flexapod.common.files import temporary_folder
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.processes import forked_map
from flexapod.common.quantities import capital
from flexapod.output.scene.geometry import BeamMotion
from flexapod.output.scene.style import drives
from flexapod.output.text.budget import peak_budget

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

    from flexapod.output import figures
    from flexapod.output.report import plotly_export
else:
    figures = LazyModule("flexapod.output.figures")
    plotly_export = LazyModule("flexapod.output.report.plotly_export")

FAST = 3  # level of deflating: half the time of the usual one, a quarter more bytes
_Plan = tuple[str, str, Callable[[], "Figure"]]


class StoredFigure(NamedTuple):
    """A figure: its name and title, for a page its picture (PNG) and its curves, if it has any; its files."""

    name: str
    title: str
    picture: bytes
    plot: dict[str, Any] | None = None
    files: tuple[Path, ...] = ()

    @property
    def png(self) -> Path:
        """PNG file of the figure, where one was asked for."""
        return next(path for path in self.files if path.suffix == ".png")


def draw_figures(data: Dataset, folder: str | Path, formats: Sequence[str] = ("png",)) -> list[StoredFigure]:
    """Draw the standard figures of a run, whole or partial, in the order of the report.

    `folder` is made if needed, figures of the same name are replaced; `formats` are of png, svg, pdf. InputError: the
    folder cannot be written to, or a format is unknown.
    """
    with concurrent_drawing(data, folder, formats, 1) as drawn:
        return drawn()


def concurrent_drawing(
    data: Dataset, folder: str | Path, formats: Sequence[str], processes: int
) -> AbstractContextManager[Callable[[], list[StoredFigure]]]:
    """Draw the standard figures in copies of this process; the function given to the block takes part and waits."""
    plans = list(_robot(data) if "com_deviation" in data else _actuator(data))

    def draw_and_store(plan: _Plan) -> StoredFigure:
        name, title, make = plan
        return store_figure(make(), title, Path(folder) / name, formats)

    return forked_map(draw_and_store, plans, processes)


def store_figure(figure: Figure, title: str, stem: Path, formats: Sequence[str] = ("png",)) -> StoredFigure:
    """Write a figure as ``stem.png``, ``stem.svg``, ``stem.pdf``, as asked for."""
    files = figures.save(figure, stem, formats=formats)
    if "png" not in formats:
        with temporary_folder() as folder:
            figures.save(figure, folder / stem.name, formats=("png",))
    return StoredFigure(stem.name, title, _picture(figure), plotly_export.plotly_figure(figure), files)


def _picture(figure: Figure) -> bytes:
    """The drawing of a figure's PNG file in 128 colours: a third of its size, and no difference to the eye.

    Colours are chosen among the first pixels of runs of one colour, a twentieth of them all.
    """
    import numpy as np
    from PIL import Image

    drawn = np.asarray(figure.canvas.buffer_rgba())  # type: ignore[attr-defined]  # of Agg: as last drawn
    pixels = drawn.view(np.uint32).ravel()
    starts = np.flatnonzero(np.concatenate([[True], pixels[1:] != pixels[:-1]]))
    lengths = np.diff(starts, append=len(pixels))
    colors = pixels[starts].view(np.uint8).reshape(1, -1, 4)[:, :, :3]
    few = Image.fromarray(np.ascontiguousarray(colors)).quantize(
        128, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE
    )
    chosen = np.asarray(few).ravel()
    sums = [np.bincount(chosen, lengths * part, 128) for part in (1, *colors[0].T)]
    mean = np.round(np.array(sums[1:]) / np.maximum(sums[0], 1)).astype(np.uint8)  # of the pixels that it stands for
    page = Image.fromarray(np.repeat(chosen, lengths).reshape(drawn.shape[:2]))
    page.putpalette(mean.T.tobytes())
    made = BytesIO()
    page.save(made, "PNG", compress_level=FAST)
    return made.getvalue()


def _robot(data: Dataset) -> Iterator[_Plan]:
    import numpy as np

    found = drives(data)
    elastic = bool(np.abs(data.com_deviation).max() > 0)
    axes, held = ("x", "y", "z"), robot_of(data).platform_fixed
    words = "rigid legs against flexible ones, and the deviation on its own scale"
    if has_separate_tool(data):
        yield "tool-path", f"Path of the tool: {words}", lambda: figures.com_path(data, axes, "tool")
    if not held:
        yield "com-path", f"Path of the centre of mass: {words}", lambda: figures.com_path(data, axes)
    if elastic:
        yield "deviation-by-cause", "Deviation of the centre of mass by cause", lambda: figures.deviation_by_cause(data)
    budget = peak_budget(data)
    if budget is not None:
        yield (
            "error-budget",
            "Error budget at rest, at the pose of the largest deviation",
            lambda: figures.budget(budget),
        )
    method = "Newton-Euler" if found.plain else "rigid robot"
    forces = f"Drive {found.word}s: {method} with rigid legs against the multibody model, and their difference"
    yield "actuator-forces", forces, lambda: figures.actuator_forces(data)
    place = found.place
    words = "Leg lengths, and how far the flexible legs are off"
    words = words if place == "length" else f"{place[0].upper()}{place[1:]}, as commanded"
    yield "leg-lengths", words, lambda: figures.leg_lengths(data)
    if np.abs(data.tip_deflection).max() > 0:
        yield "tip-deflections", "Deflection of the tips across the legs", lambda: figures.tip_deflections(data)
    for own in element_names(data):
        yield own.replace("_", "-"), capital(data[own].attrs["long_name"]), lambda own=own: figures.by_leg(data, own)
    if not held:
        yield "motion", "Commanded motion", lambda: figures.motion_law(data)
    yield "energies", "Energies and their balance", lambda: figures.energies(data)
    yield "robot", "The robot at the end of the motion; pale: at the start", lambda: figures.robot_3d(data)


def _actuator(data: Dataset) -> Iterator[_Plan]:
    drawn = _seen(data)
    if drawn is not None and "direction" not in data.tip_deflection.dims:
        yield "path", "The tip in the plane of motion", lambda: figures.actuator_path(data, *drawn)
    yield "response", "Deflection of the tip, and the length outside the hub", lambda: figures.actuator_response(data)
    if "mode_amplitude" in data:
        yield "amplitudes", "Amplitudes of the shapes", lambda: figures.actuator_modes(data)


def _seen(data: Dataset) -> tuple[float, float] | None:
    """Radius of the hub [m] and the factor of the replay; None where the study cannot be read any more."""
    study = carried_study(data)
    if not isinstance(study, model.ActuatorStudy):
        return None
    return study.actuator.hub_radius, BeamMotion(study, data).automatic_scale()
