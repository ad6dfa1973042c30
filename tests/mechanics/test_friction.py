"""Friction: public and closed-form cases, limits, passivity, energy, lost motion, Eqs. (T19.1)-(T19.12)."""

import dataclasses
from functools import cache
from itertools import pairwise

import casadi
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.helpers import legs_of_all_kinds
from tests.helpers.machines import BODY, SCREW, TUBE, machine, study
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.runs import balance, run_robot

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.checks.screws import steady_friction
from flexapod.analysis.error_budget.text import part_words
from flexapod.kinematics.rotations import exponential
from flexapod.mechanics.elements.element import LegContext
from flexapod.mechanics.elements.friction import (
    BaseFriction,
    DriveFriction,
    PlatformFriction,
    bristle_friction,
    joint_sliding_speed,
)
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.springs import springs_along
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.mechanics.leg.sliding import friction_functions
from flexapod.mechanics.shapes import lateral_basis
from flexapod.mechanics.symbolic.functions import Interpreted
from flexapod.mechanics.symbolic.vocabulary import constant, symbol, zeros
from flexapod.model import Feedback, Joint, JointFriction, ScrewFriction, ServoDrive, StrokeFriction, override
from flexapod.solve.friction import bristle_parameters, sliding_jacobian
from flexapod.solve.kernel import kernel
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.statics.lost_motion import lost_motion, reversal
from flexapod.solve.statics.stiffness import displacement, tool_motion

pytestmark = pytest.mark.consistency

RUBS = Joint(friction=JointFriction(moment=2.0))
PLAIN = Joint(friction=JointFriction(mu=0.1, diameter=0.04))
SERVO = SCREW.replace(command="servo", loop=Feedback(stiffness=5e3, damping=20.0))
EVERYWHERE = {"base_joint": RUBS, "platform_joint": PLAIN, "drive": SERVO.replace(friction=ScrewFriction(torque=0.5))}
# Table I of the paper: sigma0 1e5 N/m, sigma1 sqrt(1e5), sigma2 0.4, Fc 1 N, Fs 1.5 N, vs 1 mm/s
PAPER = np.array([1.0, 0.0, 1e-5, 0.5, 1e3, 0.4, np.sqrt(1e5) / 1e5, 0.0])


@cache
def rubber(numbers=tuple(PAPER), *, falling=False, directions=1):
    """Force, bristle and its rate at a step's end, of rates there and at its begin, a bristle, the step."""
    x = [symbol(name, directions) for name in ("v", "before", "z")] + [symbol("h")]
    found = bristle_friction(constant(np.array(numbers)), zeros(1), *x, falling=falling)
    return casadi.Function("rubbing", x, [found.force, found.bristles, found.rate, found.stored])


def at(v, z, **more):
    """Force and rate of the bristle at a state."""
    force, _, rate, _ = rubber(**more)(v, v, z, 0.0)
    return float(force), float(rate)


def test_stick_slip_of_the_public_case():
    # Exudyn's Examples/lugreFrictionTest.py: 1 kg pulled through 2 N/m at 0.1 m/s; x and z after 25 s, some ten slips.
    def rates(t, y):
        force, z_rate = at(y[1], y[2])
        return [y[1], 2 * (0.1 * t - y[0]) - force, z_rate]

    x, _, z = solve_ivp(rates, (0, 25), [0, 0, 0], method="LSODA", rtol=1e-12, atol=1e-14).y[:, -1]
    assert x == pytest.approx(1.908839199226505, abs=1e-8)
    assert z == pytest.approx(1.1816795455868868e-05, abs=1e-8)


def breakaway(rate):
    """Force at which 1 kg breaks away under a force that grows [N], of a rate [N/s]: friction at its largest."""

    def rates(t, y):
        force, z_rate = at(y[1], y[2])
        return [y[1], rate * t - force, z_rate]

    found = solve_ivp(rates, (0, 2.0 / rate), [0, 0, 0], method="LSODA", rtol=1e-9, atol=1e-12, max_step=0.02 / rate)
    return max(at(v, z)[0] for v, z in found.y[1:].T if v < 0.01)


