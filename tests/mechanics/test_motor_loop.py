"""Motors that lag and loops closed elsewhere than at the rotor, beside two masses on a spring computed by hand."""

from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root
from tests.helpers.machines import EVERYTHING, NUT, SCREW, machine, study, symmetric
from tests.helpers.motor_loops import BOTH, GAINS, JOINTS, LAGS, ROTOR, STROKE, Hand, mixed, real, with_loop
from tests.helpers.runs import balance, run_robot

import flexapod as fx
from flexapod import kinematics, model
from flexapod.analysis.description.robot_description import describe
from flexapod.common.errors import InputError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.model import Encoder, Motor, Ripple
from flexapod.output.exchange.pose_deck import abaqus_deck
from flexapod.solve.linear.random_vibration import linear_robot
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.structural_damping import loss_frequency
from flexapod.solve.time import interpreted, native
from flexapod.solve.time.command_tables import robot_law
from flexapod.solve.time.recording import Counters
from flexapod.solve.time.robot_march import prepare
from flexapod.verification.engines.exudyn_robot import RobotProblem

pytestmark = pytest.mark.consistency


@pytest.mark.parametrize(("motor", "encoder", "integral"), [
    (LAGS, ROTOR, 0.0), (LAGS, STROKE, 0.0), (LAGS, BOTH, 0.0), (Motor(), STROKE, 0.0), (Motor(), BOTH, 0.0),
    (LAGS, BOTH, 100.0), (LAGS, ROTOR, 100.0),
])  # fmt: skip
def test_modes_are_those_of_two_masses(motor, encoder, integral):
    hand = Hand(with_loop(motor, encoder, integral=integral), gravity=[0, 0, 0])
    found = fx.modes(hand.robot, fidelity="rigid")
    omega, ratio = 2 * np.pi * found.frequency.values, found.damping_ratio.values
    theirs = np.linalg.eigvals(hand.matrix())
    theirs = theirs[theirs.imag > 1e-6 * np.abs(theirs)]
    assert theirs.size == 2
    for value in theirs:
        # Eigenvalues of either kind are right to rounding, times what their matrices are apart: 1e4.
        assert np.abs(omega * (-ratio + 1j * np.sqrt(1 - ratio**2)) - value).min() < 1e-10 * np.abs(value)
    # Others are of the payload's rotations and its motion aside.
    grows = bool((ratio < 0).any())
    assert grows or (theirs.real < 0).all()
    for words in ("unstable", 'encoder.rate = "rotor"'):
        assert (words in found.attrs["warnings"]) == grows


def test_loops_unstable_at_some_poses_alone_are_said_with_the_pose_or_the_instant():
    robot = Hand(with_loop(), gravity=[0, 0, 0]).robot
    rising = model.WaypointMotion(points=[model.Waypoint(time=0.0, heave=-0.1), model.Waypoint(time=0.02, heave=0.1)])
    given = study(robot, fidelity="rigid", duration=0.02).replace(motion=rising)
    heave = np.array([-0.1, 0.0, 0.1])
    mapped, many = fx.workspace_map(given, {"heave": heave}), fx.modes(given, {"heave": heave})
    poses = [fx.modes(given, {"heave": h}) for h in heave]
    rates = [(-2 * np.pi * one.frequency * one.damping_ratio).values.max() for one in poses]
    assert rates[0] < 0 < rates[1] < rates[2]
    np.testing.assert_allclose(mapped.loop_growth, np.maximum(rates, 0.0), rtol=1e-6)
    for data in (mapped, many):
        assert "unstable at 2 of 3 poses, most at heave 100 mm from home" in data.attrs["warnings"]
    for said in (fx.budget(given, motion=True), fx.run(given), fx.simulate(given)):
        assert said.attrs["warnings"].count("unstable") == 1
        assert "of 11 instants, most at t = 20 ms: deviations grow" in said.attrs["warnings"]
    for h, one in zip(heave, poses, strict=True):
        for data in (one, fx.budget(given, {"heave": h})):
            assert data.attrs["warnings"].count("unstable") == (h > -0.1)
    found = describe(given)
    assert [bool(pose.problem) for pose in found.poses] == [False, True]
    assert any("most at t = 20 ms" in line for line in found.remarks)
    assert "loop_growth" not in fx.workspace_map(Hand(with_loop(Motor(), ROTOR)).robot, {"heave": heave[1:2]})


