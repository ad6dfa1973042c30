"""Summary of a result in a few numbers: size of the deviation, its axis, and the largest contributor."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.results.cause_labels import cause_labels
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import NOTHING, along_axes, fill_template, zero_rounding
from flexapod.common.ranking import EQUALS, first_largest, largest_item

if TYPE_CHECKING:
    from xarray import Dataset

SMALLEST_EXCURSION = 1e-6  # rigid travel below which a percentage says nothing [m]
POINTS = {"com": "The payload's centre of mass", "tool": "The tool"}
UNTIL = " until the computation stopped"
_LENGTHS = "(free length {start:.4g} m at the start, {end:.4g} m at the end)"
WORDS = {
    "rigid": "{point} stays on the path of the rigid robot: its legs are rigid.",
    "swinging": "{point} stays on the path of the rigid robot: tips of legs swing by up to {tips:~3 m}.",
    "misses": "{point} misses its rigid path by up to {peak:~3 m}{until} ({axes})",
    "blamed": "the largest cause is {cause} ({share:.0f} %{leg})",
    "leg": ", most of it in leg {leg}",
    "straight": "The tip stays on the hub's line{until}: nothing bends the beam " + _LENGTHS + ".",
    "bent": (
        "The tip leaves the hub's line by up to {peak:~3 m}{until}, at t = {time:.3g} s, because the beam bends "
        + _LENGTHS
        + "."
    ),
}
"""The sentences of a summary, and what may stand in them."""
POINT_WORDS = {"com": "centre of mass", "tool": "tool"}


@dataclass(frozen=True, kw_only=True)
class AxisSummary:
    """Deviation along one world axis: `peak` (largest size) at `time`, `rms`, `excursion` of the rigid path [m, s].

    `per_cent`: peak over peak-to-peak rigid excursion; None ("n/a") where the excursion is below 1 um. `time`: None
    where the peak is shown as 0.
    """

    axis: str
    peak: float
    time: float | None
    rms: float
    excursion: float
    per_cent: float | None


@dataclass(frozen=True, kw_only=True)
class RobotSummary:
    """Deviation of a payload point from the rigid path.

    `peak`, `rms` [m] of the distance, `time` [s] of the peak; `start`: distance at t = 0; `axes`: x, y, z; `causes`:
    share of each cause in the deviation at the peak, along its direction (they add up to 1 but for second order);
    `worst_leg`, `worst_leg_share`: the leg that the largest cause owes most to, and its part of it; None without
    deviation, and where legs contribute alike. `tips` [m]: how far tips are from their legs' axes, at most. `partial`:
    the integration stopped early; `words` for causes.
    """

    point: str
    peak: float
    time: float
    rms: float
    start: float
    axes: tuple[AxisSummary, ...]
    causes: dict[str, float]
    worst_leg: int | None
    worst_leg_share: float | None
    tips: float
    partial: bool
    words: dict[str, str]

    @property
    def largest_cause(self) -> str | None:
        """Cause with the largest share in size; None without deviation."""
        return largest_item(self.causes, key=lambda cause: abs(self.causes[cause])) if self.causes else None

    @property
    def shown_axes(self) -> tuple[AxisSummary, ...]:
        """The axes as they are shown: what is rounding beside the largest one is 0, a deviation at no time."""
        travel = max(a.excursion for a in self.axes)
        axes = [a if zero_rounding(a.excursion, travel) else replace(a, excursion=0.0) for a in self.axes]
        return tuple(
            a
            if zero_rounding(a.peak, self.peak)
            else replace(a, peak=0.0, time=None, rms=0.0, per_cent=a.per_cent and 0.0)
            for a in axes
        )

    @property
    def sentence(self) -> str:
        """The deviation and its largest cause, in one sentence."""
        name = POINTS[self.point]
        if self.peak < NOTHING:
            return fill_template(WORDS["rigid" if self.tips < NOTHING else "swinging"], point=name, tips=self.tips)
        by_axis = along_axes([a.peak for a in self.shown_axes])
        until = UNTIL if self.partial else ""
        misses = fill_template(WORDS["misses"], point=name, peak=self.peak, until=until, axes=by_axis)
        cause = self.largest_cause
        if cause is None:
            return f"{misses}."
        leg = "" if self.worst_leg is None else fill_template(WORDS["leg"], leg=self.worst_leg)
        blamed = fill_template(WORDS["blamed"], cause=self.words[cause], share=100 * self.causes[cause], leg=leg)
        return f"{misses}; {blamed}."

    def as_dict(self) -> dict[str, object]:
        """Summary as plain data."""
        found = {name: value for name, value in asdict(self).items() if name != "words"}
        return {**found, "largest_cause": self.largest_cause, "sentence": self.sentence}


@dataclass(frozen=True, kw_only=True)
class ActuatorSummary:
    """Deflection of an actuator's tip in the hub frame: `peak` at `time`, `rms`, `end` [m, s]; `lengths` [m]."""

    peak: float
    time: float
    rms: float
    end: float
    lengths: tuple[float, float]
    partial: bool

    @property
    def sentence(self) -> str:
        """The deflection and its cause, in one sentence."""
        kind = "straight" if self.peak < NOTHING else "bent"
        return fill_template(
            WORDS[kind],
            peak=self.peak,
            until=UNTIL if self.partial else "",
            time=self.time,
            start=self.lengths[0],
            end=self.lengths[1],
        )

    def as_dict(self) -> dict[str, object]:
        """Summary as plain data."""
        return {**asdict(self), "sentence": self.sentence}


