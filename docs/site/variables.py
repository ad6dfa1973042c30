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

#: Of Datasets whose labels are channels of a linear system: name, dimensions, unit, what it is, and what gives it.
LINEAR = """
compliance | output, input, frequency, part | output per input | motion of the tool by a wrench: `fx.compliance`
compliance_norm | frequency | mixed | its Frobenius norm
transmissibility | output, input, frequency, part | mixed | of the platform by the floor: `fx.transmissibility`
transmissibility_norm | frequency | mixed | its Frobenius norm
frequency_response | output, input, frequency, part | output per input | `.frequency_response`, `fx.read_frf`
pole | mode, part | s-1 | of a system, `.damp`; of a locus `gain, branch, part`
damping_ratio | mode | 1 | of its poles
open_zero | zero, part | s-1 | where branches of `fx.control.root_locus` end
h2_norm | output, input | mixed | of a system, `.h2`, with `reason` where it is infinite
hinf_norm | a number | mixed | largest singular value over frequency, `.hinf`
psd | spectrum_frequency, output | output squared per Hz | of outputs of a system that is shaken, `.psd`
cumulative_rms | spectrum_frequency, output | output | rms from here up
rms | output | output | of all frequencies
covariance | output, output_b | mixed | of outputs
rms_by_source | source, output | output | of each source, `.by_source`
step_response | output, input, time | output per input | of a system, `.step`; `impulse_response`, `.impulse`
gain_margin | actuator, side | 1 | factor at which a loop is at its limit: `fx.control.margins`
phase_margin | actuator | rad | lag that it bears
delay_margin | actuator | s | further delay that it bears
modulus_margin | actuator | 1 | least distance of the loop gain from -1
mass | pose, motion, motion_by | mixed | of `fx.linearize` at many poses
damping | pose, motion, motion_by | mixed | of the same
stiffness | pose, motion, motion_by | mixed | of the same
input_matrix | pose, motion, input | mixed | of the same
output_matrix | pose, output, motion | mixed | of the same
"""


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
    made[FOLDER / "linear-systems.md"] = _linear()
    made[FOLDER / "index.md"] = _index([place.stem for place in made])
    return made


def _linear() -> str:
    """Variables over channels: their names are those of the caller's inputs and outputs."""
    cells = [line.split(" | ") for line in LINEAR.strip().splitlines()]
    rows = "\n".join(f"| `{name}` | {dims} | {unit} | {words} |" for name, dims, unit, words in cells)
    return f"""# Linear systems

Labels of `input` and `output` are [channels](../../linear-model.md), with their units beside them as `input_units` and
`output_units`; `part` is real or imaginary.

| Name | Dimensions | Unit | What it is |
| --- | --- | --- | --- |
{rows}
"""


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
