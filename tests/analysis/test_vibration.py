"""Random vibration of whole robots: at rest, over time, by symmetry, and what has no answer, Eqs. (T18.1)-(T18.11)."""

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov
from tests.helpers.machine_hexapod import TILTED, lumped, on_servos
from tests.helpers.machines import machine
from tests.helpers.machines import study as heaved

import flexapod as fx
from flexapod import kinematics, model
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.error_budget.text import part_words
from flexapod.analysis.pose_errors.disturbances import home_shaking, vibration_rows
from flexapod.analysis.pose_errors.sensitivity import sensitivity
from flexapod.analysis.results.arguments import as_pose
from flexapod.kinematics.rotations import difference, matrix, quaternion
from flexapod.model.study.mount import BaseMotion, Mount
from flexapod.output.text.description import vibration_words
from flexapod.solve.linear.random_vibration import FAR, LinearRobot, Source, linear_robot, panels, random_vibration
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.eigenproblem import poles
from flexapod.solve.statics.locked_robot import LockedPoses

pytestmark = pytest.mark.consistency

WHITE = np.array([1e-3, 1e5])


def locked(study: model.Study, pose: dict | None = None) -> LockedPoses:
    path = kinematics.home_pose(study.robot) if pose is None else as_pose(study.robot, pose)
    return locked_poses(study.robot, study.simulation, path, study.load)


def linear(study: model.Study, pose: dict | None = None) -> LinearRobot:
    return linear_robot(locked(study, pose))


@pytest.fixture(scope="module")
def study() -> model.Study:
    return lumped()


@pytest.fixture(scope="module")
def shaken() -> model.Study:
    table = model.Spectrum(frequency=np.array([1.0, 500.0]), density=np.full((2, 1), 4.0))
    wrench = model.Spectrum(frequency=np.array([1.0, 500.0]), density=np.tile([1.0, 2.0, 3.0, 0.1, 0.2, 0.3], (2, 1)))
    given = model.Disturbance(floor=model.Floor.by_curve("VC-A"), wrench=wrench, force_noise=table)
    return lumped(disturbance=given)


def tool_at_rest(study: model.Study, gravity: np.ndarray, path: kinematics.Poses) -> tuple[np.ndarray, np.ndarray]:
    robot = study.robot.replace(gravity=gravity)
    pose = locked_poses(robot, study.simulation, path, study.load).equilibria.states.pose[0]
    R = matrix(pose[None, 3:])[0]
    return pose[:3] + R @ (robot.tool - robot.com), R


@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
def test_a_slow_acceleration_of_the_base_is_gravity_changed(fidelity):
    # The base accelerates by a: static equilibrium under g - a. Central differences of 1e-2 m/s^2: the rest is of the
    # third order in it (below 1e-6) and rounding of poses, 1e-13 over some 1e-8 m.
    study = model.override(fx.preset("machine-hexapod"), fidelity=fidelity)
    path = as_pose(study.robot, TILTED)
    robot = linear(study, TILTED)
    slow = (robot.tool @ robot.amplitudes(np.array([1e-4]), robot.inputs["floor"])[0]).real
    step = 1e-2
    for k, axis in enumerate(np.eye(3)):
        shaken = [tool_at_rest(study, study.robot.gravity - x * axis, path) for x in (step, -step)]
        (ahead, turned), (back, before) = shaken
        turn = difference(quaternion(turned[None]), quaternion(before[None]))[0]
        expected = np.concatenate([ahead - back, turn]) / (2 * step)
        assert slow[:, k] == pytest.approx(expected, rel=1e-4, abs=1e-4 * np.abs(expected).max())


def test_a_static_wrench_meets_the_stiffness_at_the_tool(study):
    robot = linear(study, TILTED)
    slow = (robot.tool @ robot.amplitudes(np.array([1e-5]), robot.inputs["wrench"])[0]).real
    stiffness = fx.stiffness(study, TILTED).stiffness.values
    assert slow @ stiffness == pytest.approx(np.eye(6), abs=1e-7)


def test_a_force_of_a_drive_works_against_its_servo(study):
    # the drives' forces reach the tool as displacements of their commands times the servo's stiffness do
    robot = linear(study, TILTED)
    slow = (robot.tool @ robot.amplitudes(np.array([1e-5]), robot.inputs["drive"])[0]).real
    path = as_pose(study.robot, TILTED)
    commanded = (
        sensitivity(kinematics.RigidPoses(study.robot, path)).coordinate[0, :, kinematics.COORDINATES.index("l")].T
    )
    assert 60e6 * slow == pytest.approx(commanded, rel=2e-2, abs=2e-3 * np.abs(commanded).max())  # sag turns the legs


