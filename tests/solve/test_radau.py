"""Radau's method within a tolerance: the tolerance is kept, and not by far; orders, drift, jumps, stiff limits."""

from functools import cache

import numpy as np
import pytest
from tests.helpers.machines import SCREW, machine
from tests.helpers.machines import study as moved_machine
from tests.helpers.runs import balance, paper_robot, run_actuator, run_robot, with_legs

import flexapod as fx
from flexapod import kinematics
from flexapod.kinematics.rotations import matrix
from flexapod.model import Feedback, Joint, JointFriction, ScrewFriction, override, preset
from flexapod.model.study.mount import BaseMotion, Mount
from flexapod.solve.time import radau
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.convergence

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


def moved(**motion):
    study = paper_robot(duration=2 * motion["duration"])
    return study.replace(motion=study.motion.replace(hold=motion["duration"], **motion))


def thin():
    """The roll on pistons of 10 in place of 27 mm, which buckle at 9 mm."""
    ratio = 10 / 27
    size = {"EA": ratio**2, "rhoA": ratio**2, "EI": ratio**4}
    return with_legs(
        paper_robot(duration=1.5),
        lambda leg: leg.replace(piston=leg.piston.replace(**{k: f * getattr(leg.piston, k) for k, f in size.items()})),
    )


STUDIES = {
    "roll": (lambda: paper_robot(duration=1.5), 2.5e-5),
    "fast move": (lambda: moved(amplitude=np.radians(5.0), duration=0.1), 5e-6),
    "near buckling": (thin, 2.5e-5),
    "machine": (lambda: override(preset("machine-hexapod"), duration=0.8), 2e-5),
}


def deviation(study, run):
    """Deviation of the payload (T, 6) [m]: of its centre of mass, and of its turning at the joints' radius."""
    path = kinematics.poses(study.robot, study.motion, run["time"])
    turn = path.rotation.swapaxes(1, 2) @ matrix(run["pose"][:, 3:])
    skew = np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], 1)
    radius = np.linalg.norm(study.robot.platform_joints, axis=1).max()
    centre = path.position + path.rotation @ study.robot.payload.com
    return np.concatenate([run["pose"][:, :3] - centre, 0.5 * radius * skew], axis=1)


def lateral(study, run):
    first = prepare(study).system.kernel.shapes.index("a")
    return run["q"][:, :, first:]


@cache
def reference(name):
    """Deviation and lateral amplitudes of a study: generalized-alpha with a step and its half, extrapolated."""
    make, step = STUDIES[name]
    study = make()
    coarse, fine = (run_robot(override(study, step=step / k, output_step=1e-3)) for k in (1, 2))
    pairs = [(f(study, coarse), f(study, fine)) for f in (deviation, lateral)]
    return study, [b + (b - a) / 3 for a, b in pairs]


def errors(name, tolerance):
    """Of the deviation and of the lateral amplitudes, over their peaks, and the number of steps."""
    study, true = reference(name)
    march = prepare(override(study, tolerance=tolerance))
    parts = [chunk.recording for chunk in march.chunks]
    run = {key: np.concatenate([getattr(r, key) for r in parts]) for key in ("time", "pose", "q")}
    found = [deviation(study, run), lateral(study, run)]
    return [np.abs(x - y).max() / np.abs(y).max() for x, y in zip(found, true, strict=True)] + [march.counters.steps]


@pytest.mark.parametrize("name", STUDIES)
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_the_error_is_what_the_tolerance_says(name, tolerance):
    """At most the tolerance, and not below a fiftieth of it; of the lateral amplitudes ten times as much."""
    of_deviation, of_lateral, steps = errors(name, tolerance)
    assert tolerance / 50 < of_deviation < tolerance
    assert of_lateral < 10 * tolerance
    assert steps < 20_000  # doubled chunks of second order took 127,000 for the roll at 1e-4


def rubbing(moment=2.0, torque=0.5, **waypoints):
    """Six cylinders with servo drives, which rub at their joints and screws; bristles bend by 1e-5."""
    joint = Joint(friction=JointFriction(moment=moment, presliding=1e-5))
    drive = SCREW.replace(
        command="servo", loop=Feedback(stiffness=5e3, damping=20.0), friction=ScrewFriction(torque=torque)
    )
    study = moved_machine(machine(base_joint=joint, drive=drive), fidelity="lumped", output_step=1e-3)
    return study.replace(motion={"type": "waypoints", **waypoints}) if waypoints else study