def test_break_away_force_falls_with_the_force_rate():
    # Canudas de Wit et al. (1995), Fig. 4: from Fs at slow growth towards Fc.
    found = [breakaway(rate) for rate in (0.1, 5.0, 50.0)]
    assert found[0] == pytest.approx(1.5, abs=0.02)
    assert found[0] > found[1] > found[2] > 1.0


def walked(path, **more):
    """Forces along a path of places, steps of a second, from rest."""
    z, forces, step = 0.0, [], rubber(**more)
    for way in np.diff(path):
        force, z, *_ = step(way, way, z, 1.0)
        forces.append(float(force))
    return np.array(forces)


DAHL = (1.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_presliding_does_not_depend_on_rate_and_is_a_loop():
    path = 2e-3 * np.sin(np.linspace(0, 4 * np.pi, 401))
    step = rubber(DAHL)
    z, slow, h = 0.0, [], 7.0  # the same path, seven times as slow
    for way in np.diff(path):
        force, z, *_ = step(way / h, way / h, z, h)
        slow.append(float(force))
    force = walked(path, numbers=DAHL)
    np.testing.assert_allclose(slow, force, rtol=0, atol=1e-12)
    # What was before is forgotten along the way as exp(-way / presliding): in a cycle of 8 mm to 3e-4
    again = walked(np.append(path, path[1:201]), numbers=DAHL)
    np.testing.assert_allclose(again[400:], again[200:400], rtol=0, atol=4e-4)
    # the steady loop encloses what one cycle loses: less than 4 Fc times the amplitude, more than half of it
    assert 0.5 < (force[200:] @ np.diff(path)[200:]) / (4 * 1.0 * 2e-3) < 1.0


@pytest.mark.parametrize("rate", [-0.3, 5e-4, 2e-3])
def test_steady_sliding_is_where_bristles_end(rate):
    rubs = StrokeFriction(force=1.0, viscous=0.4, presliding=1e-5, stribeck={"force": 1.5, "rate": 1e-3})
    np.testing.assert_allclose(rubs.numbers, [*PAPER[:6], 0.0])
    # A hundred times as far as bristles bend: they have forgotten where they began.
    end = solve_ivp(
        lambda t, z: [at(rate, z[0])[1]], (0, 2e-3 / abs(rate)), [0.0], method="LSODA", rtol=1e-11, atol=1e-17
    )
    assert at(rate, end.y[0, -1])[0] == pytest.approx(float(steady_friction(rubs, np.array(rate))), rel=1e-8)


def test_the_damper_of_bristles_is_itself_at_rest_and_lossless_at_its_limit():
    # At rest the force rises with the rate by F / p times the damping time. A damper without end, at bristles twice as
    # far as they slide, gives back what these lose: the largest damping that is passive (Barabanov & Ortega).
    force, reach, time = 3.0, 1e-3, 0.02
    numbers = (force, 0.0, reach, 0.0, 0.0, 0.0, time, 0.0)
    small, z = 1e-9, 2e-4
    slope = (at(small, z, numbers=numbers, falling=True)[0] - at(-small, z, numbers=numbers, falling=True)[0]) / 2e-9
    assert slope == pytest.approx(force / reach * time, rel=1e-5)
    for v, endless in ((0.05, 1e3), (2.0, 1e3), (2.0, 1e6)):
        F, rate = at(v, 2 * reach, numbers=(*numbers[:6], endless, 0.0), falling=True)
        lost = F * v - force / reach * 2 * reach * rate  # power less what is stored by the second
        assert lost == pytest.approx(4 * force * v / (1 + v * endless / (4 * reach)), rel=1e-6)  # 0 without end


@pytest.mark.parametrize("step", [1e-5, 1e-3, 1.0])
def test_steps_of_any_length_keep_bristles_within_what_they_bend_to(step):
    assert np.abs(walked(np.arange(0, 2000 * step, step), numbers=DAHL)).max() <= 1.0 + 1e-15
    # small steps along a straight path: the exact exponential, to the third order of a step over the presliding
    if step == 1e-5:
        exact = 1 - np.exp(-np.arange(1, 1999) * step / 1e-3)
        np.testing.assert_allclose(walked(np.arange(0, 1999 * step, step), numbers=DAHL), exact, atol=1e-6)


def test_it_is_passive_whatever_the_rates():
    # Bristles' damper with its fall, static friction twice that of sliding: the energy taken is never less than what
    # is stored. Steps are short beside the bristles' time, so that the sum of v F h is the integral.
    numbers = (1.0, 0.0, 1e-3, 1.0, 1 / 0.05, 0.0, 0.05, 0.0)
    step, h, rng = rubber(numbers, falling=True), 1e-4, np.random.default_rng(3)
    for scale in (0.01, 0.1, 1.0):
        tones = [(a, f) for a, f in zip(rng.normal(size=4), rng.uniform(1, 40, 4), strict=True)]
        v = scale * sum(a * np.sin(2 * np.pi * f * h * np.arange(4001)) for a, f in tones)
        z, taken = 0.0, 0.0
        for before, now in pairwise(v):
            force, z, _, stored = step(now, before, z, h)
            taken += float(force) * 0.5 * (now + before) * h
            assert taken >= float(stored) - 1e-3 * scale


def test_a_ball_has_the_same_friction_about_every_axis():
    numbers = (*DAHL[:7], 1.0)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    step, z = rubber(numbers, directions=3), np.array([2e-4, -3e-4, 1e-4])
    v, before = np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.4, -0.2])
    here, there = (step(R @ v, R @ before, R @ z, 1e-3) for R in (np.eye(3), turn))
    for ours, theirs in zip(here[:3], there[:3], strict=True):
        np.testing.assert_allclose(turn @ np.array(ours), theirs, atol=1e-12)
    force = np.array(step(v, v, 0 * z, 1.0)[0]).ravel()  # far: it slides
    np.testing.assert_allclose(np.linalg.norm(force), 1.0, atol=2e-6)