def variance(robot: LinearRobot, forces: np.ndarray, level: float) -> np.ndarray:
    """Rms of the tool under white forces of one-sided density by the Lyapunov equation."""
    n, M = robot.omega.size, np.diag(robot.omega**-2)
    inverse = np.linalg.inv(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse, -inverse @ robot.damping]])
    B = np.vstack([np.zeros_like(forces), inverse @ forces])
    P = solve_continuous_lyapunov(A, -B @ B.T * level / 2)  # two-sided in rad/s: half of it
    return np.sqrt(np.diag(robot.tool @ P[:n, :n] @ robot.tool.T))


def test_the_spectrum_holds_the_variance_over_time(study):
    # Parseval: the integral over frequency is the variance by the Lyapunov equation; outside of 1e-3 .. 1e5 Hz less
    # than 1e-4 of it. Balanced: modes up to some kHz
    robot = linear(study, TILTED)
    for name in ("floor", "wrench", "drive"):
        forces = robot.inputs[name]
        k = forces.shape[1]
        source = Source(name=name, forces=forces, frequency=WHITE, density=np.full((2, k), 2.5))
        found = random_vibration(robot, [source])
        assert found.cumulative[0] == pytest.approx(found.rms, rel=1e-12)
        assert found.rms == pytest.approx(variance(robot, forces, 2.5), rel=1e-4)


def test_what_sources_modes_and_legs_add_up_to(shaken):
    data = fx.vibration(shaken, TILTED)
    rms = data.vibration_rms.values
    assert list(data.source.values) == ["floor vibration", "wrench noise", "force noise"]
    assert np.sqrt((data.vibration_by_source.values**2).sum(axis=0)) == pytest.approx(rms)
    assert data.vibration_by_mode.sum("mode").values == pytest.approx(rms)
    assert np.diag(data.vibration_covariance) == pytest.approx(rms**2)
    assert data.vibration_cumulative.values[0] == pytest.approx(rms)
    assert (np.diff(data.vibration_cumulative.values, axis=0) <= 0).all()
    assert data.attrs["estimated_error"] < 1e-5
    assert data.frequency.values == pytest.approx(fx.modes(shaken, TILTED).frequency.values)
    rows = vibration_rows(shaken, locked(shaken, TILTED))
    assert [row.by_leg.shape for row in rows] == [(1, 6), (1, 6), (6, 6)]
    assert sum((row.by_leg**2).sum(axis=0) for row in rows) == pytest.approx(rms**2, rel=1e-5)


def test_the_budget_has_rows_of_them(shaken):
    data, alone = fx.budget(shaken, TILTED), fx.vibration(shaken, TILTED)
    for source in ("floor vibration", "wrench noise", "force noise"):
        found = data.budget.sel(part=source, kind="random").values
        assert found == pytest.approx(alone.vibration_by_source.sel(source=source).values, rel=1e-5)
        assert part_words(source) == source
    assert data.budget_total.sel(kind="random").values == pytest.approx(alone.vibration_rms.values, rel=1e-5)


def test_one_pose_of_many_is_that_pose(shaken):
    """A map computed each of its poses a second time."""
    poses = kinematics.poses(shaken.robot, shaken.motion, np.linspace(0.0, shaken.duration, 4))
    many = locked_poses(shaken.robot, shaken.simulation, poses, shaken.load)
    for k in (1, 3):
        alone = locked_poses(shaken.robot, shaken.simulation, poses.part(slice(k, k + 1)), shaken.load)
        for ours, theirs in zip(vibration_rows(shaken, many.one(k)), vibration_rows(shaken, alone), strict=True):
            np.testing.assert_allclose(ours.by_leg, theirs.by_leg, rtol=1e-9, atol=1e-9 * np.abs(theirs.by_leg).max())


def test_poles_within_the_spectra_without_those_of_far_modes():
    robot, rate = linear(fx.preset("paper-robot")), 2 * np.pi * 80
    every, near = poles(robot.omega, robot.damping), robot.poles(rate)
    assert len(near) < 0.7 * len(every)
    for s in every[(np.abs(every) < rate) & (every.imag > 0)]:
        assert np.abs(near - s).min() < -s.real / FAR
    # 94 panels in place of 287, with poles no nearer to them
    white = Source(
        name="white", forces=robot.inputs["wrench"], frequency=np.array([4.0, 80.0]), density=np.ones((2, 6))
    )
    assert len(panels(robot, [white], 1)) < 120
    found, fine = random_vibration(robot, [white]), random_vibration(robot, [white], refine=3)
    assert found.rms == pytest.approx(fine.rms, rel=1e-5)