def test_reversals_with_friction():
    """To, fro and to rest: bristles turn over within a thousandth of the way."""
    points = [{"time": 0.1, "heave": 0.01}, {"time": 0.2, "heave": -5e-3}]
    study = rubbing(points=points)
    runs = [run_robot(override(study, step=h, output_step=1e-3)) for h in (2e-5, 1e-5)]
    coarse, fine = (deviation(study, run) for run in runs)
    true = fine + (fine - coarse) / 3
    for tolerance in (1e-2, 1e-3, 1e-4):
        run = run_robot(override(study, tolerance=tolerance))
        assert tolerance / 50 < np.abs(deviation(study, run) - true).max() / np.abs(true).max() < tolerance
        # Nearly all work ends as friction: it and the balance are right as far as the path is.
        assert run["sums"][-1, 0] == pytest.approx(runs[1]["sums"][-1, 0], rel=tolerance)
        assert np.ptp(balance(run)) < tolerance * np.ptp(run["sums"][:, 1])
        # Moments jump at a reversal, within steps: a hundredth of them is what fixed steps of 20 us leave there.
        assert np.abs(run["friction"] - runs[1]["friction"]).max() < 1e-2 * np.abs(runs[1]["friction"]).max()


def mounted(**more):
    """Six cylinders between plates on springs."""
    K = np.diag([3e8, 2e8, 5e8, 3e7, 2e7, 4e7])
    base = Mount(at=[0.05, -0.02, -0.1], stiffness=K, mass=150.0, inertia=np.diag([6.0, 7.0, 10.0]))
    top = Mount(at=[0.01, 0.03, 0.04], stiffness=0.6 * K, mass=30.0, inertia=np.diag([1.0, 1.5, 2.0]))
    return moved_machine(machine().replace(base_mount=base, platform_mount=top, **more), fidelity="lumped")


def shaken():
    """A floor whose acceleration is random every 10 ms, and jumps at 50.3 ms."""
    values, time = np.zeros((23, 6)), np.sort(np.concatenate([np.linspace(0, 0.2, 21), [0.0503, 0.0503]]))
    values[:, [0, 2, 4]] = np.random.default_rng(0).normal(size=(23, 3)) * [2.0, 3.0, 1.0]
    return BaseMotion(of="acceleration", time=time, values=values, at=[0.1, 0.0, -0.2])


@pytest.mark.parametrize("base_motion", [None, shaken()], ids=["still", "shaken"])
def test_plates_on_mounts(base_motion):
    """Coordinates that legs share, and those that move the base; the deviation is seen from there."""
    study = mounted(base_motion=base_motion)
    coarse, fine = (fx.run(override(study, step=h, output_step=1e-3)).com_deviation for h in (2e-5, 1e-5))
    true = fine + (fine - coarse) / 3
    for tolerance in (1e-2, 1e-4, 1e-6):
        found = fx.run(override(study, tolerance=tolerance, output_step=1e-3)).com_deviation
        error = float(np.abs(found - true).max() / np.abs(true).max())
        assert tolerance / 50 < error < tolerance
        if tolerance > 1e-5:  # below, the error is in part the reference's
            *_, last = prepare(override(study, tolerance=tolerance, output_step=1e-3)).chunks
            assert error < last.error < 5 * error  # the estimate: plates' rows are summed over the legs
    run = run_robot(override(study, tolerance=1e-6, output_step=1e-3))
    assert run["closure"].max() < 1e-12
    assert np.ptp(balance(run)) < 1e-4 * np.ptp(run["sums"][:, 1])


def test_next_to_no_friction_is_none():
    """Forces of 1e-9 N m and N: steps are the same, and so is the path but for rounding."""
    little = rubbing(moment=1e-9, torque=1e-9)
    none = rubbing()
    legs = (leg.replace(base_joint=Joint(), drive=leg.drive.replace(friction=None)) for leg in none.robot.legs)
    none = none.replace(robot=none.robot.replace(legs=tuple(legs)))
    found, true = (run_robot(override(x, tolerance=1e-4))["pose"] for x in (little, none))
    np.testing.assert_allclose(found, true, rtol=0, atol=1e-10)


def test_errors_fall_with_more_than_the_fourth_power_of_the_step(monkeypatch):
    """Five for what steps resolve; axial vibrations of kilohertz, which they do not, take half an order from it."""
    study, found = moved(amplitude=np.radians(5.0), duration=0.1), []
    true = deviation(study, run_robot(override(study, tolerance=1e-9)))
    for tolerance, longest in ((1e-3, 1e-3), (1e-7, 2e-4)):  # tolerances that ask for longer steps
        monkeypatch.setattr(radau, "LONGEST", longest)
        found.append(np.abs(deviation(study, run_robot(override(study, tolerance=tolerance))) - true).max())
    assert np.log(found[0] / found[1]) / np.log(5) > 4.0


