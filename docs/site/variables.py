"""The variables of the Datasets: pages of tables, from the one table of names and units."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
from xarray import Dataset

import flexapod as fx
from flexapod.analysis.results.variables import COORDINATES, GROUPS, Variable
from flexapod.control import IFF, best_gain, impedance, margins, root_locus

FOLDER = Path("reference/variables")
HEAD = "| Name | Dimensions | Unit | What it is |\n| --- | --- | --- | --- |"
#: Which calls give the variables of a group.
OF = {
    "Paths and deviations": "Of `fx.simulate`: the payload, rigid and flexible, and what the legs do to it.",
    "Commands": "Of `fx.simulate` and `fx.inverse_kinematics`: what the motion asks for.",
    "Legs and drives": "Of `fx.simulate`, `fx.inverse_kinematics` and `fx.inverse_dynamics`.",
    "Energies": "Of `fx.simulate`.",
    "Stiffness and modes": "Of `fx.modes`, `fx.stiffness` and `fx.parts`.",
    "Mobility": "Of `fx.mobility`.",
    "Accuracy of a pose": "Of `fx.accuracy`.",
    "Play": "Of `fx.play`; at a pose, without the time, of `fx.accuracy`.",
    "Error budget": "Of `fx.budget`.",
    "Vibration": "Of `fx.vibration`.",
    "Single actuator": "Of `fx.simulate_actuator` and `fx.simulate_solid`, besides energies and deflection.",
}


def pages() -> dict[Path, str]:
    """Pages by place."""
    made = {}
    for title, found in GROUPS.items():
        rows = "\n".join(
            f"| `{name}` | {', '.join(f'`{dim}`' for dim in v.dims) or 'a number'} | {v.units} | {_cell(v.long_name)} |"
            for name, v in found.items()
        )
        made[FOLDER / f"{title.lower().replace(' ', '-')}.md"] = (
            f"# {title}\n\n{OF[title]}{_labels(found)}\n\n{HEAD}\n{rows}\n"
        )
    made[FOLDER / "linear-systems.md"] = _linear()
    made[FOLDER / "index.md"] = _index([place.stem for place in made])
    return made


@cache
def linear() -> dict[str, Dataset]:
    """What calls about linear systems return, of one small plant: names, units and words are those of the results."""
    study = fx.preset("nano-hexapod")
    plant = fx.linearize(study, inputs=["drive", "wrench"], outputs=["tool", "stroke", "force-sensor:drive"])
    plant = plant.reduce(below="2 kHz").select(outputs=["tool", "stroke:1", "force-sensor:drive"])
    law, hz = IFF(100.0, high_pass="5 Hz"), np.array([10.0, 100.0])
    shaken = {"wrench:fz": ([1.0, 100.0], [1e-4, 1e-4])}
    return {
        "`fx.compliance`": fx.compliance(study, hz),
        "`fx.transmissibility`": fx.transmissibility(study, hz),
        "`.frequency_response` of a system, `fx.read_frf`": plant.frequency_response(hz),
        "`.damp`": plant.damp(),
        "`.rga`": plant.rga(hz, "drive", "force-sensor:drive"),
        "`.h2`": plant.h2(),
        "`.hinf`": plant.hinf(),
        "`.psd`": plant.psd(shaken),
        "`.by_source`": plant.by_source(shaken),
        "`.step`": plant.step(0.01),
        "`.impulse`": plant.impulse(0.01),
        "`fx.control.root_locus`": root_locus(plant, law, [1.0, 2.0]),
        "`fx.control.best_gain`": best_gain(plant, law),
        "`fx.control.margins`": margins(plant, law),
        "`fx.control.impedance`": impedance(plant, hz, force="drive:1", place="stroke:1"),
        "`fx.linearize` at several poses": fx.linearize(study, {"surge": [0.0, 1e-5]}, inputs="wrench", outputs="tool"),
    }


def _linear() -> str:
    """Variables over channels: their names are those of the caller's inputs and outputs."""
    parts = [
        "# Linear systems",
        "Labels of `input` and `output` are [channels](../../linear-model.md), with their units beside them as\n"
        "`input_units` and `output_units`; `part` is real or imaginary.",
    ]
    for call, data in linear().items():
        rows = "\n".join(
            f"| `{name}` | {', '.join(f'`{dim}`' for dim in x.dims) or 'a number'} | {x.attrs.get('units', '')} "
            f"| {_cell(x.attrs.get('long_name', ''))} |"
            for name, x in data.data_vars.items()
        )
        parts += [f"## {call}", f"{HEAD}\n{rows}"]
    return "\n\n".join(parts) + "\n"


def _labels(found: Mapping[str, Variable]) -> str:
    """What the labels of the dimensions of these variables are, in a sentence each."""
    used = [dim for dim in COORDINATES if any(dim in v.dims for v in found.values())]
    return "".join(
        f" `{dim}`: {', '.join(f'`{x}`' for x in COORDINATES[dim][0])}, {COORDINATES[dim][1]}." for dim in used
    )


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _index(names: list[str]) -> str:
    labels = "\n".join(
        f"| `{dim}` | {', '.join(f'`{label}`' for label in found)} | {words} |"
        for dim, (found, words) in COORDINATES.items()
    )
    listed = "\n".join(names)
    return f"""# Variables of the Dataset

All calls return an `xarray.Dataset` in SI units: each variable has its `units` and `long_name` as attributes. A unit
"mixed" means that it depends on the label; the words say which. In files (`results.nc`) names are the same.

```{{toctree}}
:maxdepth: 1

{listed}
```

## Dimensions with fixed labels

| Dimension | Labels | What they stand for |
| --- | --- | --- |
{labels}

`leg` counts from 1. `time` is in s; `mode` counts from 1, the lowest frequency first.
"""