def test_a_symmetric_robot_vibrates_symmetrically(shaken):
    # three pairs of legs about the vertical: x and y alike, nothing between them, nor between y and rz
    given = shaken.disturbance
    robot = shaken.replace(disturbance=model.Disturbance(floor=given.floor, force_noise=given.force_noise))
    data = fx.vibration(robot)
    rms = data.vibration_rms.values
    assert rms[0] == pytest.approx(rms[1], rel=1e-6)
    assert rms[3] == pytest.approx(rms[4], rel=1e-6)
    correlation = data.vibration_covariance.values / np.outer(rms, rms)
    for i, j in ((0, 1), (0, 2), (1, 2), (0, 3), (1, 4), (2, 5), (3, 4)):
        assert correlation[i, j] == pytest.approx(0, abs=1e-5)
    by_leg = vibration_rows(robot, locked(robot))[1].by_leg
    assert by_leg[:, 2] == pytest.approx(by_leg[0, 2], rel=1e-6)


def test_the_heave_of_a_heavy_payload_by_its_closed_form(study):
    # with legs of next to no mass beside it the heave of a symmetric robot at home is a mass on a spring: on a floor
    # that shakes along z sqrt(S_a / (64 pi^3 f^3 zeta)). Legs have a fiftieth of the mass; a tenth of the frequency is
    # cut off below, which is of the order of the damping ratio
    load = study.robot.payload
    heavy = load.replace(mass=100 * load.mass, inertia=100 * load.inertia)
    level = model.Floor(frequency=np.array([0.1, 2000.0]), density=np.tile([0, 0, 1e-6], (2, 1)))
    shaken = study.replace(robot=study.robot.replace(payload=heavy), disturbance=model.Disturbance(floor=level))
    data = fx.vibration(shaken)
    heave = int(data.vibration_by_mode.sel(component="z").values.argmax())
    f, ratio = float(data.frequency[heave]), float(data.damping_ratio[heave])
    expected = np.sqrt(1e-6 / (64 * np.pi**3 * f**3 * ratio))
    assert float(data.vibration_rms.sel(component="z")) == pytest.approx(expected, rel=0.01)


def test_a_table_of_many_rows_costs_little_and_is_as_exact(study, monkeypatch):
    # One spectrum, in two rows and in 4000: straight in logarithms between them. Polynomials of eight points on panels
    # of half the length miss a response by 11.6^-8 = 3e-9 of its largest value there; a rms is an integral of squares.
    solved, amplitudes = [], LinearRobot.amplitudes
    monkeypatch.setattr(LinearRobot, "amplitudes", lambda *a: solved.append(len(a[1])) or amplitudes(*a))
    ends, slope = np.array([1.0, 400.0]), lambda f: np.outer(1e-6 * f**-0.5, [1.0, 2.0, 3.0])
    found = []
    for f in (ends, np.geomspace(*ends, 4000)):
        floor = model.Floor(frequency=f, density=slope(f), of="acceleration")
        found.append(fx.vibration(study.replace(disturbance=model.Disturbance(floor=floor)), TILTED))
    few, many = found
    assert len(many.spectrum_frequency) > 30_000 > 10_000 > sum(solved)
    np.testing.assert_allclose(many.vibration_rms, few.vibration_rms, rtol=1e-7)
    np.testing.assert_allclose(many.vibration_by_source, few.vibration_by_source, rtol=1e-7)
    np.testing.assert_allclose(
        many.vibration_by_mode, few.vibration_by_mode, atol=1e-7 * float(few.vibration_rms.max())
    )


def test_what_check_says(shaken):
    (words,) = vibration_words(describe(shaken).disturbances, "at home")
    assert "shake the tool at home by x" in words and "rms" in words and "Hz" in words
    along_x = model.Floor(frequency=np.array([1.0, 500.0]), density=np.tile([1e-8, 0, 0], (2, 1)))
    found = describe(shaken.replace(disturbance=model.Disturbance(floor=along_x)))
    (words,) = vibration_words(found.disturbances, "at home")
    assert ", y 0, z 0 (rms" in words  # not the rounding of a symmetric machine
    assert describe(shaken.replace(disturbance=None)).disturbances is None


def test_the_figure_names_the_modes(shaken):
    figure = fx.plot.vibration(fx.vibration(shaken))
    for axes in figure.axes:
        assert len(axes.lines) > 3
        assert any(text.get_text().startswith("mode") and "Hz" in text.get_text() for text in axes.texts)


def test_floors_that_end_below_the_first_mode_are_remarked():
    level = model.Floor(frequency=np.array([1.0, 5.0]), density=np.full((2, 3), 1e-6))
    study = lumped(disturbance=model.Disturbance(floor=level))
    assert "the floor's spectrum ends at 5 Hz" in fx.vibration(study).attrs["warnings"]
    assert "the floor's spectrum ends at 5 Hz" in vibration_words(home_shaking(study), "at home")[1]


