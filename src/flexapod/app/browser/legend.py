"""Colours of the legs by values over time, on a scale that colour-blind readers tell apart, and their legend."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.common.arrays import Array
from flexapod.common.quantities import NOTHING, number, scale, zero_rounding_lines
from flexapod.output.scene.style import colors_of_legs, drives

if TYPE_CHECKING:
    from xarray import Dataset

#: What legs can be coloured by.
QUANTITIES = ("plain", "force", "stroke margin", "bending")

# Anchors at equal distances. Both scales also grow or fall in lightness alone: readable in grey.
_SEQUENTIAL = ("#00204D", "#31446B", "#666970", "#958F78", "#CBBA69", "#FFEA46")  # cividis
_DIVERGING = ("#B35806", "#F1A340", "#D8D8D8", "#67A9CF", "#2166AC")

_BEYOND, _NO_VALUE = "#D6002F", "#A8A8A8"

#: Of a legend in the panel.
LEGEND_STYLE = "padding:0 0.75em 0.5em;font-size:0.8rem;line-height:1.4"


def rgb(color: str) -> tuple[int, int, int]:
    """Red, green, blue of "#rrggbb"."""
    return (int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16))


@dataclass(frozen=True, kw_only=True)
class LegColors:
    """Values of a quantity in all legs over time, and the colours that stand for them.

    `values` (T, legs) in the unit `unit`, NaN for a leg without one (grey); the scale goes from `low` to `high`;
    `title` and `note`: words of the legend; `below`: colour of values below `low`, None where that of `low` is meant;
    `none`: words of a leg without value.
    """

    values: Array
    low: float
    high: float
    unit: str
    title: str
    note: str
    anchors: tuple[str, ...]
    below: str | None = None
    none: str = "no limits"

    def colors(self, index: int) -> Array:
        """Colours of the legs at a stored instant, (legs, 3) in 0 to 255."""
        span = self.high - self.low
        share = (self.values[index] - self.low) / span if span > 0 else np.full(self.values.shape[1], 0.5)
        table = np.array([rgb(anchor) for anchor in self.anchors], dtype=float)
        places = np.clip(np.nan_to_num(share), 0.0, 1.0) * (len(table) - 1)
        found = np.stack([np.interp(places, np.arange(len(table)), column) for column in table.T], axis=1)
        if self.below is not None:
            found[share < 0] = rgb(self.below)
        found[np.isnan(share)] = rgb(_NO_VALUE)
        return found.astype(int)

    def html(self, index: int | None = None) -> str:
        """The scale as a bar with its ends and middle, and the values at a stored instant."""
        ticks = [f"{number(value)} {self.unit}" for value in (self.low, 0.5 * (self.low + self.high), self.high)]
        values = (
            []
            if index is None
            else [self.none if np.isnan(v) else f"{number(v)} {self.unit}" for v in self.values[index]]
        )
        now = "" if index is None else _leg_row(self.colors(index), values)
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


def plain_legend(legs: int) -> str:
    """The legend of legs that are coloured by their number."""
    row = _leg_row(np.array([rgb(color) for color in colors_of_legs(legs)]), [])
    return f'<div style="{LEGEND_STYLE}"><b>Legs by number</b>{row}</div>'


def _leg_row(colors: Array, values: list[str]) -> str:
    cells = []
    for i, color in enumerate(colors):
        value = values[i] if values else ""
        cells.append(
            f'<span style="white-space:nowrap"><span style="display:inline-block;width:0.8em;height:0.8em;'
            f'border-radius:2px;border:1px solid #888;background:rgb({",".join(str(int(c)) for c in color)})"></span> '
            f"leg {i + 1}{': ' if value else ''}{value}</span>"
        )
    columns = "repeat(2, 1fr)" if values else "repeat(3, 1fr)"
    return f'<div style="display:grid;grid-template-columns:{columns};gap:0 0.8em">{"".join(cells)}</div>'


def _force(study: model.Study, data: Dataset) -> LegColors:
    found = drives(data)
    unit = scale(found.force, found.unit)
    values = unit(found.force.reindex(leg=data.leg).values)  # NaN for legs without drive
    largest = float(np.nanmax(np.abs(values))) or 1.0
    stroke = found.place == "length"
    return LegColors(
        values=zero_rounding_lines(values.T).T,
        low=-largest,
        high=largest,
        unit=unit.name,
        title="Force of the drive along the leg" if stroke else f"{found.word.capitalize()} of the drive",
        note="Positive pushes the piston out (the leg is compressed), negative holds it back."
        if stroke
        else "Positive pushes along the carriage's axis, or about the crank's.",
        anchors=_DIVERGING,
        none="no drive",
    )


def _margin(study: model.Study, data: Dataset) -> LegColors:
    found = drives(data)
    place = found.position.reindex(leg=data.leg).values
    travels = [leg.carriage.stroke if leg.carriage is not None else leg.stroke for leg in study.robot.legs]
    low, high = np.array([(s.min, s.max) if s else (np.nan, np.nan) for s in travels]).T
    factor, unit = (1e3, "mm") if found.place_unit == "m" else (180 / np.pi, "deg")
    values = factor * np.minimum(place - low, high - place)
    return LegColors(
        values=values,
        low=0.0,
        high=max(1e-9, float(np.nan_to_num(values).max())),
        unit=unit,
        title="Stroke left to the nearer end",
        note="0: at an end of leg.stroke; red: beyond it; grey: a leg without stroke.",
        anchors=_SEQUENTIAL,
        below=_BEYOND,
    )


def _bending(study: model.Study, data: Dataset) -> LegColors:
    size = np.linalg.norm(data.tip_deflection.values, axis=-1)
    size = size if size.max() >= NOTHING else 0 * size
    unit = scale(size, "m")
    return LegColors(
        values=zero_rounding_lines(unit(size).T).T,
        low=0.0,
        high=float(unit(size).max()) or 1.0,
        unit=unit.name,
        title="Bending: piston tip off the cylinder's axis",
        note="True size, not magnified.",
        anchors=_SEQUENTIAL,
    )
