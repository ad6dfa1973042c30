"""Charts over time with a cursor at the instant that the scene shows."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import viser
from numpy.typing import NDArray

from flexapod.analysis.results.element_outputs import element_names
from flexapod.analysis.results.summary import POINT_WORDS, tip_size
from flexapod.common.arrays import Array
from flexapod.common.quantities import NOTHING, capital, number, scale, zero_rounding_lines
from flexapod.output.scene.geometry import decimation_indices, nearest_index
from flexapod.output.scene.style import AXIS_COLORS, ENERGIES, colors_of_legs, drives

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

MOST = 900  # instants of a drawn line: the extremes of each piece are kept

_AXES = tuple(AXIS_COLORS.values())
_OTHERS = ("#0072B2", "#009E73", "#D55E00", "#E69F00", "#A23B72", "#56B4E9")
_DASHES: tuple[tuple[float, ...], ...] = ((), (6, 3), (8, 3, 2, 3), (2, 2), (10, 2), (4, 2, 1, 2))
_CURSOR = "#888888"
_NOTHING = 1e-10  # of the largest value of a chart: what is less at an instant is rounding, shown as 0


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Lines over time: `values` (lines, T) in the unit `unit`, at `time` (T,) [s].

    A line that is rounding beside the largest is 0; energies stay as they are, as small ones are real.
    """

    title: str
    unit: str
    time: Array
    values: Array
    names: tuple[str, ...]
    colors: tuple[str, ...]

    @property
    def limits(self) -> tuple[float, float]:
        """Lower and upper limit of the vertical axis."""
        low, high = float(np.nanmin(self.values)), float(np.nanmax(self.values))
        margin = 0.06 * (high - low) or 0.06 * abs(high) or 1.0  # lines that are 0: from -1 to 1
        return low - margin, high + margin

    def values_at(self, time: float) -> tuple[float, Array]:
        """The stored instant nearest to a time, as in the scene, and the values of all lines there, (lines,)."""
        place = nearest_index(self.time, time)
        return float(self.time[place]), self.values[:, place]


def charts(data: Dataset, point: str = "com") -> dict[str, Chart]:
    """The charts of a result by name: a robot's (deviation of its `point`, "com" or "tool"), or a single actuator's."""
    if "com_deviation" in data:
        colors, driven = colors_of_legs(data.sizes["leg"]), drives(data)
        pushed = tuple(color for color, leg in zip(colors, data.leg.values, strict=True) if leg in driven.force.leg)
        title, deviation = f"Deviation of the {POINT_WORDS[point]}", data[f"{point}_deviation"]
        return {
            "deviation": _chart(data, title, deviation, "m", list("xyz"), _AXES),
            "leg forces": _chart(
                data,
                f"{driven.word.capitalize()} of the drives",
                driven.force,
                driven.unit,
                _legs(driven.force),
                pushed,
            ),
            "tip deflections": _chart(
                data,
                "Piston tips off the cylinders' axes",
                (data.tip_deflection**2).sum("direction") ** 0.5,
                "m",
                _legs(data),
                colors,
            ),
            **{name: _of_element(data, name, colors) for name in element_names(data)},
            "energies": _energies(data),
        }
    return {
        "tip deflection": _chart(
            data, "Tip in the frame of the hub", data.length.copy(data=tip_size(data)), "m", ["tip"], _OTHERS
        ),
        "length": _chart(data, "Length outside the hub", data.length, "m", ["length"], _OTHERS),
        "torque": _chart(data, "Torque on the hub", data.torque, "N m", ["torque"], _OTHERS),
        "force": _chart(data, "Axial force on the beam", data.force, "N", ["force"], _OTHERS),
        "energies": _energies(data),
    }


def _of_element(data: Dataset, name: str, colors: tuple[str, ...]) -> Chart:
    values = data[name]
    there = values.notnull().any("time").values
    own, title = values[:, there], capital(str(values.attrs["long_name"]))
    return _chart(data, title, own, str(values.attrs["units"]), _legs(own), tuple(np.array(colors)[there]))


def _legs(data: Dataset | DataArray) -> list[str]:
    return [f"leg {leg}" for leg in data.leg.values]


