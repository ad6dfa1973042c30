"""Feedforward commands: shapers, least times, zeros and inverses, loaded paths."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.simulation import simulate
from flexapod.commissioning.feedforward import compensate
from flexapod.commissioning.feedforward.actuator_inversion import inverse, tip_inversion
from flexapod.commissioning.feedforward.bang_bang import bang_bang_input
from flexapod.commissioning.feedforward.modal_path import path_vibration
from flexapod.commissioning.feedforward.shapers import insensitivity, shaper
from flexapod.common.arrays import Array
from flexapod.control import StateSpace
from flexapod.kinematics import coordinates, motion_law
from flexapod.model.leg.piston import Piston
from flexapod.model.motion import Profile
from flexapod.verification.case import Check, case, checks
from flexapod.verification.cases.integration import residual_share

SOFT = 3e-3  # of the stiffness of the preset's pistons: an oscillator of some 7 Hz


@case(
    "Width of the band in which shapers leave a twentieth of the vibration, over the frequency, undamped",
    source="Singhose, Seering & Singer 1994; Singhose, Porter, Tuttle & Singer 1997",
    argument="half a unit of the printed digits",
)
def _shaper_insensitivity() -> list[Check]:
    kinds, printed = ("zv", "zvd", "ei", "2hei"), (0.0637, 0.287, 0.399, 0.724)
    ours = [insensitivity(kind) for kind in kinds]
    return checks(kinds, printed, ours, [5e-5, 5e-4, 5e-4, 6e-4], absolute=True)


@case(
    "Impulses of ZV and ZVD for a mode of damping ratio 0.1, and what is left of it",
    source="Singer & Seering 1990: 1, K over 1 + K; 1, 2 K, K^2 over (1 + K)^2, K = exp(-z pi / sqrt(1 - z^2))",
    argument="rounding",
)
def _shaper_impulses() -> Iterator[Check]:
    K = float(np.exp(-0.1 * np.pi / np.sqrt(0.99)))
    for kind, exact in (("zv", [1, K]), ("zvd", [1, 2 * K, K**2])):
        made = shaper(kind, 3.0, 0.1)
        names = [f"{kind} {k + 1}" for k in range(len(exact))]
        yield from checks(names, np.array(exact) / np.sum(exact), made.amplitudes, 1e-14)
        yield Check(f"{kind}, left", 0.0, float(made.residual_share(3.0, 0.1)), 1e-14, absolute=True)


def two_masses() -> StateSpace:
    """Unit masses and spring, a force on the first, the place of the second."""
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-1, 1, 0, 0], [1, -1, 0, 0.0]])
    return StateSpace(
        A=A, B=np.eye(4)[:, 2:3], C=np.eye(4)[1:2], D=np.zeros((1, 1)), inputs=("force",), outputs=("place",),
        states=("x1", "x2", "v1", "v2"), units={"force": "N", "place": "m"},
    )  # fmt: skip


@case(
    "Least time of two unit masses and a unit spring, |u| <= 1, unit move: switches and end; robust against the spring",
    source="Singh, Kabamba & McClamroch 1989; Liu & Wie 1992",
    argument="half a unit of the fourth printed digit",
)
def _least_time() -> Iterator[Check]:
    printed = {False: (1.0027, 2.1089, 3.2152, 4.2179), True: (0.7124, 1.6563, 2.9330, 5.8660)}
    for robust, exact in printed.items():
        found = bang_bang_input(two_masses(), 1.0, robust=robust)
        names = [f"{'robust, ' * robust}{x}" for x in ("first", "second", "third", "end")]
        yield from checks(names, exact, [*found.times[:3], found.duration], 5.1e-5, "s", absolute=True)


@case(
    "Force that moves two masses and a spring so that the second does what it is told",
    source="flat: u = (m1 + m2) y'' + m1 m2 / k y'''', a way of degree 11",
    argument="the transform of the way falls as w^-4 beyond a thousand harmonics, times w^2: 1e-6 of the largest",
)
def _flat_masses() -> Iterator[Check]:
    way = np.polynomial.Polynomial([0, 0, 0, 0, 0, 0, 462, -1980, 3465, -3080, 1386, -252])

    def bend(t: Array, order: int) -> Array:
        return np.where((t >= 0) & (t <= 1), way.deriv(order)(t), 0.0)

    found = inverse(two_masses(), 1.0, lambda t: bend(t, 2))
    exact = 2 * bend(found.time, 2) + bend(found.time, 4)
    size = float(np.abs(exact).max())
    yield Check("largest", size, float(np.abs(found.value).max()), 1e-5, "N")
    yield Check("largest difference", 0.0, float(np.abs(found.value - exact).max()), 1e-5 * size, "N", absolute=True)


def _beam(**settings: object) -> model.ActuatorStudy:
    study = model.preset("paper-actuator")
    turn = model.ProfileLaw(law="smooth", amplitude=0.035, duration=0.5)
    return study.replace(
        motion=model.ActuatorMotion(rotation=turn, extension=model.RateLaw(rate=0.0)),
        initial=study.initial.replace(tip_displacement=0.0),
        simulation=model.Simulation(**settings),  # type: ignore[arg-type]
    )


@case(
    "Tip of a beam whose hub is turned before and after, in the march, against the path of a rigid beam",
    source="the path itself, 2 deg in 0.5 s; left alone the tip swings by 33 mm",
    argument="squares of the rate over the first frequency squared, 1e-5 of 33 mm, and the march's tolerance",
)
def _tip_path() -> Iterator[Check]:
    study = _beam(modes=5, tolerance=1e-6)
    for drives in ("given", "force"):
        found = tip_inversion(study, drives)
        data = simulate_actuator(found.study)
        length, t = study.actuator.free_length, data.time.values - found.inverse.before
        wanted = length * motion_law(study.motion.rotation, t).position  # type: ignore[arg-type]
        miss = np.abs(length * data.angle.values + data.tip_deflection.values - wanted).max()
        yield Check("hub turned" if drives == "given" else "torque", 0.0, float(miss), 1e-6, "m", absolute=True)


def _springs(stiffness: float = 1.0, **load: object) -> model.Study:
    """The paper's robot as six springs and a weight."""
    study = model.preset("paper-robot")
    leg = study.robot.legs[0]
    bare = leg.replace(
        piston=Piston(length=leg.piston.length, EA=stiffness * leg.piston.EA, EI=leg.piston.EI, rhoA=0.0),
        cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0),
        damping=0.0,
    )
    robot = study.robot.replace(legs=(bare,) * 6, payload=study.robot.payload.replace(**load))  # type: ignore[union-attr]
    return study.replace(robot=robot, simulation=model.Simulation(fidelity="lumped"))


