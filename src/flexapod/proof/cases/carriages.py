"""Carriages: where they stand, what accelerating them does, and cranks of great radius."""

from __future__ import annotations

import numpy as np

from flexapod.model import AxisMotion, CombinedMotion, Robot
from flexapod.model.joint import Carriage
from flexapod.proof.case import Case, Check, checks
from flexapod.proof.parallel_robots import LOWER, UPPER, built, leg, ring, rod, sliders
from flexapod.rigid import Poses, inverse_kinematics, poses
from flexapod.solve.released import rigid_forces
from flexapod.typing import Array

WRENCH = np.array([30.0, -20, -100, 5, 4, 3])
LENGTH = 0.65  # of the rods of `sliders`


def _displaced(robot: Robot) -> Poses:
    amplitudes = {"surge": 0.02, "sway": -0.01, "heave": 0.03, "roll": 0.05, "pitch": -0.04, "yaw": 0.1}
    motion = CombinedMotion(amplitudes=amplitudes, duration=1.0)  # type: ignore[arg-type]
    return poses(robot, motion, np.array([1.0]))


def _on_the_rail(vector: Array) -> Array:
    return vector[:, 2] - np.sqrt(LENGTH**2 - (vector[:, :2] ** 2).sum(axis=1))


def _places() -> list[Check]:
    robot = sliders()
    path = _displaced(robot)
    tips = robot.platform_joints @ path.rotation[0].T + path.position[0], robot.home_tips
    moved, home = (_on_the_rail(tip - robot.base_joints) for tip in tips)
    exact, ours = moved - home, inverse_kinematics(robot, path).coordinate("chi")[0][0]
    return checks([f"carriage {i + 1}" for i in range(6)], exact, ours, 1e-12, "m", absolute=True)


CARRIAGE_PLACES = Case(
    name="carriage-places",
    statement="Way of the carriages of a 6-PUS from home, displaced and turned about all axes",
    source="closed form: a sphere about the platform joint meets the rail, z - sqrt(L^2 - x^2 - y^2)",
    argument="closed by Newton's method: rounding of a metre times the rail's slope to the rod",
    compute=_places,
)


def _accelerated() -> list[Check]:
    robot = sliders()
    motion = AxisMotion(type="heave", amplitude=0.05, duration=0.2, profile="quintic")
    path = poses(robot, motion, np.array([0.03, 0.08, 0.15]))
    moving = rigid_forces(robot, path, WRENCH)
    found: list[Check] = []
    s = np.array([0.03, 0.08, 0.15]) / 0.2
    acceleration = 0.05 / 0.2**2 * 60 * s * (1 - s) * (1 - 2 * s)
    for i, a in enumerate(acceleration):
        heavy = robot.replace(gravity=robot.gravity - np.array([0, 0, a]))
        still = rigid_forces(heavy, Poses.at_rest(path.position[i], path.rotation[i]), WRENCH)
        for kind in ("drive_force", "joint_force"):
            ours, exact = getattr(moving, kind)[i], getattr(still, kind)[0]
            gap = float(np.abs(ours - exact).max() / np.abs(exact).max())
            what = f"a = {a:.3g} m/s^2, {kind.replace('_', ' ')}"
            found.append(Check(what=what, reference=0, ours=gap, tolerance=1e-10, absolute=True))
    return found


ACCELERATED_CARRIAGES = Case(
    name="accelerated-carriages",
    statement="Drive and joint forces of a 6-PUS whose carriages all accelerate alike, against those at rest in a "
    "changed gravity; largest difference over the largest force",
    source="equivalence of acceleration and gravity, g - a; the quintic's acceleration in closed form",
    argument="rounding times the condition of the closures, below 1e3, and that of rates and accelerations",
    compute=_accelerated,
)


def _cranks(radius: float, feet: Array) -> Robot:
    """The legs of `sliders` on cranks whose ends, at `feet` at home, move along the rails to first order."""
    arms = radius * ring(1.0, LOWER)
    axes = np.cross(ring(1.0, LOWER), [0.0, 0.0, 1.0])
    ways = [Carriage(kind="crank", axis=axis, arm=arm, home=0.0) for axis, arm in zip(axes, arms, strict=True)]
    legs = [leg("RUS", carriage=way, strut=rod(LENGTH)) for way in ways]
    return built("6-RUS", feet - arms, ring(0.15, UPPER), 0.6, legs)


def _long_cranks() -> list[Check]:
    robot = sliders(mass=0.0)  # that of a balanced crank has no weight
    path = _displaced(robot)
    exact = rigid_forces(robot, path, WRENCH).drive_force[0]
    radii = (1e2, 1e3, 1e4)
    ours = []
    for radius in radii:
        long = _cranks(radius, robot.home_bases)
        ours.append(rigid_forces(long, path, WRENCH).drive_force[0] / radius)
    errors = np.abs(np.array(ours) - exact).max(axis=1)
    limit = (10 * ours[2] - ours[1]) / 9
    names = [f"leg {i + 1}, extrapolated" for i in range(6)]
    found = checks(names, exact, limit, 1e-6 * float(np.abs(exact).max()), "N", absolute=True)
    order = float(np.log10(errors[0] / errors[1]))
    return [*found, Check(what="order of the error in 1 / radius", reference=1, ours=order, tolerance=0.02)]


LONG_CRANKS = Case(
    name="long-cranks",
    statement="Torque over radius of cranks of 100 m to 10 km, against the force on sliders on the rails that their "
    "ends follow",
    source="a circle of great radius is a straight line",
    argument="way along the rail over radius, 1e-5 of 0.1 m and 10 km; extrapolated its square and the rounding of "
    "places at 10 km, 1e-12 m times forces by metres",
    compute=_long_cranks,
)