def _chart(data: Dataset, title: str, values: DataArray, unit: str, names: list[str], colors: tuple[str, ...]) -> Chart:
    none = unit == "m" and float(np.abs(values.values).max()) < NOTHING
    shown = scale(0 * values if none else values, unit)
    lines = shown(0 * values.values if none else values.values).reshape(data.sizes["time"], -1).T
    return Chart(
        title=f"{title}: none" if none else title,
        unit=shown.name,
        time=data.time.values,
        values=zero_rounding_lines(lines),
        names=tuple(names),
        colors=colors[: len(names)],
    )


def _energies(data: Dataset) -> Chart:
    drawn = [name for name in ENERGIES if name in data]
    values = np.stack([data[name].values - data[name].values[0] for name in drawn])
    shown = scale(values, "J")
    return Chart(
        title="Energies and works, change since the start",
        unit=shown.name,
        time=data.time.values,
        values=shown(values),
        names=tuple(ENERGIES[name][0] for name in drawn),
        colors=tuple(ENERGIES[name][1] for name in drawn),
    )


class ChartView:
    """One chart in the panel, its cursor, and below it the values at the cursor."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._gui, self._place = gui, gui.add_folder(None)
        self._plot: viser.GuiUplotHandle | None = None
        self._values: viser.GuiHtmlHandle | None = None
        self._chart: Chart | None = None
        self._drawn: NDArray[np.intp] = np.zeros(0, dtype=int)

    def show(self, chart: Chart | None, time: float) -> None:
        """Draw another chart with its cursor at `time` [s]; None: nothing."""
        for handle in (self._plot, self._values):
            if handle is not None:
                handle.remove()
        self._chart, self._plot, self._values = chart, None, None
        if chart is None:
            return
        self._drawn = decimation_indices(chart.values, MOST)
        with self._place:
            self._plot = self._gui.add_uplot(
                self._lines(chart, time),
                _series(chart),
                title=f"{chart.title} [{chart.unit}]",
                scales={"x": {"time": False}, "y": {"range": chart.limits}},
                axes=({"label": "time [s]", "labelSize": 18, "size": 30}, {"size": 54}),
                legend={"show": False},
                height=230,
                padding=(4, 12, 0, 0),
            )
            self._values = self._gui.add_html(_readout(chart, time))

    def cursor(self, time: float) -> None:
        """Move the cursor."""
        if self._chart is not None and self._plot is not None and self._values is not None:
            self._plot.data = self._lines(self._chart, time)
            self._values.content = _readout(self._chart, time)

    def _lines(self, chart: Chart, time: float) -> tuple[Array, ...]:
        """Instants, lines, and the cursor: a line along the lower edge that rises at the instant nearest to `time`."""
        instants, (low, high) = chart.time[self._drawn], chart.limits
        time, now = chart.values_at(time)
        place = np.full(3, int(np.searchsorted(instants, time)))
        lines = [np.insert(line[self._drawn], place, at) for line, at in zip(chart.values, now, strict=True)]
        mark = np.insert(np.full(len(instants), low), place, (low, high, low))
        return np.insert(instants, place, time), *lines, mark


def _series(chart: Chart) -> tuple[Any, ...]:
    """Style of the lines; the last is the cursor."""
    plain = {"points": {"show": False}}
    lines = [
        {"label": name, "stroke": color, "width": 1.6, "dash": dash, **plain}
        for name, color, dash in zip(chart.names, chart.colors, cycle(_DASHES), strict=False)
    ]
    return {"label": "time [s]"}, *lines, {"label": "now", "stroke": _CURSOR, "width": 1.5, **plain}


def _readout(chart: Chart, time: float) -> str:
    """Names, colours and values of the lines at the instant nearest to a time, as HTML."""
    time, values = chart.values_at(time)
    largest = float(np.nanmax(np.abs(chart.values), initial=0.0))
    values = [0.0 if abs(value) <= _NOTHING * largest else value for value in values]
    cells = "".join(
        f"<span><svg width='22' height='8' aria-hidden='true'><line x1='0' y1='4' x2='22' "
        f"y2='4' stroke='{color}' stroke-width='2.5' stroke-dasharray='{','.join(str(d) for d in dash)}'/></svg> "
        f"{escape(name)} <b>{number(value)}</b></span>"
        for name, color, dash, value in zip(chart.names, chart.colors, cycle(_DASHES), values, strict=False)
    )
    return (
        f"<div class='flexapod-readout' style='padding:0 0.75em 0.5em;font-size:0.8rem;line-height:1.5'>"
        f"At {time:.4g} s, in {escape(chart.unit)}:"
        f"<div style='display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:0 0.8em'>{cells}</div></div>"
    )
