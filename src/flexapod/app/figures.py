"""The standard figures of a run, drawn and stored."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

__all__ = ["Drawn", "draw", "store"]

_Plan = tuple[str, str, Callable[[], "Figure"]]


class Drawn(NamedTuple):
    """A stored figure: title, PNG and SVG file, and its curves for a page, None where it is only a picture."""

    title: str
    png: Path
    svg: Path
    plot: dict[str, Any] | None = None


def draw(data: Dataset, folder: str | Path) -> list[Drawn]:
    """Draw the standard figures of a robot's or an actuator's run as PNG and SVG.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.run`, whole or partial.
    folder : path
        Made if needed; figures of the same name are replaced.

    Returns
    -------
    list of Drawn
        In the order of the report.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    plans = _robot(data) if "com_deviation" in data else _actuator(data)
    return [store(make(), title, Path(folder) / name) for name, title, make in plans]


def store(figure: Figure, title: str, stem: Path) -> Drawn:
    """Write a figure as ``stem.png`` and ``stem.svg``."""
    from flexapod import plot
    from flexapod.app.interactive import interactive

    png, svg = plot.save(figure, stem)
    return Drawn(title, png, svg, interactive(figure))


def _robot(data: Dataset) -> Iterator[_Plan]:
    import numpy as np

    from flexapod import plot
    from flexapod.study.summary import tool_apart

    elastic = bool(np.abs(data.com_deviation).max() > 0)
    axes = ("x", "y", "z")
    words = "rigid legs against flexible ones, and the deviation on its own scale"
    if tool_apart(data):
        yield "tool-path", f"Path of the tool: {words}", lambda: plot.com_path(data, axes, "tool")
    yield "com-path", f"Path of the centre of mass: {words}", lambda: plot.com_path(data, axes)
    if elastic:
        yield "deviation-by-cause", "Deviation of the centre of mass by cause", lambda: plot.deviation_by_cause(data)
    forces = "Drive forces: Newton-Euler with rigid legs against the multibody model, and their difference"
    yield "actuator-forces", forces, lambda: plot.actuator_forces(data)
    yield "leg-lengths", "Leg lengths, and how far the flexible legs are off", lambda: plot.leg_lengths(data)
    if np.abs(data.tip_deflection).max() > 0:
        yield "tip-deflections", "Deflection of the piston tips across the legs", lambda: plot.tip_deflections(data)
    yield "motion", "Commanded motion", lambda: plot.motion_law(data)
    yield "energies", "Energies and their balance", lambda: plot.energies(data)
    yield "robot", "The robot at the end of the motion; pale: at the start", lambda: plot.robot_3d(data)


def _actuator(data: Dataset) -> Iterator[_Plan]:
    from flexapod import plot

    yield "response", "Deflection of the tip, and the length outside the hub", lambda: plot.actuator_response(data)
    if "mode_amplitude" in data:
        yield "amplitudes", "Amplitudes of the shapes", lambda: plot.actuator_modes(data)
