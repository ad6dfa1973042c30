"""A 3-RPS: stiffness in closed form, and the motions that its own motions bring along."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from flexapod.model import CombinedMotion
from flexapod.model.payload import Payload
from flexapod.proof.case import Case, Check, checks
from flexapod.proof.parallel_robots import CYLINDER, PISTON, tripod
from flexapod.rigid import poses
from flexapod.study.static import stiffness

RADIUS, BASE, HEIGHT = 0.2, 0.35, 0.6  # of `tripod`
NAMES = ("along x", "along y", "along z", "about x", "about y", "about z", "x with pitch")


def _stiffness() -> list[Check]:
    load = Payload(mass=50.0, inertia=[2.0, 2.0, 3.0], com=[0.0, 0.0, 0.0])
    ours = stiffness(tripod().replace(gravity=[0, 0, 0], payload=load), modes=6, axial_modes=2).stiffness.values
    span = np.hypot(BASE - RADIUS, HEIGHT)
    sine, cosine = HEIGHT / span, (BASE - RADIUS) / span
    k, kb = PISTON.EA / PISTON.length, 3 * PISTON.EI / (span - CYLINDER.mouth) ** 3
    side, tilt = 1.5 * (k * cosine**2 + kb), 1.5 * k * (RADIUS * sine) ** 2
    coupling = 1.5 * k * RADIUS * sine * cosine
    exact = [side, side, 3 * k * sine**2, tilt, tilt, 3 * kb * RADIUS**2, coupling]
    return checks(NAMES, exact, [*np.diag(ours), abs(ours[0, 4])], 1e-9, "N/m, N, N m")


TRIPOD_STIFFNESS = Case(
    name="tripod-stiffness",
    statement="Stiffness of a 3-RPS at home: sideways and about the vertical only its pistons' bending holds it",
    source="bars along the legs, EA / L, and cantilevers across the hinges' planes, 3 EI / s^3, summed by hand",
    argument="the shapes contain the static answers: rounding, 1e-16 times the ratio of bars to cantilevers, 1e4, and "
    "the condition of the eliminated joints",
    compute=_stiffness,
)


def _parasitic() -> list[Check]:
    amplitudes = {"heave": 0.03, "roll": 0.25, "pitch": -0.2}
    motion = CombinedMotion(amplitudes=amplitudes, duration=1.0)  # type: ignore[arg-type]
    path = poses(tripod(), motion, np.array([0.3, 0.5, 1.0]))
    found: list[Check] = []
    for i, R in enumerate(path.rotation):
        place = [RADIUS / 2 * (R[0, 0] - R[1, 1]), -RADIUS * R[1, 0], 0.0]
        torsion = Rotation.from_matrix(R).as_quat(canonical=True)[2]
        ours = [*path.position[i, :2], torsion]
        names = [f"instant {i + 1}, {name}" for name in ("surge", "sway", "torsion / 2")]
        found += checks(names, place, ours, 1e-12, "m, 1", absolute=True)
    return found


TRIPOD_PARASITIC = Case(
    name="tripod-parasitic-motion",
    statement="Surge, sway and torsion that follow where heave, roll and pitch of a 3-RPS are commanded, turns to 0.25",
    source="closed form: three balls in the hinges' planes, x = h/2 (R11 - R22), y = -h R21, R12 = R21 (no torsion)",
    argument="closed by Newton's method: rounding of a metre, times the condition of the closures, below 1e3",
    compute=_parasitic,
)