def test_response_to_a_force_is_that_of_two_masses():
    hand = Hand(with_loop(stiffness=10.0), gravity=[0, 0, 0])
    given = study(hand.robot, fidelity="rigid")
    ours = linear_robot(locked_poses(given.robot, given.simulation, kinematics.home_pose(given.robot)))
    f = np.array([0.3, 10.0, 50.0, 200.0])
    answer = ours.tool[2] @ ours.amplitudes(f, ours.inputs["wrench"][:, 2:3])[..., 0].T
    force = np.eye(6)[2] / hand.M
    theirs = [np.linalg.solve(2j * np.pi * x * np.eye(6) - hand.matrix(), force)[0] for x in f]
    np.testing.assert_allclose(answer, theirs, rtol=1e-9)


def lifted(hand, t):
    """Commanded length and its rate: 20 mm up in 0.1 s, quintic."""
    s = np.clip(t / 0.1, 0, 1)
    z = hand.z0 + 0.02 * (10 * s**3 - 15 * s**4 + 6 * s**5)
    return hand.length(z), 0.02 * (30 * s**2 - 60 * s**3 + 30 * s**4) / 0.1 * hand.slope(z)


def path(hand, torque, end=0.15):
    """The same path by SciPy, off the rigid one."""

    def rest(x):
        z, r = x
        push = hand.ks * (r - hand.length(z))
        asked, _ = hand.asked(z, 0.0, r, 0.0, 0.0, hand.length(hand.z0))
        return [6 * hand.slope(z) * push / hand.M - 9.81, (asked + torque - push) / hand.m]

    z, r = root(rest, [hand.z0, hand.length(hand.z0)], tol=1e-14).x
    x = [z, r, 0.0, 0.0, hand.ks * (r - hand.length(z)), 0.0]
    solve = partial(solve_ivp, method="Radau", rtol=1e-10, atol=1e-13, dense_output=True)
    return solve(lambda t, y: hand.rates(y, *lifted(hand, t), torque, 9.81), (0, end), x, max_step=1e-3)


@pytest.mark.parametrize(("drive", "torque", "of_steps"), [
    (with_loop(LAGS, ROTOR), 0.0, 1e-3), (with_loop(LAGS, BOTH), 0.0, 1e-3),
    (with_loop(Motor(), STROKE), 0.0, 2e-2),  # unstable: it grows 5000 times
    (with_loop(LAGS, BOTH).replace(command="torque", law="constant", value=0.5), 0.5 / SCREW.per_turn, 1e-3),
])  # fmt: skip
def test_path_of_two_masses(drive, torque, of_steps):
    hand = Hand(drive)
    theirs = path(hand, torque)
    for settings, error in (({"tolerance": 1e-5}, 1e-5), ({"step": 1.25e-4}, of_steps)):
        data = fx.simulate(study(hand.robot, fidelity="rigid", duration=0.15, output_step=1e-3, **settings))
        rigid_path = data.com_position_rigid.values[:, 2]
        beside = theirs.sol(data.time.values)[0] - hand.z0 - (rigid_path - rigid_path[0])
        lag = data.com_deviation.values[:, 2]
        assert np.abs(lag).max() > 1e-3
        assert ("unstable" in data.attrs["warnings"]) == (drive.encoder is not ROTOR)  # of payloads that tilt, at least
        # What is promised, of the largest; of a fixed step (2 pi 50 Hz h)^2 / 12 of a radian after 50 of them.
        np.testing.assert_allclose(lag, beside, rtol=0, atol=error * np.abs(beside).max())


def test_the_steps_of_loops_about_the_stroke_need_no_more_iterations():
    # The matrices have what is not symmetric in them, so that Newton's method converges as about the rotor.
    counts = []
    for encoder in (ROTOR, BOTH):
        drive = with_loop(Motor(), encoder, stiffness=5e3, damping=200.0)
        data = fx.simulate(study(Hand(drive).robot, fidelity="rigid", duration=0.02, step=2e-4))
        counts.append(data.attrs["newton_iterations"] / data.attrs["steps"])
    assert counts[1] < 1.15 * counts[0] and counts[1] < 5