@cache
def run(step, fidelity="lumped", *, where="everywhere"):
    constant = EVERYWHERE | {"platform_joint": RUBS}
    parts = {"everywhere": EVERYWHERE, "whatever the load": constant, "nowhere": {"drive": SERVO}}[where]
    return run_robot(study(machine(**parts), fidelity=fidelity, step=step, output_step=1e-3))


def test_energy_balances_to_the_order_of_the_method():
    # Second order: a half of the step leaves a quarter, here within a tenth of the order.
    left = [np.ptp(balance(run(h))) for h in (1e-3, 5e-4)]
    assert np.log2(left[0] / left[1]) == pytest.approx(2.0, abs=0.1)
    assert left[0] < 2e-2 * run(1e-3)["sums"][-1, 0]
    # What is lost does not come back; bristles whose stiffness changes with the load are another matter (T19.8).
    assert (np.diff(run(5e-4, where="whatever the load")["sums"][:, 0]) > 0).all()


def test_the_path_is_of_second_order():
    poses = [run(h)["pose"] for h in (1e-3, 5e-4, 2.5e-4)]
    gaps = [np.abs(a - b).max() for a, b in pairwise(poses)]
    assert np.log2(gaps[0] / gaps[1]) == pytest.approx(2.0, abs=0.3)


