"""Results of a single actuator in space by name."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.solve.actuator_march import ActuatorMarch, amplitudes, lateral_signs, places
from flexapod.solve.many import tips
from flexapod.study.after.results import energy_results
from flexapod.study.record import Record
from flexapod.typing import Array

_NAMES = {"rotation": "angle", "elevation": "elevation", "extension": "length"}
_PUSHES = {"rotation": "torque", "elevation": "elevation_torque", "extension": "force"}


def space_results(study: model.ActuatorStudy, march: ActuatorMarch, record: Record) -> dict[str, Array]:
    """All variables of a simulation; deflections towards larger angles and towards larger elevations, (T9.9)."""
    shapes, q = march.system.kernel.shapes, record.q[:, 0]
    lateral = [sign * amplitudes(shapes, q, name) for name, sign in lateral_signs(shapes, 1.0, 1.0)]
    bent = np.stack(lateral, axis=1)
    results = {"tip_deflection": bent @ shapes.a.tip, "tip_position": tips(march.system, record.q)[:, 0]}
    for k, (motion, at) in enumerate(places(shapes).items()):
        name, rate = _NAMES[motion], record.rate[:, 0, shapes.l_index - at]
        results |= {name: q[:, at], f"{name}_rate": rate, _PUSHES[motion]: record.drive[:, 0, k]}
    results["length"] = results["length"] - study.actuator.hub_radius
    if shapes.a.count:
        results["mode_amplitude"] = bent
    for name, part in (("tip_stretch", "c"), ("tip_twist", "t")):
        results[name] = q[:, shapes.index(part)] if dict(shapes.layout).get(part) else np.zeros(len(q))
    return results | energy_results(record)
