"""Least times against the literature, by an integrator of SciPy, and of a robot that is one oscillator."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import flexapod as fx
from flexapod.commissioning.feedforward.least_time import least_time
from flexapod.commissioning.feedforward.loaded_path import drive_limits
from flexapod.control import StateSpace
from flexapod.kinematics import coordinates

pytestmark = pytest.mark.analytic

# m1 = m2 = k = 1, |u| <= 1, a unit move: Singh, Kabamba & McClamroch 1989; Liu & Wie 1992 (robust), to four digits
SWITCHES = {False: (1.0027, 2.1089, 3.2152), True: (0.7124, 1.6563, 2.9330)}
END = {False: 4.2179, True: 5.8660}


def two_masses(k: float = 1.0) -> StateSpace:
    A = [[0, 0, 1, 0], [0, 0, 0, 1], [-k, k, 0, 0], [k, -k, 0, 0]]
    return StateSpace(
        A=A, B=[[0], [0], [1], [0]], C=[[0, 1, 0, 0]], D=[[0]], inputs=("force",), outputs=("place",),
        states=("x1", "x2", "v1", "v2"), units={"force": "N", "place": "m"},
    )  # fmt: skip


def at_end(found, k: float = 1.0) -> np.ndarray:
    """State of two masses after the input, integrated from switch to switch."""
    x, sign, before = np.zeros(4), found.first, 0.0
    for t in [*found.times, found.duration]:

        def rates(_, y, sign=sign):
            return [y[2], y[3], -k * (y[0] - y[1]) + sign, k * (y[0] - y[1])]

        x = solve_ivp(rates, (before, t), x, rtol=1e-11, atol=1e-13).y[:, -1]
        sign, before = -sign, t
    return x


@pytest.mark.parametrize("robust", [False, True])
def test_two_masses_and_a_spring(robust: bool) -> None:
    found = fx.time_optimal(two_masses(), end=1.0, robust=robust)
    half = 5e-5  # of the last printed digit
    np.testing.assert_allclose(found.times[:3], SWITCHES[robust], rtol=0, atol=half + 1e-9)
    assert found.duration == pytest.approx(END[robust], abs=half + 1e-9)
    np.testing.assert_allclose(found.times, found.duration - found.times[::-1], rtol=0, atol=1e-9)  # mirrored
    np.testing.assert_allclose(at_end(found), [1, 1, 0, 0], rtol=0, atol=1e-8)  # of the integrator
    assert found.rigid == pytest.approx(2 * np.sqrt(2), abs=1e-6)  # a mass of 2, pushed and braked
    assert "vibrat" in repr(found)


def test_without_vibration_unequal_masses_take_what_their_sum_takes() -> None:
    """1 and 3 kg on a spring and a damper, pushed at the first: a mass of 4 kg takes 2 sqrt(4)."""
    k, c = 2.0, 0.1
    system = StateSpace(
        A=[[0, 0, 1, 0], [0, 0, 0, 1], [-k, k, -c, c], [k / 3, -k / 3, c / 3, -c / 3]], B=[[0], [0], [1], [0]],
        C=[[0, 1, 0, 0]], D=[[0]], inputs=("force",), outputs=("place",), states=("x1", "x2", "v1", "v2"), units={},
    )  # fmt: skip
    found = fx.time_optimal(system, end=1.0)
    assert found.rigid == pytest.approx(4.0, abs=1e-6)
    assert found.duration > 4.0


def test_what_is_robust_is_quieter_where_the_spring_is_another() -> None:
    def energy(x: np.ndarray, k: float) -> float:
        return 0.5 * (x[2] - x[3]) ** 2 + k * (x[0] - x[1]) ** 2

    left = [energy(at_end(fx.time_optimal(two_masses(), end=1.0, robust=r), 1.05), 1.05) for r in (False, True)]
    assert left[1] < 0.05 * left[0]  # second order against first: squares of 0.05 and 1


def test_a_larger_limit_scales_the_way() -> None:
    one, two = (fx.time_optimal(two_masses(), end=x, limit=x) for x in (1.0, 7.0))
    np.testing.assert_allclose(one.times, two.times, rtol=1e-9)
    t = np.array([-1.0, 0.5, 1.5, 9.0])
    np.testing.assert_array_equal(two(t), [0.0, 7.0, -7.0, 0.0])


def heaving() -> tuple[fx.Study, float, float]:
    """A symmetric hexapod of six springs; its frequency in heave [Hz], and strokes per heave at home, by hand."""
    study = fx.preset("paper-robot")
    leg, payload = study.robot.legs[0], study.robot.payload
    bare = leg.replace(
        piston=fx.model.leg.piston.Piston(
            length=leg.piston.length, EA=3e-3 * leg.piston.EA, EI=leg.piston.EI, rhoA=0.0
        ),
        cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0),
        damping=0.0,
    )
    robot = study.robot.replace(legs=(bare,) * 6, payload=payload.replace(com=[0, 0, 0]), gravity=[0, 0, 0])
    axes = robot.platform_joints + robot.home_position - robot.base_joints
    sine = float(axes[0, 2] / np.linalg.norm(axes[0]))
    w = np.sqrt(6 * 3e-3 * leg.piston.EA / leg.piston.length * sine**2 / payload.mass)
    motion = fx.model.AxisMotion(type="heave", amplitude=1e-3, duration=1.0, hold=0.5)
    study = study.replace(robot=robot, motion=motion, simulation=fx.model.Simulation(fidelity="lumped"))
    return study, float(w / (2 * np.pi)), sine


def test_a_robot_in_heave_takes_what_a_mass_takes_and_leaves_no_vibration() -> None:
    study, frequency, sine = heaving()
    limit = 4 * 1e-3 * sine * frequency**2 / 1.3**2  # full acceleration, full brake: 1.3 periods
    found = least_time(study, acceleration=limit, residual="1 um")
    rigid = 1.3 / frequency
    # accelerations that are cubic between 48 rows lose some of them at each jump; lengths change by 1e-3 on the way
    assert rigid * 0.998 < found.unbounded < 1.1 * rigid
    assert found.unbounded < found.duration < 2.3 / frequency
    assert found.residual[0] < 1e-6 < 0.01 * found.residual[1]
    exact = found.study.simulation.replace(tolerance=1e-5, output_step=found.duration / 200)
    data = fx.simulate(found.study.replace(simulation=exact))
    after = data.tool_deviation.values[data.time.values >= found.duration]
    # the linear model errs by 2 % of what would be left without it at most
    assert np.linalg.norm(after, axis=1).max() < 1e-6 + 0.02 * found.residual[1]
    bend = coordinates(found.study.motion, np.linspace(0.0, found.duration, 2001)).acceleration[:, 2]
    assert np.abs(bend).max() * sine < 1.01 * limit


def test_forces_of_a_robot_that_gives_way_keep_their_limits_too() -> None:
    """A mass on springs that is pushed in heave: what the springs carry, m (z'' of the tool), by places of the tool in
    a march within 1e-6, differences over 1/400 of a period: 1e-4 of it. Shares of limits are found within 1.002."""
    study, frequency, sine = heaving()
    limit = 4 * 1e-3 * frequency**2 / 1.3**2 * study.robot.payload.mass / (6 * sine)
    found = least_time(study, force=limit, residual="1 um")
    assert found.duration > found.stiff > found.unbounded and "rigid robot would hold" in found.sentence
    exact = found.study.simulation.replace(tolerance=1e-6, output_step=1 / (400 * frequency), duration=None)
    data = fx.simulate(found.study.replace(simulation=exact))
    z, h = data.tool_position.values[:, 2], float(data.time[1] - data.time[0])
    carried = study.robot.payload.mass * np.diff(z, 2) / h**2 / (6 * sine)
    assert 0.9 * limit < np.abs(carried).max() < 1.004 * limit
    assert np.abs(data.drive_force.values).max() == pytest.approx(np.abs(carried).max(), rel=1e-3)
    # the march of what a rigid robot would take asks for more
    rigid = least_time(study, acceleration=limit * 6 * sine**2 / study.robot.payload.mass, residual="1 um")
    assert rigid.marched == 0 and rigid.duration == pytest.approx(found.stiff, rel=0.01)
    assert np.abs(fx.simulate(rigid.study).drive_force.values).max() > 1.1 * limit


@pytest.mark.parametrize(
    ("limits", "bounds"),
    [
        ({"torque": 10.0}, True),
        ({"force": 5e3}, True),
        ({"torque": 10.0, "force": 5e3}, True),
        ({"speed": 300.0}, False),
    ],
)
def test_forces_or_torques_of_screws_bound_accelerations_and_speeds_do_not(limits: dict, bounds: bool) -> None:
    study = fx.preset("machine-hexapod")
    legs = tuple(x.replace(drive=x.drive.replace(limits=x.drive.limits.__class__(**limits))) for x in study.robot.legs)
    study = study.replace(robot=study.robot.replace(legs=legs))
    if bounds:
        drive_limits(study, None, None, None)
    else:
        with pytest.raises(fx.InputError, match="the least time would be 0"):
            drive_limits(study, None, None, None)


def test_the_way_as_a_file(tmp_path: Path) -> None:
    study, frequency, _ = heaving()
    given = {"acceleration": 1e-3 * frequency**2, "residual": "1 mm"}
    found = fx.time_optimal(study, {"heave": 2e-4}, {"heave": -5e-4}, out=tmp_path / "way.toml", **given)
    again = fx.load(tmp_path / "way.toml")
    np.testing.assert_array_equal(again.motion.pose, found.motion.pose)
    np.testing.assert_allclose(again.motion.pose[[0, -1], 2], [2e-4, -5e-4], rtol=0, atol=1e-12)
    assert "takes" in found.notes[-1] and "by a second pass" in found.notes[-1]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "least time would be 0"),
        ({"acceleration": -1.0}, "not a limit"),
        ({"acceleration": 1.0, "end": {"heave": 0.0}}, "where the way starts"),
        ({"acceleration": 1.0, "residual": 0.0}, "not a bound"),
    ],
)
def test_what_has_no_least_time_is_refused(given: dict, words: str) -> None:
    with pytest.raises(fx.InputError, match=words):
        fx.time_optimal(fx.preset("paper-robot"), **given)


def test_a_weight_that_drives_cannot_hold_is_refused() -> None:
    with pytest.raises(fx.ComputationError, match="no time is enough"):
        fx.time_optimal(fx.preset("paper-robot"), force="10 N")