def test_what_has_no_vibration(shaken):
    with pytest.raises(fx.InputError, match=r"disturbance.*is missing.*VC-C"):
        fx.vibration(shaken.replace(disturbance=None))
    held = tuple(leg.replace(drive=model.PrescribedDrive()) for leg in shaken.robot.legs)
    with pytest.raises(fx.InputError, match=r"force_noise.*hold their positions"):
        fx.vibration(shaken.replace(robot=shaken.robot.replace(legs=held)))
    bare = fx.preset("paper-robot")
    loose = tuple(leg.replace(damping=0.0) for leg in bare.robot.legs)
    bare = bare.replace(
        robot=bare.robot.replace(legs=loose), disturbance=model.Disturbance(floor=model.Floor.by_curve("VC-A"))
    )
    with pytest.raises(fx.InputError, match=r"leg\.damping.*without damping"):
        fx.vibration(bare)


DT = 5e-3  # s between the draws of a noise


def noise(T: float, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Time and independent draws of some standard deviations, straight in between; frequency and density of that.

    The one-sided density is 2 s^2 dt sinc(f dt)^4. At t = 0 nothing acts.
    """
    time, f = np.arange(round(T / DT) + 1) * DT, np.geomspace(0.02, 0.9 / DT, 300)
    drawn = np.random.default_rng(7).standard_normal((len(time), len(spread))) * spread
    drawn[0] = 0.0
    return time, drawn, f, 2 * DT * np.sinc(f * DT)[:, None] ** 4 * spread**2


def same_variance(data, expected, T: float, chosen: list[int]) -> None:
    """Within three standard errors, themselves below 3 %: the variance over T has the variance int S^2 df / T."""
    tool = (data.tool_deviation - data.tool_deviation[0]).values[200:]
    found, variance_ = (tool**2).mean(axis=0), expected.vibration_rms.values[:3] ** 2
    at, S = expected.spectrum_frequency.values, expected.vibration_psd.values[:, :3]
    error = np.sqrt(np.trapezoid(S**2, at, axis=0) / T)
    assert (error[chosen] / variance_[chosen] < 0.06).all()  # of the rms half of it
    for k in chosen:
        assert found[k] == pytest.approx(variance_[k], abs=3 * error[k])


def test_a_long_simulation_has_the_variance_of_the_spectra():
    T, spread = 40.0, np.array([300.0, 0.0, 500.0, 0.0, 40.0, 0.0])
    study = model.override(fx.preset("machine-hexapod"), fidelity="rigid", step=1.25e-3, output_step=5e-3)
    still = model.AxisMotion(type="heave", amplitude=0.0, duration=1.0)
    time, drawn, f, density = noise(T, spread)
    study = study.replace(
        robot=on_servos(study.robot, stiffness=4e5, damping=1.2e4),
        motion=still,
        simulation=study.simulation.replace(duration=T),
        disturbance=model.Disturbance(wrench=model.Spectrum(frequency=f, density=density)),
    )
    data = fx.simulate(study, load=model.CsvWrench(time=time, wrench=drawn))
    same_variance(data, fx.vibration(study), T, [0, 2])


def on_dampers(hertz: float, mass: float) -> Mount:
    """Springs and dampers under some 1200 kg that move at a frequency, damped by 0.6 of the critical, and a plate."""
    heavy, w = np.diag([1200.0, 1200.0, 1200.0, 900.0, 900.0, 300.0]), 2 * np.pi * hertz
    return Mount(stiffness=w**2 * heavy, damping=1.2 * w * heavy, mass=mass, inertia=np.eye(3) * 8)


@pytest.mark.parametrize("source", ["floor", "wrench"])
def test_a_long_simulation_on_mounts_has_the_variance_of_the_spectra(source):
    # The floor shakes under a mount of the base; a wrench shakes the tool above mounts of both plates. Modes from 4 Hz,
    # steps of 2.5 ms: (omega h)^2 / 12 is below 1 % up to 20 Hz, of variances that are known to 18 %.
    T, robot = 50.0, machine().replace(base_mount=on_dampers(8.0, 150.0))
    spread = np.array([0.3, 0.0, 0.5] if source == "floor" else [300.0, 0.0, 500.0, 0.0, 40.0, 0.0])
    time, drawn, f, density = noise(T, spread)
    if source == "floor":
        robot = robot.replace(base_motion=BaseMotion(time=time, values=np.pad(drawn, ((0, 0), (0, 3)))))
        given, load = model.Disturbance(floor=model.Floor(frequency=f, density=density)), None
    else:
        robot = robot.replace(platform_mount=on_dampers(12.0, 30.0))
        given = model.Disturbance(wrench=model.Spectrum(frequency=f, density=density))
        load = model.CsvWrench(time=time, wrench=drawn)
    study = heaved(robot, duration=T, step=2.5e-3, output_step=5e-3, fidelity="lumped")
    study = study.replace(motion=study.motion.replace(amplitude=0.0), disturbance=given)
    same_variance(fx.simulate(study, load=load), fx.vibration(study), T, [0, 2])