def summary(data: Dataset, point: str = "com") -> RobotSummary | ActuatorSummary:
    """Summary of a simulation.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.simulate`, `simulate_actuator` or `run`.
    point : str
        ``com`` (centre of mass; the only one with causes) or ``tool``.

    Raises
    ------
    InputError
        Another point.
    """
    if {"com_deviation", "length"}.isdisjoint(getattr(data, "variables", ())):
        raise InputError("is no result of a simulation", key="data", allowed="that of flexapod.simulate or run")
    if not isinstance(point, str) or point not in POINTS:
        raise InputError("is not a point of the payload", key="point", value=point, allowed=", ".join(POINTS))
    partial = bool(data.attrs.get("partial", 0))
    if "com_deviation" not in data:
        tip = tip_size(data)
        at, length = first_largest(np.abs(tip)), data.length.values
        return ActuatorSummary(
            peak=float(np.abs(tip[at])),
            time=float(data.time[at]),
            rms=_rms(tip),
            end=float(tip[-1]),
            lengths=(float(length[0]), float(length[-1])),
            partial=partial,
        )
    deviation, path = data[f"{point}_deviation"].values, data[f"{point}_position_rigid"].values
    size, time = np.linalg.norm(deviation, axis=1), data.time.values
    at = first_largest(size)
    causes, leg, share = _blame(data, at) if point == "com" else ({}, None, None)
    return RobotSummary(
        point=point,
        peak=float(size[at]),
        time=float(time[at]),
        rms=_rms(size),
        start=float(size[0]),
        axes=tuple(_axis(str(a), deviation[:, i], path[:, i], time) for i, a in enumerate(data.axis.values)),
        causes=causes,
        worst_leg=leg,
        worst_leg_share=share,
        tips=float(np.linalg.norm(data.tip_deflection.values, axis=-1).max(initial=0.0)),
        partial=partial,
        words=cause_labels(data),
    )


def tip_size(data: Dataset) -> Array:
    """Deflection of a single actuator's tip over time; in space its size, (T,) [m]."""
    tip = data.tip_deflection.values
    return tip if tip.ndim == 1 else np.linalg.norm(tip, axis=1)


def summaries(data: Dataset) -> list[RobotSummary | ActuatorSummary]:
    """Summaries of a result, the most important point first: a separate tool, then the centre of mass."""
    tool = [summary(data, "tool")] if "com_deviation" in data and has_separate_tool(data) else []
    return [*tool, summary(data)]


def has_separate_tool(data: Dataset) -> bool:
    """Test whether the tool of a robot is another point than its centre of mass."""
    return float(np.abs(data.tool_position_rigid - data.com_position_rigid).max()) > 0


def _axis(name: str, deviation: Array, path: Array, time: Array) -> AxisSummary:
    at, excursion = first_largest(np.abs(deviation)), float(np.ptp(path))
    peak = float(np.abs(deviation[at]))
    per_cent = 100 * peak / excursion if excursion >= SMALLEST_EXCURSION else None
    return AxisSummary(
        axis=name, peak=peak, time=float(time[at]), rms=_rms(deviation), excursion=excursion, per_cent=per_cent
    )


def _blame(data: Dataset, at: int) -> tuple[dict[str, float], int | None, float | None]:
    """Share of each cause at an instant along the CoM's deviation; the leg behind most of the largest, its part."""
    deviation = data.com_deviation.values[at]
    size = float(np.linalg.norm(deviation))
    if size < NOTHING:
        return {}, None, None
    shares = data.deviation_by_cause.values[at] @ deviation / size**2
    causes = dict(zip(map(str, data.cause.values), shares.sum(axis=1).tolist(), strict=True))
    by_leg = shares[first_largest(np.abs(shares.sum(axis=1)))]
    parts = by_leg / by_leg.sum()
    second, largest = np.sort(parts)[-2:]
    if not zero_rounding(largest - second, largest):  # legs alike: none of them is the one
        return causes, None, None
    leg = first_largest(parts, EQUALS)
    return causes, leg + 1, float(parts[leg])


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
