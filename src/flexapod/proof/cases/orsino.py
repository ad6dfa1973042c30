"""Printed drive forces of rigid planar robots."""

from __future__ import annotations

import numpy as np

from flexapod.model import Home, Robot
from flexapod.model.joint import Carriage
from flexapod.model.leg import Leg
from flexapod.model.payload import Payload
from flexapod.model.piston import Cylinder, Piston, Strut
from flexapod.proof.case import Case, Check, checks
from flexapod.rigid.laws import Law
from flexapod.rigid.trajectory import Poses, poses_from_coordinates
from flexapod.solve.released import rigid_forces

AT = 0.05  # s
PRINTED = {
    "3-PRR": (-221.31533, 443.30184, -357.50533),
    "RPR+2-PRR": (-184.96848, 423.29547, -351.61880),
}
EA, EI = 1e8, 1e4  # N, N m^2; rigid all the same
BAR = 2 * 0.25 / 3  # kg m^2


def _rod(length: float, mass: float) -> Leg:
    carriage = Carriage(kind="slider", axis=np.array([1.0, 0, 0]), mass=1.0, side=-1)
    return Leg(chain="PRR", carriage=carriage, strut=Strut(length=length, rhoA=mass / length, EA=EA, EI=EI))


def robot(kind: str) -> Robot:
    """Sliders on one line, each to the left of its rod; or an RPR about the origin in place of the first."""
    legs = [_rod(1.0, 0.5), _rod(0.8, 0.4), _rod(1.0, 0.5)]
    if kind != "3-PRR":
        cylinder = Cylinder(mass=1.0, com=0.0, inertia=1 / 48, mouth=0.5)
        legs[0] = Leg(chain="RPR", cylinder=cylinder, piston=Piston(length=1.0, rhoA=0.5, EA=EA, EI=EI))
    return Robot(
        type=kind, plane="xy", base_joints=np.zeros((3, 3)), platform_joints=[[-0.5, 0, 0], [0, 0, 0], [0.5, 0, 0]],
        home=Home(position=np.array([2.0, 0.3, 0.0])), gravity=[0, -9.8, 0], legs=legs,
        payload=Payload(mass=2.0, inertia=[BAR] * 3, com=[0, 0, 0]),
    )  # fmt: skip


def path() -> Poses:
    """X = 2 + 0.1 cos w t, y = 0.3 + 0.1 sin w t, phi = pi / 9 sin 2 w t with w = 4 pi, at one instant."""
    w, turn = 4 * np.pi, np.pi / 9
    c, s, c2, s2 = (f(k * w * AT) for k in (1, 2) for f in (np.cos, np.sin))
    law = np.zeros((3, 1, 6))
    law[:, 0, [0, 1, 5]] = [
        [0.1 * c, 0.1 * s, turn * s2],
        [-0.1 * w * s, 0.1 * w * c, 2 * w * turn * c2],
        [-0.1 * w**2 * c, -0.1 * w**2 * s, -4 * w**2 * turn * s2],
    ]
    return poses_from_coordinates(Poses.at_rest(np.array([2.0, 0.3, 0.0]), np.eye(3)), Law(*law), np.zeros(3))


def _compute() -> list[Check]:
    found: list[Check] = []
    for kind, printed in PRINTED.items():
        ours = rigid_forces(robot(kind), path(), np.zeros(6)).drive_force[0]
        found += checks([f"{kind}, drive {i + 1}" for i in range(3)], printed, ours, 5.1e-6, "N", absolute=True)
    return found


ORSINO = Case(
    name="orsino",
    statement="Drive forces of the planar robots 3-PRR and 2-PRR+RPR on a fast path",
    source="Orsino, Hess-Coelho & Malvezzi 2021 (TMM2021-EXAMPLE.jl): printed numbers",
    argument="half a unit of the fifth decimal that is printed",
    compute=_compute,
)
