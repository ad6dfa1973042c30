"""What the colours of the legs mean: values over time, a scale that colour-blind readers tell apart, the legend."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.study.words import number, scale
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["LEGEND_STYLE", "LEG_COLORS", "QUANTITIES", "LegColors", "leg_colors", "plain_legend", "rgb"]

#: What legs can be coloured by.
QUANTITIES = ("plain", "force", "stroke margin", "bending")

#: Those of the figures (`plot.style`, which would load matplotlib before the first picture).
LEG_COLORS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#A23B72")

# Anchors at equal distances. Both scales also grow or fall in lightness alone: readable in grey.
_SEQUENTIAL = ("#00204D", "#31446B", "#666970", "#958F78", "#CBBA69", "#FFEA46")  # cividis
_DIVERGING = ("#B35806", "#F1A340", "#D8D8D8", "#67A9CF", "#2166AC")

#: Of a legend in the panel.
LEGEND_STYLE = "padding:0 0.75em 0.5em;font-size:0.8rem;line-height:1.4"


def rgb(color: str) -> tuple[int, int, int]:
    """Red, green, blue of "#rrggbb"."""
    return (int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16))


@dataclass(frozen=True, kw_only=True)
class LegColors:
    """Values of a quantity in all legs over time, and the colours that stand for them.

    `values` (T, 6) in the unit `unit`; the scale goes from `low` to `high`; `title` and `note`: words of the legend.
    """

    values: Array
    low: float
    high: float
    unit: str
    title: str
    note: str
    anchors: tuple[str, ...]

    def colors(self, index: int) -> Array:
        """Colours of the six legs at a stored instant, (6, 3) in 0 to 255."""
        span = self.high - self.low
        share = (self.values[index] - self.low) / span if span > 0 else np.full(6, 0.5)
        table = np.array([rgb(anchor) for anchor in self.anchors], dtype=float)
        places = np.clip(share, 0.0, 1.0) * (len(table) - 1)
        return np.stack([np.interp(places, np.arange(len(table)), column) for column in table.T], axis=1).astype(int)

    def html(self, index: int | None = None) -> str:
        """The scale as a bar with its ends and middle, and the six values at a stored instant."""
        ticks = [f"{number(value)} {self.unit}" for value in (self.low, 0.5 * (self.low + self.high), self.high)]
        now = "" if index is None else _leg_row(self.colors(index), [number(v) for v in self.values[index]], self.unit)
        return (
            f'<div role="img" aria-label="Legend: {self.title}" style="{LEGEND_STYLE}">'
            f"<b>{self.title}</b>"
            f'<div style="height:0.9em;border-radius:3px;background:linear-gradient(90deg,{",".join(self.anchors)})">'
            f'</div><div style="display:flex;justify-content:space-between">'
            + "".join(f"<span>{tick}</span>" for tick in ticks)
            + f'</div>{now}<div style="opacity:0.75">{self.note}</div></div>'
        )


def leg_colors(quantity: str, study: model.Study, data: Dataset) -> LegColors:
    """Colours of the legs of a result by "force", "stroke margin" or "bending"."""
    return {"force": _force, "stroke margin": _margin, "bending": _bending}[quantity](study, data)


def plain_legend() -> str:
    """The legend of legs that are coloured by their number."""
    row = _leg_row(np.array([rgb(color) for color in LEG_COLORS]), [], "")
    return f'<div style="{LEGEND_STYLE}"><b>Legs by number</b>{row}</div>'


def _leg_row(colors: Array, values: list[str], unit: str) -> str:
    cells = []
    for i, color in enumerate(colors):
        value = f"{values[i]} {unit}" if values else ""
        cells.append(
            f'<span style="white-space:nowrap"><span style="display:inline-block;width:0.8em;height:0.8em;'
            f'border-radius:2px;border:1px solid #888;background:rgb({",".join(str(int(c)) for c in color)})"></span> '
            f"leg {i + 1}{': ' if value else ''}{value}</span>"
        )
    columns = "repeat(2, 1fr)" if values else "repeat(3, 1fr)"
    return f'<div style="display:grid;grid-template-columns:{columns};gap:0 0.8em">{"".join(cells)}</div>'


def _force(study: model.Study, data: Dataset) -> LegColors:
    unit = scale(data.actuator_force, "N")
    values = unit(data.actuator_force.values)
    largest = float(np.abs(values).max()) or 1.0
    return LegColors(
        values=values,
        low=-largest,
        high=largest,
        unit=unit.name,
        title="Force of the drive along the leg",
        note="Positive pushes the piston out (the leg is compressed), negative holds it back.",
        anchors=_DIVERGING,
    )


def _margin(study: model.Study, data: Dataset) -> LegColors:
    length = data.leg_length.values
    low, high = stroke_limits(study.robot)
    values = 1e3 * np.minimum(length - low, high - length)
    return LegColors(
        values=values,
        low=min(0.0, float(values.min())),
        high=max(1e-9, float(values.max())),
        unit="mm",
        title="Stroke left to the nearer end",
        note="0: at an end of leg.stroke, or of the piston where the study gives no stroke.",
        anchors=_SEQUENTIAL,
    )


def stroke_limits(robot: model.Robot) -> tuple[Array, Array]:
    """Shortest and longest length of every leg, (6,) [m] each: its stroke, else what the piston allows."""
    pairs = [
        (leg.stroke.min, leg.stroke.max) if leg.stroke else (leg.cylinder.mouth, leg.cylinder.mouth + leg.piston.length)
        for leg in robot.legs
    ]
    low, high = np.array(pairs).T
    return low, high


def _bending(study: model.Study, data: Dataset) -> LegColors:
    size = np.linalg.norm(data.tip_deflection.values, axis=-1)
    unit = scale(size, "m")
    return LegColors(
        values=unit(size),
        low=0.0,
        high=float(unit(size).max()) or 1.0,
        unit=unit.name,
        title="Bending: piston tip off the cylinder's axis",
        note="True size, not magnified.",
        anchors=_SEQUENTIAL,
    )