@case(
    "Weight on six springs that are commanded a compensated path: where it is against the path",
    source="balance of forces and moments of six springs and a weight, solved by SciPy",
    argument="two corrections leave 1e-8 of 20 um, series 1e-7 of it; rounding of both solutions",
)
def _loaded_path() -> Iterator[Check]:
    study = _springs()
    motion = model.CombinedMotion(amplitudes={"roll": 0.3, "surge": 0.05, "yaw": 0.1}, duration=1.0)  # type: ignore[arg-type]
    ahead = compensate(study.replace(motion=motion))
    for t in (0.0, 0.37, 1.0):
        wanted, told = (coordinates(x, np.array([t])).position[0] for x in (motion, ahead.motion))
        off = _weight_pose(study.robot, told)[0] - _pose(study.robot, wanted)[0]
        yield Check(f"t = {t:g} s", 0.0, float(np.linalg.norm(off)), 2e-11, "m", absolute=True)


def _pose(robot: model.Robot, x: Array) -> tuple[Array, Array]:
    return robot.home_position + x[:3], Rotation.from_euler("xyz", x[3:]).as_matrix()


def _weight_pose(robot: model.Robot, x: Array) -> tuple[Array, Array]:
    """Place and attitude of the weight on springs of the lengths that the rigid robot has at coordinates x."""
    p0, R0 = _pose(robot, x)
    piston, load = robot.legs[0].piston, robot.payload
    free = np.linalg.norm(p0 + robot.platform_joints @ R0.T - robot.base_joints, axis=1)

    def displaced_pose(y: Array) -> tuple[Array, Array]:
        return p0 + 1e-5 * y[:3], Rotation.from_rotvec(1e-5 * y[3:]).as_matrix() @ R0

    def balance(y: Array) -> Array:
        p, R = displaced_pose(y)
        arms = robot.platform_joints @ R.T
        legs = p + arms - robot.base_joints
        long = np.linalg.norm(legs, axis=1)
        push, weight = (piston.EA / piston.length * (free - long) / long)[:, None] * legs, load.mass * robot.gravity  # type: ignore[union-attr]
        moment = np.cross(arms, push).sum(axis=0) + np.cross(R @ robot.com, weight)
        return np.concatenate([push.sum(axis=0) + weight, moment])

    return displaced_pose(least_squares(balance, np.zeros(6), xtol=1e-15, ftol=1e-15, gtol=1e-15).x)


