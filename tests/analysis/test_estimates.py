"""Estimates before a simulation, against closed forms and against the flexible model."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.linalg import eigh, null_space
from scipy.optimize import brentq
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.checks.estimates import (
    VibrationEstimate,
    _rung_on,
    bending_moments,
    buckling_load,
    residual_vibration,
)
from flexapod.analysis.description.residual_vibration import RestingRobot, expected_vibration
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, columns
from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import AxisMotion, Feedback, ForceDrive, Payload, ServoDrive, Simulation, Study
from flexapod.solve.kernel import kernel
from flexapod.solve.modal.at_poses import robot_modes
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.robot_system import robot_system
from flexapod.solve.shapes import space_shapes

pytestmark = pytest.mark.unit

LEG = paper_robot().robot.legs[0]
EI = LEG.piston.EI


def with_mouth(mouth):
    return LEG.replace(cylinder=LEG.cylinder.replace(mouth=mouth))


def test_buckling_load_in_the_limits():
    free = np.array([0.34, 0.6])
    np.testing.assert_allclose(buckling_load(with_mouth(0.0), free), np.pi**2 * EI / free**2, rtol=1e-12)
    # A very long rigid part is a clamp that slides sideways: a quarter; corrected by 1 / (1 + s / m)^2.
    np.testing.assert_allclose(buckling_load(with_mouth(1e6), free), np.pi**2 * EI / (4 * free**2), rtol=3e-6)


@pytest.mark.parametrize("mouth", [0.05, 0.315, 1.0])
def test_buckling_load_makes_the_own_stiffness_of_a_leg_singular(mouth):
    # The model's leg, its tip fixed: N^T K N under a thrust that rises until it is singular.
    robot = paper_robot().robot.replace(gravity=[0, 0, 0])
    axis = robot.home_vectors[0] / robot.home_lengths[0]
    p, leg = (
        robot_system(robot, Simulation(), 0.0).leg_p[0].copy(),
        kernel(space_shapes(lateral_basis("tip-load", 6), 2)),
    )
    p[columns(LEG_PARAMETERS, "mouth")] = mouth
    q, l_index = np.zeros(leg.shapes.size), leg.shapes.l_index
    q[l_index] = mouth + 0.6

    def smallest(thrust):
        _, _, K, tip = leg.leg_matrices(q, thrust * axis, p)
        N = null_space(np.vstack([tip, np.eye(len(q))[l_index]]))
        return np.linalg.eigvalsh(N.T @ K @ N)[0]

    expected = float(buckling_load(with_mouth(mouth), np.array([0.6]))[0])
    found = brentq(smallest, 0.5 * expected, 1.5 * expected, rtol=1e-10)
    assert found == pytest.approx(expected, rel=1e-8)  # Ritz: error of the load is the square of the shape's, 1e-6


def ended(chain, mouth):
    passive = {"passive": True} if chain == "UP" else {}
    return with_mouth(mouth).replace(chain=chain, **passive)


def hermite_load(mouth, free, base, platform, count=40):
    """Smallest buckling load of a column of finite elements whose foot is a rigid part of length `mouth`."""
    h, size = free / count, 2 * (count + 1)
    K, G = np.zeros((size, size)), np.zeros((size, size))
    k = EI / h**3 * np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                              [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]])  # fmt: skip
    g = np.array([[36, 3 * h, -36, 3 * h], [3 * h, 4 * h**2, -3 * h, -(h**2)],
                  [-36, -3 * h, 36, -3 * h], [3 * h, -(h**2), -3 * h, 4 * h**2]]) / (30 * h)  # fmt: skip
    for i in range(count):
        at = slice(2 * i, 2 * i + 4)
        K[at, at] += k
        G[at, at] += g
    T = np.zeros((size, size - 1))  # the mouth turns with the rigid part: y = m theta
    T[0, 0], T[1:, :] = mouth, np.eye(size - 1)
    kept = [0] * (not base) + list(range(1, size - 3)) + [size - 2] * (not platform)
    reduced = T[:, kept]
    rigid_part = np.zeros((size - 1, size - 1))
    rigid_part[0, 0] = mouth  # shortening of the rigid part, m theta^2
    G = reduced.T @ G @ reduced + rigid_part[np.ix_(kept, kept)]
    return np.min(eigh(reduced.T @ K @ reduced, G, eigvals_only=True))


@pytest.mark.parametrize("mouth", [0.0, 0.05, 0.315, 1.0])
@pytest.mark.parametrize(
    ("chain", "base", "platform"),
    [("UPF", False, True), ("UP", False, True), ("FPS", True, False), ("FPF", True, True), ("RPS", False, False)],
)
def test_buckling_loads_of_other_ends_against_finite_elements(chain, base, platform, mouth):
    found = float(buckling_load(ended(chain, mouth), np.array([0.6]))[0])
    assert found == pytest.approx(hermite_load(mouth, 0.6, base, platform), rel=1e-5)  # 40 elements: (ks / 40)^4


def test_ends_on_springs_count_as_pinned():
    sprung = LEG.replace(chain="FPF", base_joint={"bending": 20.0}, platform_joint={"bending": 20.0})
    free = np.array([0.6])
    assert buckling_load(sprung, free) == buckling_load(LEG, free)


def test_width_of_a_piston_without_section():
    assert LEG.piston.width == 0.027
    bare = LEG.piston.replace(diameter=None, E=None, density=None)
    assert bare.width == pytest.approx(0.027, rel=1e-12)


def moments(study, t):
    path = RigidPath(study, t)
    return bending_moments(path).max(axis=0)


def test_bending_moment_is_that_of_stiff_pistons_in_motion():
    # Bending a hundred times stiffer: its own vibration has no part in it, curvature times EI is the moment.
    study = paper_robot(motion={"duration": 0.5, "hold": 0.0}, profile="smooth")
    study = with_legs(study, lambda leg: leg.replace(
        piston=leg.piston.replace(EI=100 * EI, EA=100 * leg.piston.EA, E=None, density=None)))  # fmt: skip
    data = fx.simulate(study, modes=6, step=5e-4, output_step=5e-3, duration=0.5)
    basis = lateral_basis("tip-load", 6)
    free = data.leg_stroke.values - LEG.cylinder.mouth
    bend = np.einsum("tldk,ks->tlds", data.lateral_amplitude.values, basis.values(np.linspace(0, 1, 11), 2))
    found = 100 * EI * np.linalg.norm(bend, axis=2).max(axis=-1) / free**2
    expected = moments(study, data.time.values)
    # What is left, the pistons' own vibration and thrust times deflection, falls as 1 / EI: 2e-4 here.
    np.testing.assert_allclose(found, expected, atol=1e-3 * expected.max())


def test_bending_moment_of_a_leg_at_rest():
    # A rod between two joints under its own weight, the moment as on two supports, up to the mouth.
    study = paper_robot()
    robot = study.robot
    found = moments(study, np.zeros(1))[0]
    rhoA, mouth, length = LEG.piston.rhoA, LEG.cylinder.mouth, robot.home_lengths[0]
    sine = np.linalg.norm(robot.home_vectors[0][:2]) / length
    g, m_c, inner = 9.81 * sine, LEG.cylinder.mass, length - LEG.piston.length
    about_base = g * (m_c * LEG.cylinder.com + rhoA * (length**2 - inner**2) / 2)
    at_tip = about_base / length  # reaction of the joint across the leg
    d = np.linspace(0, length - mouth, 11)
    expected = np.abs(at_tip * d - rhoA * g * d**2 / 2).max()
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def single_mode(T, height=1e-3, damping=0.0, profile="quintic"):
    """A light-legged robot that heaves: the payload on six axial springs, its vertical mode, and its path."""
    study = with_legs(paper_robot(), lambda leg: leg.replace(
        damping=damping,
        cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0), piston=leg.piston.replace(rhoA=1e-9, E=None, density=None)
    ))  # fmt: skip
    payload = Payload(mass=100.0, inertia=[17.88] * 3, com=[0, 0, 0])
    robot = study.robot.replace(payload=payload, gravity=[0, 0, 0])
    study = study.replace(robot=robot, motion=AxisMotion(type="heave", amplitude=height, duration=T, profile=profile))
    simulation = study.simulation.replace(fidelity="lumped")
    t = np.linspace(0.0, T, 4001)
    path = kinematics.poses(robot, study.motion, t)
    end = kinematics.Poses.at_rest(path.position[-1], path.rotation[-1])
    return robot, robot_modes(robot, simulation, end), t, path


def acceleration(x):
    """Acceleration of the quintic law of unit stroke and duration."""
    return 60 * x - 180 * x**2 + 120 * x**3


def quintic(s):
    """Residual amplitude over stroke of one mode driven by the quintic law, s = omega T."""
    return 120 / s**5 * abs((12 - s**2) * np.sin(s / 2) - 6 * s * np.cos(s / 2))


def test_closed_form_of_the_quintic_law():
    # The published value at s = 10, and Duhamel's integral of its acceleration done by quadrature.
    assert quintic(10.0) == pytest.approx(0.08083873, abs=5e-9)
    parts = [quad(lambda x, f=f: acceleration(x) * f(10 * x), 0, 1, epsabs=1e-12)[0] for f in (np.sin, np.cos)]
    assert np.hypot(*parts) / 10 == pytest.approx(quintic(10.0), rel=1e-10)


def test_residual_vibration_of_one_mode_is_the_closed_form():
    height = 1e-3
    robot, modes, *_ = single_mode(0.1)
    vertical = int(np.abs(modes.shapes[:, -4]).argmax())
    omega = 2 * np.pi * modes.frequency[vertical]
    for s in (6.0, 10.0, 25.0):
        robot, modes, t, path = single_mode(s / omega, height)
        found = residual_vibration(robot, modes, t, path)
        # The direction of the legs turns by 1e-3 over the stroke, and the stiffness with it.
        assert found.total == pytest.approx(quintic(s) * height, rel=5e-3)
        assert found.amplitude.argmax() == vertical


def test_jumps_of_the_rate_are_impacts():
    # Constant rate v: the payload, at rest, is left behind at v; at the end the command stops under it.
    height, T = 1e-3, 0.0123
    robot, modes, t, path = single_mode(T, height, profile="linear")
    j = int(np.abs(modes.shapes[:, -4]).argmax())
    omega, v = 2 * np.pi * modes.frequency[j], height / T
    from_rest = residual_vibration(robot, modes, t, path).amplitude[j]
    assert from_rest == pytest.approx(2 * v / omega * abs(np.sin(omega * T / 2)), rel=5e-3)  # turn of the legs
    moving = residual_vibration(robot, modes, t, path, from_rest=False).amplitude[j]
    assert moving == pytest.approx(v / omega, rel=5e-3)


def test_estimate_bounds_and_meets_the_simulated_vibration():
    study = paper_robot()
    T = 0.25
    study = study.replace(motion=study.motion.replace(duration=T, hold=0.1, amplitude=0.1))
    data = fx.simulate(study, step=2e-4, duration=T + 0.1, fidelity="lumped")
    after = data.com_deviation.sel(time=slice(T, None)).values
    found_modes = robot_modes(
        study.robot,
        study.simulation.replace(fidelity="lumped"),
        kinematics.poses(study.robot, study.motion, np.array([T])),
    )
    t = np.linspace(0, T, 4001)
    estimate = residual_vibration(study.robot, found_modes, t, kinematics.poses(study.robot, study.motion, t))
    simulated = np.linalg.norm(after - after.mean(axis=0), axis=1).max()
    # All modes in phase is an upper bound; frozen directions over 0.1 rad and no gyroscopic terms cost some per cent.
    assert 0.5 * estimate.total < simulated < 1.1 * estimate.total


def vibration(amplitude, ratio, frequency=(10.0, 20.0), band=1e-6):
    return VibrationEstimate(
        frequency=np.array(frequency), damping_ratio=np.array(ratio), amplitude=np.array(amplitude),
        settling=np.zeros(2), band=band,
    )  # fmt: skip


def test_time_to_band():
    one = vibration([1e-3, 0.0], [0.01, 0.01])
    assert one.time_to_band() == pytest.approx(np.log(1e3) / (0.01 * 2 * np.pi * 10), rel=1e-9)
    two = vibration([1e-3, 2e-3], [0.01, 0.02])
    t = two.time_to_band()
    left = 1e-3 * np.exp(-2 * np.pi * 0.1 * t) + 2e-3 * np.exp(-2 * np.pi * 0.4 * t)
    assert left == pytest.approx(1e-6, rel=1e-9)
    assert vibration([4e-7, 5e-7], [0.0, 0.0]).time_to_band() == 0.0
    assert vibration([1e-3, 2e-6], [0.01, 0.0]).time_to_band() == np.inf


def test_time_to_band_with_an_undamped_rest_inside_the_band():
    # The damped mode must fall to what the undamped one leaves of the band.
    t = vibration([1e-3, 9e-7], [0.01, 0.0]).time_to_band()
    assert t == pytest.approx(np.log(1e-3 / 1e-7) / (0.01 * 2 * np.pi * 10), rel=1e-6)


def test_damping_shortens_the_vibration_as_duhamel_says():
    T, ratio = 0.05, 0.2
    robot, modes, t, path = single_mode(T)
    j = int(np.abs(modes.shapes[:, -4]).argmax())
    omega, ratios = 2 * np.pi * modes.frequency[j], np.zeros_like(modes.damping_ratio)
    ratios[j] = ratio
    found = residual_vibration(robot, replace(modes, ratio=lambda: ratios), t, path, band=1e-9)

    def rates(time, y):
        """One damped oscillator under the same acceleration, as an initial value problem."""
        return [y[1], -1e-3 * acceleration(time / T) / T**2 - 2 * ratio * omega * y[1] - omega**2 * y[0]]

    end = solve_ivp(rates, (0, T), [0, 0], rtol=1e-10, atol=1e-16).y[:, -1]
    damped = omega * np.sqrt(1 - ratio**2)
    envelope = np.hypot(end[0], (end[1] + ratio * omega * end[0]) / damped)
    assert found.amplitude[j] == pytest.approx(envelope, rel=5e-3)  # turn of the legs over the stroke
    assert found.settling[j] == pytest.approx(np.log(envelope / 1e-9) / (ratio * omega), rel=5e-3)


def test_overdamped_modes_do_not_vibrate():
    robot, modes, t, path = single_mode(0.05)
    found = residual_vibration(robot, replace(modes, ratio=lambda: np.full_like(modes.frequency, 1.5)), t, path)
    assert len(found.frequency) == 0
    assert found.total == 0.0
    assert found.time_to_band() == 0.0


def test_what_is_fed_forward_does_not_excite():
    """Residual vibration of force drives that replay the rigid forces, once that of drives without them: 40 times.

    Against the flexible model. The estimate has the masses and directions of the end pose and all modes in phase: at
    least what is found, and here less than three times.
    """
    drives = {
        "force": ForceDrive(type="force", law="rigid", feedback=Feedback(stiffness=3e6, damping=200.0)),
        "servo": ServoDrive(type="servo", stiffness=3e6, damping=200.0),
    }
    told, found = {}, {}
    for name, drive in drives.items():
        study = paper_robot(leg={"drive": drive}, fidelity="lumped", duration=0.3, step=5e-4)
        study = study.replace(motion=AxisMotion(type="roll", amplitude=np.deg2rad(5), duration=0.1, hold=0.2))
        elastic = ElasticRobot(study.robot, study.simulation, study.load)
        told[name] = expected_vibration(RestingRobot(study, elastic, 0.1)).amplitude
        rest = fx.simulate(study).com_deviation.sel(time=slice(0.1, None))
        found[name] = float(((rest - rest.mean("time")) ** 2).sum("axis").max() ** 0.5)
    assert found["force"] < 0.05 * found["servo"]
    for name in drives:
        assert found[name] < told[name] < 3 * found[name]


def test_the_moment_of_the_platform_joint_bends_its_leg():
    """A passive leg without weight, universal at its base: the moment falls in proportion from the tip to the base."""
    robot = ROBOTS["3-UPS+UP"]().replace(gravity=[0.0, 0.0, 0.0])
    still = AxisMotion(type="heave", amplitude=0.0, duration=1.0)
    path = RigidPath(Study(robot=robot, motion=still, simulation=paper_robot().simulation), np.zeros(1))
    path.wrench = np.array([[30.0, 20.0, 0.0, 0.0, 0.0, 0.0]])
    force, moment = path.forces.joint_force[0, 3], path.forces.joint_moment[0, 3]
    axis, length = path.axes[0, 3], path.legs.length[0, 3]
    at_tip = np.cross(axis, moment)
    across = force - (force @ axis) * axis
    np.testing.assert_allclose(at_tip, length * across, atol=1e-9 * np.abs(moment).max())
    assert bending_moments(path)[:, 0, 3].max() == pytest.approx(np.linalg.norm(at_tip), rel=1e-12)


@pytest.mark.parametrize("count", [2, 3, 90, 101, 2000])
def test_impulses_ring_on_as_each_by_itself(count):
    """Phases of up to 1e4 rad are right to 1e4 times the rounding of a number, 2e-16, in both sums."""
    some = np.random.default_rng(count)
    impulse, t = some.normal(size=(count + 1, 4)), np.linspace(0.0, 2.0, count)
    rate = np.array([5000j - 1.0, 700j - 50.0, 3j, -2.0 + 0j])
    at = [t[0], *(0.5 * (t[1:] + t[:-1])), t[-1]]
    expected = sum(part * np.exp(rate * (t[-1] - instant)) for part, instant in zip(impulse, at, strict=True))
    np.testing.assert_allclose(_rung_on(impulse, rate, t), expected, rtol=0, atol=1e-11 * np.abs(impulse).sum())