def test_the_readable_twin_marches_alike(monkeypatch):
    robot = study(machine(**EVERYWHERE), fidelity="lumped", step=1e-3, duration=0.02)
    compiled = run_robot(robot)
    kernel.cache_clear()
    monkeypatch.setenv("FLEXAPOD_COMPILER", "none")
    twin = run_robot(robot)
    kernel.cache_clear()
    # Closures at 1e-13 m, rates and forces as in the contract of the twin: h / 2 and h^2 / 4, 1000 kg.
    np.testing.assert_allclose(twin["pose"], compiled["pose"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(twin["friction"], compiled["friction"], rtol=0, atol=1e-6)
    np.testing.assert_allclose(balance(twin), balance(compiled), rtol=0, atol=1e-6)


def test_next_to_no_friction_is_none():
    # Forces of 1e-9 N m and N; the closure of six rows counts rounding otherwise.
    little = Joint(friction=JointFriction(moment=1e-9))
    parts = {
        "base_joint": little,
        "platform_joint": little,
        "drive": SERVO.replace(friction=ScrewFriction(torque=1e-9)),
    }
    found = run_robot(study(machine(**parts), fidelity="lumped", step=1e-3, output_step=1e-3))
    np.testing.assert_allclose(found["pose"], run(1e-3, where="nowhere")["pose"], rtol=0, atol=1e-10)


def slow(**parts):
    """A heave of 20 mm in a second without weight, at the middle: leg coordinates there, and the whole run."""
    robot = machine(**parts).replace(gravity=[0, 0, 0])
    one = study(robot, duration=0.5, fidelity="assumed-modes", step=1e-3, output_step=1e-2)
    found = run_robot(one.replace(motion=one.motion.replace(duration=1.0)))
    return found["q"][-1], (found, robot)


def test_a_joint_that_rubs_bends_its_leg():
    # A pinned leg with the moment M at one end: M L^2 / (9 sqrt(3) E I), from the line of its ends.
    moment = 50.0
    thin = {"cylinder": BODY.replace(mouth=0.0, com=0.0), "piston": TUBE.replace(length=1.3)}
    rubs, _ = slow(base_joint=Joint(friction=JointFriction(moment=moment, presliding=1e-5)), **thin)
    free, _ = slow(**thin)
    bent, length = (
        (rubs - free)[0, 5:11].reshape(2, 3),
        free[0, 2],
    )  # behind two axial shapes: amplitudes of both planes
    along = np.linspace(0, 1, 401)
    across = bent @ lateral_basis("tip-load", 3).values(along)
    across -= along * across[:, -1:]
    # In heave one angle slides, the other has none. Inertia of what moves: the same in both runs.
    expected = moment * length**2 / (9 * np.sqrt(3) * TUBE.EI)
    assert np.abs(across).max() == pytest.approx(expected, rel=0.005)


@pytest.mark.parametrize("command", ["position", "servo"])
def test_a_screw_loses_what_its_friction_winds_up(command):
    torque = 5.0
    drive = SCREW if command == "position" else SERVO
    (rubs, (_, robot)), (free, _) = (
        slow(drive=drive.replace(friction=x)) for x in (ScrewFriction(torque=torque), None)
    )
    force = torque / SCREW.per_turn
    twist = next(x for x in springs_along(robot.legs[0]) if x.name == "twist")
    expected = force * twist.at_length(free[:, 2])
    if command == "servo":
        expected = expected + torque / 5e3 * SCREW.per_turn
    # the whole platform lags; its inertia is that of a second and 20 mm. The share is that at home, 3 % off at 10 mm.
    np.testing.assert_allclose(free[:, 2] - rubs[:, 2], expected, rtol=0.03)
    np.testing.assert_allclose(lost_motion(robot, free[:, 2]), expected, rtol=1e-12)


def test_a_screw_slides_at_the_torque_of_its_rate():
    # Stribeck's law by the screw's own rate: T_c + (T_s - T_c) exp(-(w / w_s)^2). Bristles follow within
    # presliding / w, 1 ms at 10 rad/s, in which the law changes by some 0.3 N m / 0.1 s of a second's motion: 3e-3 N m.
    torque, static, rate = 0.5, 0.8, 15.0
    rubs = ScrewFriction(torque=torque, stribeck={"moment": static, "rate": rate})
    one = study(
        machine(drive=SCREW.replace(friction=rubs)), duration=1.0, fidelity="rigid", step=1e-3, output_step=1e-3
    )
    found = fx.simulate(one.replace(motion=one.motion.replace(duration=1.0)))
    w = np.gradient(found.drive_position.values, 1e-3, axis=0)
    expected = np.sign(w) * (torque + (static - torque) * np.exp(-((w / rate) ** 2)))
    fast = np.abs(w) > 10
    assert np.ptp(np.abs(expected[fast])) > 0.1
    np.testing.assert_allclose(found.friction.sel(slide="drive").values[fast], expected[fast], atol=3e-3)


def test_friction_of_a_screw_by_its_travel():
    # A turn is a lead: forces are torques over lead / 2 pi, ways angles times it; times stay.
    turn = SCREW.lead / (2 * np.pi)
    rubs = ScrewFriction(
        torque=0.5, viscous=0.01, presliding=0.02, damping_time=3e-3, stribeck={"moment": 0.8, "rate": 15.0}
    )
    leg = machine(drive=SCREW.replace(friction=rubs)).legs[0]
    here = LegContext(length=1.0, per_loss=0.0, at_rest=False, robot=machine(), attitude=False, axes={})
    found = DriveFriction().numbers(leg, here)["drive_friction"]
    theirs = (0.5 / turn, 0.0, 0.02 * turn, 0.6, 1 / (15.0 * turn), 0.01 / turn**2, 3e-3, 0.0)
    np.testing.assert_allclose(found, theirs, rtol=1e-12)


def test_a_servo_lags_by_the_friction_of_its_stroke():
    servo = ServoDrive(stiffness=1e7, damping=1e4)
    rubs, _ = slow(drive=servo.replace(friction=StrokeFriction(force=100.0)))
    free, _ = slow(drive=servo)
    np.testing.assert_allclose(free[:, 2] - rubs[:, 2], 100.0 / 1e7, rtol=1e-2)


def locked(robot, **simulation):
    one = override(study(robot), **simulation)
    return locked_poses(robot, one.simulation, kinematics.home_pose(robot))


def test_lost_motion_is_what_a_slow_approach_shows():
    # Friction as it was at the middle of a slow motion, on the robot at rest there: it moves the platform by what the
    # two motions, with friction and without, differ. Their inertia is the same but for what friction changes.
    parts = {"base_joint": RUBS, "platform_joint": PLAIN, "drive": SERVO}
    (_, (rubs, robot)), (_, (free, _)) = (
        slow(**parts | {"drive": SERVO.replace(friction=ScrewFriction(torque=5.0))}),
        slow(drive=SERVO),
    )
    here = locked(robot)
    at = here.equilibria.states[here.at]
    force = -sliding_jacobian(here.system, at.q).swapaxes(-1, -2) @ rubs["friction"][-1][None, :, :, None]
    moved = displacement(here, force, np.zeros((1, 6, 1)))[0, :3, 0]
    np.testing.assert_allclose(rubs["pose"][-1, :3] - free["pose"][-1, :3], moved, atol=0.03 * np.abs(moved).max())


def test_the_reversal_error_is_a_bound_of_every_way_to_slide():
    robot = machine(**EVERYWHERE)
    here, found = locked(robot, fidelity="lumped"), reversal(locked(robot, fidelity="lumped"))
    at, rng = here.equilibria.states[here.at], np.random.default_rng(4)
    J, (_, limit) = sliding_jacobian(here.system, at.q), bristle_parameters(here.system, at.lam)
    tool, most = tool_motion(robot, at.pose)[0], np.zeros(6)
    for _ in range(300):  # crosses and screws to either side, balls about any axis
        way = np.sign(rng.normal(size=limit.shape))
        ball = rng.normal(size=(*limit.shape[:2], 3))
        way[..., 2:5] = ball / np.linalg.norm(ball, axis=-1, keepdims=True)
        force = J.swapaxes(-1, -2) @ (limit * way)[..., None]
        most = np.maximum(most, np.abs(tool @ displacement(here, force, np.zeros((1, 6, 1)))[0, :, 0]))
    bound = sum(x[0].sum(axis=0) for x in found.values())
    assert (most < bound).all()
    assert (most > 0.3 * bound).all()


def test_rows_of_the_budget():
    rubs = fx.budget(study(machine(**EVERYWHERE), fidelity="lumped"))
    table = rubs.budget.sel(kind="hysteretic").to_pandas().abs().sum(axis=1)
    assert set(table[table > 0].index) == {"base_joint friction", "platform_joint friction", "drive friction"}
    bound = rubs.budget_total.sel(kind="hysteretic").values
    np.testing.assert_allclose(rubs.repeatability_bidirectional.values, 2 * bound, rtol=1e-12)
    without = fx.budget(study(machine(**EVERYWHERE | {"platform_joint": Joint()}), fidelity="lumped"))
    row = rubs.budget.sel(kind="hysteretic", part="platform_joint friction").values
    np.testing.assert_allclose(without.budget_total.sel(kind="hysteretic").values, bound - row, rtol=1e-6, atol=1e-15)
    assert "friction of the drives" in [part_words(str(part)) for part in rubs.part.values]


def test_what_sticks_is_a_spring():
    spring, still = 2.0 / 1e-3, {"fidelity": "assumed-modes"}
    robots = (
        machine(base_joint=RUBS, platform_joint=PLAIN),
        machine(base_joint=Joint(bending=spring), platform_joint=PLAIN),
    )
    plain = locked(robots[0], **still).m.K
    stuck, springs = (
        locked(robot, friction=x, **still).m.K for robot, x in zip(robots, ("stuck", "sliding"), strict=True)
    )
    angles = np.zeros_like(plain)
    angles[..., 0, 0] = angles[..., 1, 1] = spring
    # Springs move the equilibrium, and with it what legs' weight adds: 1e-5 of the springs.
    np.testing.assert_allclose((springs - plain)[..., :2, :2], angles[..., :2, :2], atol=1e-4 * spring)
    np.testing.assert_allclose((stuck - plain)[..., :2, :2], angles[..., :2, :2], atol=1e-6)
    found = [fx.modes(robots[0], friction=x).frequency.values[0] for x in ("sliding", "stuck")]
    assert found[1] > found[0]


def test_what_sticks_damps_as_a_mass_on_its_bristles():
    """Legs alike on servos, rigid, without weight: each mode is one mass on k = k_s + F / z_0, c = c_s + t F / z_0."""
    servo, force, bends, time = ServoDrive(stiffness=2e7, damping=1e4), 60.0, 1e-5, 3e-3
    rubs = StrokeFriction(force=force, presliding=bends, damping_time=time)
    robot = machine(drive=servo.replace(friction=rubs), damping=0.0).replace(gravity=[0, 0, 0])
    stuck, slides = (fx.modes(robot, fidelity="rigid", friction=x) for x in ("stuck", "sliding"))
    k, c = 2e7 + force / bends, 1e4 + time * force / bends
    # Frequencies are those of the springs: sqrt(k / m); ratios c / (2 sqrt(k m)) = c omega / 2 k. Rounding of 1e8 N/m.
    np.testing.assert_allclose(stuck.frequency, slides.frequency * np.sqrt(k / 2e7), rtol=1e-8)
    np.testing.assert_allclose(stuck.damping_ratio, np.pi * stuck.frequency * c / k, rtol=1e-8)
    np.testing.assert_allclose(slides.damping_ratio, np.pi * slides.frequency * 1e4 / 2e7, rtol=1e-8)


def test_overdamped_modes_have_the_ratio_of_their_masses():
    # Legs alike, rigid, on springs and dampers alone: every mode is one mass with c / (2 sqrt(k m)) = c omega / 2 k,
    # above 1, where no eigenvalue oscillates.
    k, c = 2e7, 2e6
    robot = machine(drive=ServoDrive(stiffness=k, damping=c), damping=0.0).replace(gravity=[0, 0, 0])
    found = fx.modes(robot, fidelity="rigid")
    ratio = np.pi * found.frequency.values * c / k
    assert ratio.min() > 1.5
    np.testing.assert_allclose(found.damping_ratio, ratio, rtol=1e-8)


def test_causes_with_friction_add_up():
    found = fx.simulate(study(machine(**EVERYWHERE), fidelity="lumped", step=1e-3, output_step=1e-2))
    assert np.abs(found.deviation_residual).max() < 1e-4 * np.abs(found.com_deviation).max()
    # a screw at sliding friction lags by its lost motion
    lag = np.abs(found.deviation_by_cause.sel(cause="friction")).max(("time", "axis")).values
    assert (lag > 0.1 * lost_motion(machine(**EVERYWHERE), machine().home_lengths)).all()
    rubs = found.friction.sel(slide="drive").values
    assert np.abs(rubs).max() == pytest.approx(0.5, rel=1e-6)
    assert list(found.slide.values[:2]) == ["base_joint alpha", "base_joint beta"]


def test_legs_between_balls_rub_as_those_on_crosses():
    # In heave a leg turns about one axis; its idle turn about itself is held. The step differs in Newton's path alone.
    lost = []
    for name in ("6-SPS", "6-UPS"):
        robot = ROBOTS[name]()
        legs = (leg.replace(base_joint=RUBS, platform_joint=RUBS) for leg in robot.legs)
        found = run_robot(study(robot.replace(legs=tuple(legs)), fidelity="lumped", step=1e-3, duration=0.1))
        lost.append(found["sums"][-1, 0])
    assert lost[0] == pytest.approx(lost[1], rel=1e-4)


def test_a_ball_turns_as_its_axes_do():
    # Rates against the rotation between two instants: R(t + h) R(t)^T is the turn h v, in the axes before the joint.
    rng = np.random.default_rng(5)
    angles, rates, h = rng.normal(size=3), rng.normal(size=3), 1e-5
    symbols = [symbol("angles", 3), symbol("rates", 3), symbol("together")]
    rate = casadi.Function("turning", symbols, [joint_sliding_speed(*symbols)])

    def axes(by):
        return [exponential(x * unit) for x, unit in zip(angles + by * rates, np.eye(3), strict=True)]

    (a, b, c), (d, e, f) = axes(h), axes(-h)
    change = (a @ b @ c) @ (d @ e @ f).T
    expected = np.array([change[2, 1] - change[1, 2], change[0, 2] - change[2, 0], change[1, 0] - change[0, 1]]) / (
        4 * h
    )
    np.testing.assert_allclose(np.array(rate(angles, rates, 1.0)).ravel(), expected, atol=1e-8)
    np.testing.assert_allclose(np.array(rate(angles, rates, 0.0)).ravel(), rates, atol=0)


@pytest.mark.parametrize("together", [0.0, 1.0])
def test_forces_do_the_power_and_grow_with_the_rates(together):
    ours = dataclasses.replace(
        legs_of_all_kinds.shapes("pose with spin and twist"),
        elements=(Slot(BaseFriction), Slot(PlatformFriction), Slot(DriveFriction)),
    )
    force, matrix, _ = (Interpreted(x) for x in friction_functions(ours))
    rng, b = np.random.default_rng(6), ours.bristles
    p = np.zeros(sum(size for _, size in leg_parameters(ours)))
    for name, _ in ours.friction_parameters:
        p[columns(leg_parameters(ours), name)] = (2.0, 1e-3, 1e-3, 0.3, 2.0, 0.4, 1e-3, together)
    p[columns(leg_parameters(ours), "cylinder_spins")] = p[
        columns(leg_parameters(ours), "drive_friction_at_stroke")
    ] = 1.0
    q, v, lam = (rng.normal(size=n) for n in (ours.size, ours.size, ours.rows))
    state, h = np.concatenate([5e-4 * rng.normal(size=b), rng.normal(size=b)]), np.array([1e-3])
    r, _, _, _, energies = force(q, v, lam, state, h, p)
    assert r @ v == pytest.approx(energies[0], rel=1e-12)
    steps = 1e-6 * np.eye(ours.size)
    slopes = [(force(q, v + x, lam, state, h, p)[0] - force(q, v - x, lam, state, h, p)[0]) / 2e-6 for x in steps]
    np.testing.assert_allclose(matrix(q, v, lam, state, h, p)[0], np.array(slopes).T, atol=1e-6)