def _heaving(profile: Profile, periods: float) -> tuple[model.Study, float]:
    """Symmetric hexapod of soft springs that heaves by a micrometre; its frequency [rad/s] in closed form."""
    study = _springs(SOFT, com=[0, 0, 0])
    robot, piston = study.robot.replace(gravity=[0, 0, 0]), study.robot.legs[0].piston
    axes = robot.platform_joints + robot.home_position - robot.base_joints
    sine = axes[:, 2] / np.linalg.norm(axes, axis=1)
    w = float(np.sqrt((piston.EA / piston.length * sine**2).sum() / robot.payload.mass))  # type: ignore[union-attr]
    motion = model.AxisMotion(type="heave", amplitude=1e-6, duration=periods * 2 * np.pi / w, profile=profile)
    return study.replace(robot=robot, motion=motion), w


@case(
    "Vibration that a heave leaves of a hexapod on springs by the linear model; ramps of whole periods leave none",
    source="an oscillator on a base: 120 / s^5 |(12 - s^2) sin(s/2) - 6 s cos(s/2)|, s = w T; a mean over periods",
    argument="24 steps of order 4 in a period: 1e-5; looked at 100 times in a period: 5e-4",
)
def _heave_left() -> Iterator[Check]:
    for periods in (1.7, 2.3):
        study, w = _heaving("quintic", periods)
        s = 2 * np.pi * periods
        exact = residual_share("quintic", s)
        moving = study.motion.end_time
        ours = path_vibration(study, moving, moving + 10 / w).largest_after(moving) / 1e-6
        yield Check(f"quintic, {periods:g} periods", exact, ours, 2e-3)
    study, w = _heaving("trapezoid", 4.0)
    moving = study.motion.end_time
    left = path_vibration(study, moving, moving + 10 / w).largest_after(moving) / 1e-6
    yield Check("ramps of a period", 0.0, left, 1e-4, absolute=True)


@case(
    "Tool of machine-hexapod in motion, weight, heat and inertia made up for, against its path: share of its own miss",
    source="the path itself",
    argument="a twentieth: what friction and the deflections' own motion may leave",
)
def _compensated_machine() -> Iterator[Check]:
    study = model.preset("machine-hexapod")
    own, ahead = simulate(study), simulate(compensate(study, 2))
    miss = [
        float(np.linalg.norm(x.tool_position.values - own.tool_position_rigid.values, axis=1).max())
        for x in (own, ahead)
    ]
    yield Check("miss over that of the study", 0.0, miss[1] / miss[0], 0.05, absolute=True)