def test_a_motor_of_endless_bandwidth_is_one_without_lag():
    runs = [run_robot(study(Hand(with_loop(motor, encoder)).robot, fidelity="rigid", step=5e-4, duration=0.05))
            for encoder in (ROTOR, BOTH) for motor in (Motor(), Motor(bandwidth=1e9))]  # fmt: skip
    # A lag of 0.16 ns beside rates of 0.3 m/s.
    for k in (0, 2):
        np.testing.assert_allclose(runs[k]["pose"], runs[k + 1]["pose"], rtol=0, atol=1e-9)
    frequency = [fx.modes(Hand(with_loop(motor, BOTH)).robot, fidelity="rigid").frequency.values
                 for motor in (Motor(), Motor(bandwidth=1e9))]  # fmt: skip
    np.testing.assert_allclose(frequency[0], frequency[1][: frequency[0].size], rtol=1e-6)


def test_energy_closes_to_second_order():
    errors = []
    for step in (5e-4, 2.5e-4):
        found = balance(run_robot(study(Hand(with_loop()).robot, fidelity="rigid", step=step, duration=0.1)))
        errors.append(np.abs(found - found[0]).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.25)


ALL = {"axial-strain", "base_joint", "platform_joint", "screw", "twist", "nut", "bearing", "bracket"}
INSIDE = {"stroke": ALL - {"axial-strain", "base_joint", "platform_joint"}, "joint-to-joint": ALL}


class TestAtRest:
    @pytest.mark.parametrize("encoder", [BOTH, JOINTS])
    def test_a_sum_of_the_error_holds_what_is_measured(self, encoder):
        loop, held = real(encoder), machine(drive=SCREW.replace(encoder=Encoder(at=encoder.at)), **EVERYTHING)
        ours, theirs = (fx.modes(x, fidelity="lumped").com_sag.values for x in (loop, held))
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13)
        left = {str(part) for part in fx.budget(study(loop, fidelity="lumped")).part.values}
        assert left - {"bending"} == ALL - INSIDE[encoder.at]
        if encoder is JOINTS:
            assert np.isinf(fx.parts(held).leg_stiffness).all()
            with pytest.raises(InputError, match="infinitely stiff"):
                fx.stiffness(loop, fidelity="lumped")
            run = fx.simulate(study(loop, fidelity="lumped", step=1e-3, duration=0.002))
            np.testing.assert_allclose(run.leg_length[0], run.leg_length_command[0], rtol=0, atol=1e-12)
            return
        parts = fx.parts(held)
        assert {str(name) for name in parts.part[np.isinf(parts.part_stiffness[0])].values} == INSIDE["stroke"]
        # Six such springs along the legs; as they turn, a ton on 5e7 N/m adds its thrust over their length: 1e-3.
        lift = float(fx.stiffness(held, fidelity="lumped").stiffness[2, 2])
        slope = (held.home_position[2] + held.platform_joints[:, 2] - held.base_joints[:, 2]) / held.home_lengths
        assert lift == pytest.approx(float((parts.leg_stiffness.values * slope**2).sum()), rel=2e-3)
        stiff = [fx.stiffness(x, fidelity="lumped").stiffness.values for x in (loop, held)]
        np.testing.assert_allclose(stiff[0], stiff[1], rtol=1e-12, atol=1e-12 * np.abs(stiff[1]).max())

    def test_sag_is_that_of_run_modes_and_stiffness(self):
        robot = mixed()
        sag = fx.modes(robot, fidelity="lumped").com_sag.values
        given = study(robot, fidelity="lumped", step=1e-3, duration=0.02)
        run = fx.simulate(given.replace(motion=given.motion.replace(amplitude=0.0)))
        # Springs of a screw depend on its length, by 1 / 0.4 m a metre: half of that times 2e-5 m of their force.
        np.testing.assert_allclose(run.com_deviation.values[0], sag, rtol=0, atol=1e-4 * np.abs(sag).max())
        # It stays: forces have been summed, and lag behind nothing.
        np.testing.assert_allclose(run.com_deviation.values[-1], run.com_deviation.values[0], rtol=0, atol=1e-11)
        lifted = model.Load(wrench=model.ConstantWrench(value=[0, 0, 1.0, 0, 0, 0]))
        more = fx.modes(given.replace(load=lifted)).com_sag.values[2] - sag[2]
        give = np.linalg.inv(fx.stiffness(robot, fidelity="lumped").stiffness.values)[2, 2]
        assert more == pytest.approx(give, rel=1e-4)

    def test_what_is_measured_gives_way_by_the_force_over_the_gain(self):
        rest = fx.simulate(study(mixed(), fidelity="lumped", step=1e-3, duration=0.002)).isel(time=0)
        short = (rest.leg_length_command - rest.leg_length).values
        give = rest.drive_force.values / GAINS.stiffness * SCREW.per_turn
        assert short[2] == pytest.approx(give[2], rel=1e-9)
        causes = rest.deviation_by_cause
        for leg, at in ((0, "stroke"), (2, "joint-to-joint"), (3, "stroke")):
            for name in INSIDE[at]:
                assert np.abs(causes.sel(cause=name).isel(leg=leg)).max() < 1e-15
        total = causes.sum(["cause", "leg"]) + rest.deviation_residual
        np.testing.assert_allclose(total, rest.com_deviation, rtol=0, atol=1e-15)


