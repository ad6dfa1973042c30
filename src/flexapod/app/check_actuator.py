"""What `flexapod check` says about a single actuator."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from flexapod.app.terminal import print_table, print_text
from flexapod.study.words import column, text

if TYPE_CHECKING:
    from flexapod.study.before.describe.actuator import ActuatorDescription, BeamDescription

__all__ = ["show_actuator"]


def show_actuator(found: ActuatorDescription) -> None:
    """Print a description in sections."""
    print_text(f"The beam stays in its hub. A single actuator over {found.duration:.4g} s ({found.fidelity}).")
    print_text()
    print_text("Motion")
    for line in _motion(found):
        print_text(line, indent=2)
    print_text()
    print_text("Beam, hub and extension held")
    unit, sags = column([beam.sag or math.nan for beam in found.beam], "m")
    length, lengths = column([beam.free_length for beam in found.beam], "m")
    header = [
        "",
        f"free length [{length}]",
        "frequencies [Hz]",
        "damping [%]",
        "free length / depth",
        f"sag if level [{unit}]",
    ]
    rows = [
        row
        for beam, free, sag in zip(found.beam, lengths, sags, strict=True)
        for row in _rows(beam, free, "no gravity" if sag == "n/a" else sag)
    ]
    print_table(header, rows)
    for beam in found.beam:
        if beam.problem:
            print_text(f"{beam.name}: {beam.problem}", indent=2)
    print_text()
    print_text("Remarks")
    for remark in found.remarks or ("None.",):
        print_text(remark, indent=2)


def _motion(found: ActuatorDescription) -> list[str]:
    lines = []
    if found.angles is not None:
        first, last = (math.degrees(angle) for angle in found.angles)
        lines.append(f"The hub turns from {first:.4g} to {last:.4g} deg.")
    if found.elevations is not None:
        first, last = (math.degrees(angle) for angle in found.elevations)
        lines.append(f"Its elevation goes from {first:.4g} to {last:.4g} deg.")
    if found.free_lengths is not None:
        low, high = found.free_lengths
        span = f"lies between {low:.4g} and {high:.4g} m" if high > low else f"stays at {low:.4g} m"
        lines.append(f"The free length {span}.")
    names = {
        "rotation": "The hub is driven by a torque: its angle",
        "extension": "The beam is driven by a force: its length",
        "elevation": "The hub is driven by a torque towards Z: its elevation",
    }
    rates = {"rotation": (found.angle_rate, "rad/s"), "extension": (found.length_rate, "m/s")}
    rates["elevation"] = (found.elevation_rate, "rad/s")
    for name in found.driven:
        rate, unit = rates[name]
        lines.append(f"{names[name]} is a result{f', starting at {rate:.4g} {unit}' if rate else ''}.")
    if found.tip_displacement:
        lines.append(f"The tip starts {text(found.tip_displacement, 'm')} off the line, released at rest.")
    if found.elevation_displacement:
        lines.append(f"The tip starts {text(found.elevation_displacement, 'm')} above the line, released at rest.")
    return lines


def _rows(beam: BeamDescription, free: str, sag: str) -> list[list[str]]:
    """A row of the table; of a beam with modes of several kinds one more for each kind."""
    slenderness = "n/a" if beam.slenderness is None else f"{beam.slenderness:.3g}"
    kinds = [(f"    {kind}", "", *numbers, "", "") for kind, *numbers in beam.by_kind]
    if len(kinds) > 1:
        return [[f"  {beam.name}", free, "", "", slenderness, sag], *map(list, kinds)]
    numbers = kinds[0][2:4] if kinds else ("n/a", "n/a")
    return [[f"  {beam.name}", free, *numbers, slenderness, sag]]
