"""The variables of the Datasets: pages of tables, from the one table of names and units."""

from __future__ import annotations

from pathlib import Path

from flexapod.results.names import COORDINATES, GROUPS

FOLDER = Path("reference/variables")
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
        head = "| Name | Dimensions | Unit | What it is |\n| --- | --- | --- | --- |"
        made[FOLDER / f"{title.lower().replace(' ', '-')}.md"] = f"# {title}\n\n{OF[title]}\n\n{head}\n{rows}\n"
    made[FOLDER / "index.md"] = _index([place.stem for place in made])
    return made


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
