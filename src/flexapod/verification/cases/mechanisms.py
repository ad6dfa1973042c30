"""Mechanisms of other kinds: mobility, forces, carriages, a passive leg."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.kinematics import mobility
from flexapod.analysis.simulation import simulate
from flexapod.common.arrays import Array
from flexapod.kinematics import Poses, inverse_kinematics, poses
from flexapod.kinematics.laws import Law
from flexapod.kinematics.trajectory import poses_from_coordinates
from flexapod.model import AxisMotion, CombinedMotion, Home, Robot, ServoDrive, Study
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.joint import Carriage
from flexapod.model.leg.leg import Leg
from flexapod.model.leg.piston import Piston, Strut
from flexapod.model.study.payload import Payload
from flexapod.solve.statics.ideal_robot import rigid_forces
from flexapod.verification.case import Check, case, checks
from flexapod.verification.cases.integration import balance_checks
from flexapod.verification.robots import (
    LOWER,
    UPPER,
    build_robot,
    eight_legs,
    hexapod,
    leg,
    planar,
    ring,
    rod,
    sliders,
    tricept,
    tripod,
)

COUNTS = ("freedoms", "gruebler", "mobility", "redundant", "locked", "self_stress")
TABLE: dict[str, tuple[Callable[..., Robot], tuple[int, ...]]] = {  # the counts above
    "6-UPS": (hexapod, (36, 6, 6, 0, 0, 0)),
    "6-UPS on similar hexagons": (partial(hexapod, lower=LOWER, upper=LOWER), (36, 6, 6, 0, 3, 3)),
    "6-SPS": (partial(hexapod, "SPS"), (42, 12, 12, 0, 6, 0)),
    "6-UCU": (partial(hexapod, "UCU"), (36, 6, 6, 0, 0, 0)),
    "6-PUS": (sliders, (36, 6, 6, 0, 0, 0)),
    "8-UPS": (eight_legs, (48, 6, 6, 0, 0, 2)),
    "3-RPS": (tripod, (15, 3, 3, 0, 0, 0)),
    "3-PRS": (partial(sliders, "PRS", 0.5), (15, 3, 3, 0, 0, 0)),
    "3-UPU, axes along the circle": (partial(tripod, "UPU"), (15, 3, 3, 0, 0, 0)),
    "3-PUU": (partial(sliders, "PUU", 0.4), (15, 3, 3, 0, 0, 0)),
    "3-UPS+UP": (tricept, (21, 3, 3, 0, 0, 0)),
    "3-PRR in a plane": (planar, (18, 3, 3, 0, 0, 0)),
}


@case(
    "Joint freedoms, Gruebler's number, motions, redundant conditions, motions with locked drives and "
    "self-stress of twelve mechanisms",
    source="textbooks (Merlet 2006, Tsai 1999); singular on similar hexagons: Merlet; six idle turns of legs between "
    "balls",
    argument="whole numbers",
)
def _mobility_table() -> Iterator[Check]:
    for name, (make, counts) in TABLE.items():
        ours = mobility(make())
        values = [float(ours[key]) for key in COUNTS]
        yield from checks([f"{name}, {key}" for key in COUNTS], counts, values, 0.5, absolute=True)


AT = 0.05  # s
PRINTED = {
    "3-PRR": (-221.31533, 443.30184, -357.50533),
    "RPR+2-PRR": (-184.96848, 423.29547, -351.61880),
}
EA, EI = 1e8, 1e4  # N, N m^2; rigid all the same
BAR = 2 * 0.25 / 3  # kg m^2


def _slid(length: float, mass: float) -> Leg:
    carriage = Carriage(kind="slider", axis=np.array([1.0, 0, 0]), mass=1.0, side=-1)
    return Leg(chain="PRR", carriage=carriage, strut=Strut(length=length, rhoA=mass / length, EA=EA, EI=EI))


def planar_robot(kind: str) -> Robot:
    """Sliders on one line, each to the left of its rod; or an RPR about the origin in place of the first."""
    legs = [_slid(1.0, 0.5), _slid(0.8, 0.4), _slid(1.0, 0.5)]
    if kind != "3-PRR":
        cylinder = Cylinder(mass=1.0, com=0.0, inertia=1 / 48, mouth=0.5)
        legs[0] = Leg(chain="RPR", cylinder=cylinder, piston=Piston(length=1.0, rhoA=0.5, EA=EA, EI=EI))
    return Robot(
        type=kind, plane="xy", base_joints=np.zeros((3, 3)), platform_joints=[[-0.5, 0, 0], [0, 0, 0], [0.5, 0, 0]],
        home=Home(position=np.array([2.0, 0.3, 0.0])), gravity=[0, -9.8, 0], legs=legs,
        payload=Payload(mass=2.0, inertia=[BAR] * 3, com=[0, 0, 0]),
    )  # fmt: skip


def fast_path() -> Poses:
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


@case(
    "Drive forces of the planar robots 3-PRR and 2-PRR+RPR on a fast path",
    source="Orsino, Hess-Coelho & Malvezzi 2021 (TMM2021-EXAMPLE.jl): printed numbers",
    argument="half a unit of the fifth decimal that is printed",
)
def _orsino() -> Iterator[Check]:
    for kind, printed in PRINTED.items():
        ours = rigid_forces(kinematics.RigidPoses(planar_robot(kind), fast_path()), np.zeros(6)).drive_force[0]
        yield from checks([f"{kind}, drive {i + 1}" for i in range(3)], printed, ours, 5.1e-6, "N", absolute=True)


WRENCH = np.array([30.0, -20, -100, 5, 4, 3])
LENGTH = 0.65  # of the rods of `sliders`


def _displaced(robot: Robot) -> Poses:
    amplitudes = {"surge": 0.02, "sway": -0.01, "heave": 0.03, "roll": 0.05, "pitch": -0.04, "yaw": 0.1}
    motion = CombinedMotion(amplitudes=amplitudes, duration=1.0)  # type: ignore[arg-type]
    return poses(robot, motion, np.array([1.0]))


def _on_the_rail(vector: Array) -> Array:
    return vector[:, 2] - np.sqrt(LENGTH**2 - (vector[:, :2] ** 2).sum(axis=1))


@case(
    "Way of the carriages of a 6-PUS from home, displaced and turned about all axes",
    source="closed form: a sphere about the platform joint meets the rail, z - sqrt(L^2 - x^2 - y^2)",
    argument="closed by Newton's method: rounding of a metre times the rail's slope to the rod",
)
def _carriage_places() -> list[Check]:
    robot = sliders()
    path = _displaced(robot)
    tips = robot.platform_joints @ path.rotation[0].T + path.position[0], robot.home_tips
    moved, home = (_on_the_rail(tip - robot.base_joints) for tip in tips)
    exact, ours = moved - home, inverse_kinematics(robot, path).coordinate("chi")[0][0]
    return checks([f"carriage {i + 1}" for i in range(6)], exact, ours, 1e-12, "m", absolute=True)


@case(
    "Drive and joint forces of a 6-PUS whose carriages all accelerate alike, against those at rest in a "
    "changed gravity; largest difference over the largest force",
    source="equivalence of acceleration and gravity, g - a; the quintic's acceleration in closed form",
    argument="rounding times the condition of the closures, below 1e3, and that of rates and accelerations",
)
def _accelerated_carriages() -> Iterator[Check]:
    robot = sliders()
    motion = AxisMotion(type="heave", amplitude=0.05, duration=0.2, profile="quintic")
    path = poses(robot, motion, np.array([0.03, 0.08, 0.15]))
    moving = rigid_forces(kinematics.RigidPoses(robot, path), WRENCH)
    s = np.array([0.03, 0.08, 0.15]) / 0.2
    acceleration = 0.05 / 0.2**2 * 60 * s * (1 - s) * (1 - 2 * s)
    for i, a in enumerate(acceleration):
        heavy = robot.replace(gravity=robot.gravity - np.array([0, 0, a]))
        still = rigid_forces(kinematics.RigidPoses(heavy, Poses.at_rest(path.position[i], path.rotation[i])), WRENCH)
        for kind in ("drive_force", "joint_force"):
            ours, exact = getattr(moving, kind)[i], getattr(still, kind)[0]
            gap = float(np.abs(ours - exact).max() / np.abs(exact).max())
            what = f"a = {a:.3g} m/s^2, {kind.replace('_', ' ')}"
            yield Check(what, 0, gap, 1e-10, absolute=True)


def _cranks(radius: float, feet: Array) -> Robot:
    """The legs of `sliders` on cranks whose ends, at `feet` at home, move along the rails to first order."""
    arms = radius * ring(1.0, LOWER)
    axes = np.cross(ring(1.0, LOWER), [0.0, 0.0, 1.0])
    ways = [Carriage(kind="crank", axis=axis, arm=arm, home=0.0) for axis, arm in zip(axes, arms, strict=True)]
    legs = [leg("RUS", carriage=way, strut=rod(LENGTH)) for way in ways]
    return build_robot("6-RUS", feet - arms, ring(0.15, UPPER), 0.6, legs)


@case(
    "Torque over radius of cranks of 100 m to 10 km, against the force on sliders on the rails that their ends follow",
    source="a circle of great radius is a straight line",
    argument="way along the rail over radius, 1e-5 of 0.1 m and 10 km; extrapolated its square and the rounding of "
    "places at 10 km, 1e-12 m times forces by metres",
)
def _long_cranks() -> list[Check]:
    robot = sliders(mass=0.0)  # that of a balanced crank has no weight
    path = _displaced(robot)
    exact = rigid_forces(kinematics.RigidPoses(robot, path), WRENCH).drive_force[0]
    radii = (1e2, 1e3, 1e4)
    ours = []
    for radius in radii:
        long = _cranks(radius, robot.home_bases)
        ours.append(rigid_forces(kinematics.RigidPoses(long, path), WRENCH).drive_force[0] / radius)
    errors = np.abs(np.array(ours) - exact).max(axis=1)
    limit = (10 * ours[2] - ours[1]) / 9
    names = [f"leg {i + 1}, extrapolated" for i in range(6)]
    found = checks(names, exact, limit, 1e-6 * float(np.abs(exact).max()), "N", absolute=True)
    order = float(np.log10(errors[0] / errors[1]))
    return [*found, Check("order of the error in 1 / radius", 1, order, 0.02)]


STEPS = (5e-4, 2.5e-4)
SOFT = ServoDrive(stiffness=1e6, damping=2e3)  # some 40 Hz with the platform


@case(
    "Force along the passive leg of a moving, loaded Tricept whose guide weighs nothing, over the largest joint force",
    source="it slides freely: nothing pushes along it",
    argument="rounding times the condition of the closures, some ten to a hundred",
)
def _tricept_guide() -> list[Check]:
    robot = tricept()
    guide = robot.legs[3]
    bare = guide.replace(
        cylinder=guide.cylinder.replace(mass=0.0, com=0.0, inertia=0.0), piston=guide.piston.replace(rhoA=0.0)
    )
    robot = robot.replace(legs=(*robot.legs[:3], bare))
    motion = model.CombinedMotion(amplitudes={"heave": 0.03, "roll": 0.2, "pitch": -0.1}, duration=0.5)
    path = kinematics.poses(robot, motion, np.array([0.0, 0.1, 0.2, 0.4]))
    forces = rigid_forces(kinematics.RigidPoses(robot, path), WRENCH)
    axes = kinematics.leg_axes(robot, path, kinematics.inverse_kinematics(robot, path))[:, 3]
    force = forces.joint_force[:, 3]
    size = float(np.abs(forces.joint_force).max())
    along = float(np.abs((force * axes).sum(axis=-1)).max()) / size
    return [
        Check("force along the passive leg", 0, along, 1e-11, absolute=True),
        Check("its drive's force", 0, float(np.abs(forces.drive_force[:, 3]).max()) / size, 1e-11, absolute=True),
    ]  # fmt: skip


@case(
    "Energy balance of a flexible, damped Tricept on soft drives that rises by 30 mm in 0.1 s",
    source="conservation of energy",
    argument="the order of the method, two, and (omega h)^2 / 12 at 40 to 100 Hz of what vibrates",
)
def _tricept_energy() -> list[Check]:
    robot = tricept()
    legs = tuple(
        leg.replace(damping=0.01, axial_modes=0, **({} if leg.passive else {"drive": SOFT})) for leg in robot.legs
    )
    motion = AxisMotion(type="heave", amplitude=0.03, duration=0.1, profile="smooth")
    study = Study(
        robot=robot.replace(legs=legs), motion=motion, simulation=model.preset("paper-robot").simulation,
        initial=model.Initial(start="straight"),
    )  # fmt: skip
    runs = [simulate(study, modes=1, step=step, output_step=2e-3, duration=0.12) for step in STEPS]
    return balance_checks("", runs, 2e-4)