def test_ripple_does_not_hide_that_a_motor_lags():
    rippling = LAGS.replace(ripple=Ripple(torque=0.01, per_turn=24))
    lagging, both = (fx.modes(symmetric(drive=with_loop(motor, ROTOR))) for motor in (LAGS, rippling))
    np.testing.assert_array_equal(both.frequency, lagging.frequency)
    np.testing.assert_array_equal(both.damping_ratio, lagging.damping_ratio)


def test_loss_factors_are_made_viscous_with_the_loop_about_the_rotor():
    lossy = SCREW.replace(nut=NUT.replace(loss=0.01), loop=GAINS.replace(integral=0.0), command="servo")
    elsewhere = {"encoder": BOTH, "motor": LAGS}
    drives = (
        lossy,
        lossy.replace(**elsewhere),
        lossy.replace(command="torque", **elsewhere),
        lossy.replace(command="torque", encoder=Encoder(rate="rotor")),
    )
    found = [loss_frequency(machine(drive=drive), model.Simulation(fidelity="lumped")) for drive in drives]
    assert found[3] == found[2] > found[1] == found[0] > 10  # a torque is locked


@pytest.mark.parametrize(("drive", "key"), [(with_loop(), "bandwidth"), (with_loop(Motor()), "encoder.at")])
def test_decks_and_engines_refuse_them(drive, key):
    with pytest.raises(InputError, match=f"{key}.*decks"):
        abaqus_deck(machine(drive=drive))
    with pytest.raises(InputError, match="Exudyn"):
        RobotProblem(robot=machine(drive=drive), motion=None, integration=None, elements=0, guide=0.0)


class TestFiles:
    TEXT = model.preset_text("machine-hexapod")
    OLD = 'command = "position"         # ours'

    def loaded(self, text):
        return model.loads(self.TEXT.replace(self.OLD, f"{text} # ours"))

    def test_round_trip(self):
        given = self.loaded(
            'command = "servo"\nloop = { stiffness = "500 N m/rad", damping = "6 N m s/rad" }\n'
            'motor = { bandwidth = "0.3 kHz" }\nencoder = { at = "stroke", rate = "rotor", resolution = "0.1 um" }'
        )
        drive = given.robot.legs[0].screw
        assert drive.motor.bandwidth == 300.0 and drive.encoder.rate == "rotor"
        assert drive.lag == pytest.approx(1 / (2 * np.pi * 300))
        assert model.loads(model.to_toml(given)).robot == given.robot


def test_elimination_without_symmetry_equals_the_dense_system():
    given = study(mixed(), fidelity="lumped", step=1e-3, duration=0.02)
    prepared = prepare(given)
    law = robot_law(
        prepared.system, given.robot, given.load, partial(kinematics.rigid_poses, given.robot, given.motion)
    )
    tables, method = law(np.arange(9) * 1e-3), GeneralizedAlpha(given.simulation.rho_inf)
    flow, _ = native.first_record(prepared.system, prepared.start, *tables)
    ours, theirs = (
        solver.advance(prepared.system, method, flow, 1e-3, tables, 8, Counters()) for solver in (native, interpreted)
    )
    assert ours.status == theirs.status == 0
    # Both stop where residuals are 1e-10 of the largest force, 1e4 N beside springs of 1e8 N/m.
    np.testing.assert_allclose(ours.flow.pose, theirs.flow.pose, rtol=0, atol=1e-12)
    np.testing.assert_allclose(ours.flow.sums, theirs.flow.sums, rtol=1e-9, atol=1e-9)