def test_a_vibration_without_damping_keeps_its_phase():
    """Twelve periods of a beam that grows; the frequency falls to a third."""
    study = preset("paper-actuator")
    study = override(study, duration=10.0, output_step=5e-3)
    coarse, fine = (run_actuator(override(study, step=h))["q"][:, 0, 2:] for h in (5e-5, 2.5e-5))
    true = fine + (fine - coarse) / 3
    for tolerance in (1e-2, 1e-3, 1e-4):
        found = run_actuator(override(study, tolerance=tolerance))["q"][:, 0, 2:]
        assert tolerance / 50 < np.abs(found - true).max() / np.abs(true).max() < tolerance


def test_closures_and_balance_do_not_drift(monkeypatch):
    """Over 1e5 steps; a step between outputs, where records are put back onto the closures, included."""
    monkeypatch.setattr(radau, "LONGEST", 9e-6)
    march = prepare(paper_robot(duration=1.0, tolerance=1e-4, output_step=7e-4, modes=1))
    parts = [chunk.recording for chunk in march.chunks]
    run = {key: np.concatenate([getattr(r, key) for r in parts]) for key in ("closure", "energy", "sums")}
    assert march.counters.steps > 1e5
    assert run["closure"].max() < 1e-12
    kept = balance(run)
    assert np.ptp(kept) < 1e-7 * np.ptp(run["sums"][:, 1])


def test_rates_of_records_close_the_legs():
    march = prepare(paper_robot(duration=0.3, tolerance=1e-2))
    last = [chunk.recording for chunk in march.chunks][-1]
    system, at = march.system, len(last.time) // 2
    state = march.start.__class__(
        q=last.q[at], pose=last.pose[at], v=last.v[at], v_dot=last.v_dot[at], lam=last.lam[at],
        drive=last.drive[at], a=last.v_dot[at],
    )  # fmt: skip
    # In one correction with matrices that are up to 16 steps old, of rates that are wrong by 1e-6.
    assert np.abs(system.matrices(state, np.zeros(6)).G @ state.v).max() < 1e-8


def test_work_of_the_drives_is_the_energy(monkeypatch):
    """The balance closes as far as the tolerance goes."""
    for tolerance in (1e-3, 1e-5):
        run = run_robot(paper_robot(duration=0.6, tolerance=tolerance))
        assert np.ptp(balance(run)) < tolerance * np.ptp(run["sums"][:, 1])


@pytest.mark.parametrize("profile", ["trapezoid", "linear"])
def test_steps_end_on_jumps(profile):
    """The command's acceleration or rate jumps between two outputs."""
    study = paper_robot(profile=profile, start="moving", fidelity="lumped", duration=0.3)
    study = study.replace(motion=study.motion.replace(duration=0.2003, amplitude=np.radians(2.0)))
    true = deviation(study, run_robot(override(study, step=5e-6, output_step=1e-3)))
    found = deviation(study, run_robot(override(study, tolerance=1e-4)))
    assert np.abs(found - true).max() < 1e-4 * np.abs(true).max()


def test_a_platform_that_tumbles():
    """Turning about three axes at once, by 20 degrees each in 0.3 s."""
    study = paper_robot(duration=0.4, modes=1)
    amplitudes = {"roll": 0.3, "pitch": 0.3, "yaw": 0.3}
    study = study.replace(motion={"type": "combined", "amplitudes": amplitudes, "duration": 0.3, "hold": 0.1})
    coarse, fine = (deviation(study, run_robot(override(study, step=h, output_step=1e-3))) for h in (2e-5, 1e-5))
    true = fine + (fine - coarse) / 3
    for tolerance in (1e-3, 1e-5):
        found = deviation(study, run_robot(override(study, tolerance=tolerance)))
        assert np.abs(found - true).max() < tolerance * np.abs(true).max()


def test_stiff_pistons_do_not_shorten_the_steps(monkeypatch):
    """Pistons ten thousand times as stiff along their axis vibrate at 350 kHz: steps pass over that."""
    monkeypatch.setattr(radau, "LONGEST", 1e-3)
    runs = []
    for factor in (1e3, 1e4):
        stiff = with_legs(
            paper_robot(duration=0.2, tolerance=0.3),
            lambda leg, k=factor: leg.replace(piston=leg.piston.replace(EA=k * leg.piston.EA)),
        )
        march = prepare(stiff)
        runs.append(np.concatenate([chunk.recording.drive for chunk in march.chunks]))
        assert march.counters.steps < 300
    # What the first ones stretch, 2e-8 m, moves forces by less than 1e-4 of them.
    assert np.abs(runs[1] - runs[0]).max() < 1e-3 * np.abs(runs[0]).max()
