"""The linear model as a whole: beside spectra in modes, by symmetry, released drives, many poses, what is refused."""

import numpy as np
import pytest
from tests.helpers import motor_loops as motors
from tests.helpers.machine_hexapod import TILTED, lumped
from tests.helpers.machines import EVERYTHING, OIL, SCREW, machine, study
from tests.helpers.samples import SAMPLES, sample_study

import flexapod as fx
from flexapod import kinematics, model
from flexapod.analysis.linear import MATRICES
from flexapod.analysis.results.arguments import as_pose
from flexapod.kinematics import inverse_kinematics, poses_from_home
from flexapod.kinematics.rotations import exponential
from flexapod.solve.linear.random_vibration import linear_robot
from flexapod.solve.modal.at_poses import locked_poses

pytestmark = pytest.mark.consistency

HZ = np.geomspace(1.0, 500.0, 25)
AXES = ("floor:x", "floor:y", "floor:z")


def in_modes(given, pose):
    """Response of the tool to floor, wrench and drives (6, inputs, f) in undamped modes."""
    path = as_pose(given.robot, pose)
    known = linear_robot(locked_poses(given.robot, given.simulation, path, given.load))
    forces = np.concatenate([known.inputs[name] for name in ("floor", "wrench", "drive")], axis=1)
    return np.moveaxis(known.tool @ known.amplitudes(HZ, forces), 0, -1)


@pytest.mark.parametrize("friction", ["sliding", "stuck"])
def test_responses_are_those_in_modes(friction):
    given = lumped()
    given = given.replace(simulation=given.simulation.replace(friction=friction))
    lin = fx.linearize(given, TILTED, inputs=[*AXES, "wrench", "drive"], outputs="tool")
    ours, theirs = lin.at(HZ), in_modes(given, TILTED)
    # rounding, 1e-16, times the square of how far modes lie apart, 1e3
    for k in range(ours.shape[1]):
        assert np.abs(ours[:, k] - theirs[:, k]).max() < 1e-9 * np.abs(theirs[:, k]).max()


def test_spectra_are_those_of_vibration():
    f = np.array([1.0, 500.0])
    wrench = model.Spectrum(frequency=f, density=np.tile([1.0, 2.0, 3.0, 0.1, 0.2, 0.3], (2, 1)))
    given = lumped(disturbance=model.Disturbance(floor=model.Floor.by_curve("VC-A"), wrench=wrench))
    data = fx.vibration(given, TILTED)
    hz = data.spectrum_frequency.values
    floor = given.disturbance.floor
    from flexapod.solve.linear.random_vibration import density_at

    S = np.concatenate(
        [density_at(floor.frequency, floor.density, hz) * (2 * np.pi * hz[:, None]) ** 2,
         density_at(wrench.frequency, wrench.density, hz)], axis=1)  # fmt: skip
    H = fx.linearize(given, TILTED, inputs=[*AXES, "wrench"], outputs="tool").at(hz)
    psd = np.einsum("pmf,fm->fp", np.abs(H) ** 2, np.broadcast_to(S, (len(hz), 9)))
    assert psd == pytest.approx(data.vibration_psd.values, rel=1e-9, abs=1e-9 * data.vibration_psd.values.max())


def test_sources_are_those_of_vibration():
    f = np.array([1.0, 500.0])
    noise = model.Spectrum(frequency=f, density=np.full((2, 1), 4.0))
    wrench = model.Spectrum(frequency=f, density=np.tile([1.0, 2.0, 3.0, 0.1, 0.2, 0.3], (2, 1)))
    floor = model.Floor.by_curve("VC-A")
    given = lumped(disturbance=model.Disturbance(floor=floor, wrench=wrench, force_noise=noise))
    data = fx.vibration(given, TILTED)
    lin = fx.linearize(given, TILTED, inputs=["floor", "wrench", "drive"], outputs="tool")
    found = lin.by_source(given.disturbance)
    # the same panels and the same spectra: what is left is rounding of poles and responses
    assert found.rms_by_source.values == pytest.approx(data.vibration_by_source.values, rel=1e-9)
    assert lin.psd(given.disturbance).rms.values == pytest.approx(data.vibration_rms.values, rel=1e-9)


@pytest.mark.parametrize("drives", ["given", "force"])
@pytest.mark.parametrize("name", ["paper-robot", "machine-hexapod", "tripod"])
def test_reciprocity(name, drives):
    lin = fx.linearize(fx.preset(name), inputs=["wrench", "force:joint-1"], outputs="tool", drives=drives)
    H = lin.select("wrench", "tool").at(HZ)
    # without rounding equal; free of their drives robots have rates 1e5 apart
    least = 1e-10 if drives == "given" else 1e-9
    assert np.abs(H - H.transpose(1, 0, 2)).max() < least * np.abs(H).max()


@pytest.mark.parametrize("name", ["paper-robot", "machine-hexapod", "tripod", "nano-hexapod"])
def test_a_floor_at_rest_is_followed(name):
    data = fx.transmissibility(fx.preset(name), [0.0])
    assert data.transmissibility.sel(part="real").values[..., 0] == pytest.approx(np.eye(6), abs=1e-9)
    assert not data.transmissibility.sel(part="imaginary").values.any()
    assert float(data.transmissibility_norm[0]) == pytest.approx(np.sqrt(6))


def test_a_robot_on_a_slope_sags_by_the_slope():
    # slow turns with gravity: the platform stands at 1 on the slope, and sags by gravity that has turned
    given, hz = fx.preset("machine-hexapod"), [1e-3]
    flat, tilted = (fx.transmissibility(given, hz, tilt=tilt).transmissibility.sel(part="real").values[..., 0]
                    for tilt in (False, True))  # fmt: skip
    assert np.abs(tilted - flat)[:, :3].max() < 1e-12
    angle, sagged = 1e-3, []
    for sign in (1, -1):
        R = exponential(np.array([0.0, sign * angle, 0.0]))
        robot = given.robot.replace(gravity=R.T @ given.robot.gravity)
        sagged.append(fx.modes(given.replace(robot=robot)).com_sag.values)
    slope = (sagged[0] - sagged[1]) / (2 * angle)
    com = fx.transmissibility(given, hz, at="com", tilt=True).transmissibility.sel(part="real").values[:3, 4, 0]
    assert com == pytest.approx(slope, abs=1e-4 * np.abs(slope).max())


def test_legs_in_another_order_are_channels_in_another_order():
    given, order = lumped(), np.array([3, 0, 5, 1, 4, 2])
    robot = given.robot
    moved = given.replace(robot=robot.replace(
        base_joints=robot.base_joints[order], platform_joints=robot.platform_joints[order],
        legs=tuple(robot.legs[i] for i in order)))  # fmt: skip
    names = {"inputs": ["drive", "wrench"], "outputs": ["stroke", "drive-force", "joint-force", "force-sensor:base"]}
    a, b = fx.linearize(given, TILTED, **names).at(HZ), fx.linearize(moved, TILTED, **names).at(HZ)
    inputs = np.concatenate([order, np.arange(6, 12)])
    joints = (12 + 3 * order[:, None] + np.arange(3)).ravel()
    outputs = np.concatenate([order, 6 + order, joints, 30 + order])
    for k in (slice(0, 6), slice(6, 36)):
        expected = a[outputs][:, inputs][k]
        assert np.abs(b[k] - expected).max() < 1e-8 * np.abs(expected).max()


def test_a_turned_world_turns_the_channels():
    given = lumped()
    robot, angle = given.robot, 0.7
    R = exponential(np.array([0.0, 0.0, angle]))
    turned = robot.replace(
        base_joints=robot.base_joints @ R.T, home=model.Home(position=R @ robot.home_position, rotation=[0, 0, angle])
    )
    names = {"inputs": ["wrench", "floor"], "outputs": ["tool", "accelerometer:joint-2"]}
    a, b = (fx.linearize(given.replace(robot=x), **names).at(HZ) for x in (robot, turned))
    by_four = np.kron(np.eye(4), R)
    expected = np.einsum("ij,jkf,lk->ilf", np.kron(np.eye(3), R), a, by_four)
    for rows in (slice(0, 3), slice(3, 6), slice(6, 9)):
        for columns in (slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)):
            ours, theirs = b[rows, columns], expected[rows, columns]
            assert np.abs(ours - theirs).max() < 1e-7 * np.abs(theirs).max()


class TestReleased:
    def test_drives_that_are_released_and_closed_again_are_servos(self):
        # the plant of a force actuator behind a spring and a damper by hand is the robot on servos
        given, k, c = lumped(), 60e6, 60e3
        free = fx.linearize(given, TILTED, inputs=["drive", "wrench"], outputs=["stroke", "tool"], drives="force")
        s = 2j * np.pi * HZ
        H = free.at(HZ)
        closed = np.empty((6, 6, len(HZ)), dtype=complex)
        for n in range(len(HZ)):
            z = k + c * s[n]
            loop = np.linalg.solve(np.eye(6) + z * H[:6, :6, n], H[:6, 6:, n])
            closed[..., n] = H[6:, 6:, n] - z * H[6:, :6, n] @ loop
        theirs = fx.linearize(given, TILTED, inputs="wrench", outputs="tool").at(HZ)
        assert np.abs(closed - theirs).max() < 1e-8 * np.abs(theirs).max()

    def test_pure_force_drives_are_linearised_so(self):
        given = fx.preset("paper-robot")
        drive = model.ForceDrive(law="rigid")
        pure = given.replace(robot=given.robot.replace(legs=tuple(x.replace(drive=drive) for x in given.robot.legs)))
        with pytest.raises(fx.InputError, match=r"pure force.*drives=\"force\""):
            fx.linearize(pure, inputs="drive", outputs="tool")
        a, b = (fx.linearize(x, inputs="drive", outputs="tool", drives="force").at(HZ) for x in (given, pure))
        assert a == pytest.approx(b, rel=1e-12)

    @pytest.mark.parametrize(("encoder", "motor"), [(motors.STROKE, motors.LAGS), (motors.ROTOR, model.Motor())])
    def test_motors_that_are_released_and_closed_again_are_loops(self, encoder, motor):
        # k, c and g of the loop about what the encoder shows, by hand, about the plant that is left without them: its
        # lag stays. The same equilibrium but for what a spring of a loop gives way at rest, 1e-5 m of a metre
        given = study(motors.real(encoder, motor), fidelity="lumped")
        screw = given.robot.legs[0].screw
        (k, c), g, s = screw.loop_spring, screw.integral, 2j * np.pi * HZ
        free = fx.linearize(given, inputs=["drive", "wrench"], outputs=["encoder", "tool"], drives="force")
        assert any("motor force" in name for name in free.states) == bool(screw.lag)
        assert not any("summed error" in name for name in free.states)
        H, closed = free.at(HZ), np.empty((6, 6, len(HZ)), dtype=complex)
        for n in range(len(HZ)):
            z = k + c * s[n] + g / s[n]
            loop = np.linalg.solve(np.eye(6) + z * H[:6, :6, n], H[:6, 6:, n])
            closed[..., n] = H[6:, 6:, n] - z * H[6:, :6, n] @ loop
        theirs = fx.linearize(given, inputs="wrench", outputs="tool").at(HZ)
        assert np.abs(closed - theirs).max() < 1e-7 * np.abs(theirs).max()

    @pytest.mark.parametrize("place", ["rotor", "stroke", "joint-to-joint"])
    def test_screws_that_hold_what_they_measure_are_rotors_on_springs(self, place):
        # whatever they measured: released they are the same machine
        given = [study(machine(drive=SCREW.replace(encoder=model.Encoder(at=x)), **EVERYTHING), fidelity="lumped")
                 for x in ("rotor", place)]  # fmt: skip
        first, second = (fx.linearize(x, inputs="drive", outputs="tool", drives="force") for x in given)
        assert first.states == second.states
        # the rotor is 2e-5 m from where it was, and the stiffness of its screw goes with that: 1e-4
        a, b = first.at(HZ), second.at(HZ)
        assert np.abs(a - b).max() < 1e-3 * np.abs(a).max()


COMMANDED = {
    "servo": lumped(),
    "held stroke": fx.preset("paper-robot"),
    "held rotor": study(machine(drive=SCREW, **EVERYTHING)),
    "screw about its stroke": study(machine(drive=SCREW.replace(encoder=model.Encoder(at="stroke")), **EVERYTHING)),
    "from joint to joint": study(
        machine(drive=SCREW.replace(encoder=model.Encoder(at="joint-to-joint")), **EVERYTHING)
    ),
    "loops": study(motors.mixed()),
    "oil": study(machine(drive=OIL)),
    "carriages": sample_study("hexaglide"),
    "hinges": sample_study("tripod"),
    "a passive leg": sample_study("tricept"),
    "flexures": sample_study("flexures"),
}


@pytest.mark.parametrize("name", list(COMMANDED))
def test_slow_commands_take_the_tool_where_the_rigid_robot_goes(name):
    # told as inverse kinematics says for a step of the platform, the tool makes this step; weight that the step turns
    # bends robots by 1e-4 of it, and joints that give way share it in the same proportion
    given = COMMANDED[name]
    given = given.replace(robot=given.robot.replace(gravity=np.zeros(3)))
    lin = fx.linearize(given, inputs="command", outputs="tool")
    s = 2j * np.pi * 1e-4
    H = (s**2 * lin.at([1e-4])[:, :, 0]).real
    legs = [int(x.partition(":")[2]) - 1 for x in lin.inputs]
    ways = []
    for step in (1e-6, -1e-6):
        found = inverse_kinematics(given.robot, poses_from_home(given.robot, np.array([[0, 0, step, 0, 0, 0]])))
        carried = found.chi if found.chi is not None else found.length
        ways.append([(carried if given.robot.legs[i].driven == "carriage" else found.length)[0, i] for i in legs])
    moved = H @ (np.subtract(*ways) / 2e-6)
    assert moved[2] == pytest.approx(1.0, abs=2e-3 if name == "flexures" else 1e-4)
    assert np.abs(moved[[0, 1]]).max() < 1e-3


MOTIONS = {"delta": ("surge", "sway", "heave"), "tripod": ("heave", "roll", "pitch"), "planar": ("surge", "yaw"),
           "tricept": ("heave",), "hexaglide": model.AXES, "eight-legs": model.AXES, "hexapod": model.AXES,
           "flexures": ("heave", "yaw")}  # fmt: skip


class TestManyPoses:
    def test_a_grid_holds_the_matrices_of_each_pose(self, tmp_path):
        given = sample_study("delta")
        heave = np.linspace(-0.01, 0.01, 5)
        names = {"inputs": ["wrench", "command"], "outputs": ["tool", "com", "stroke"]}
        data = fx.linearize(given, {"heave": heave}, **names)
        data.to_netcdf(tmp_path / "grid.nc")
        for k, h in enumerate(heave):
            one = fx.linearize(given, {"heave": h}, **names)
            M, D, K, B, C = (data[name].values[k] for name in MATRICES)
            d = data.attrs["free_motions"]
            n = len(M)
            A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
            H = [
                np.block([C, 0 * C])
                @ np.linalg.solve(2j * np.pi * f * np.eye(2 * n) - A, np.vstack([0 * B, np.linalg.solve(M, B)]))
                for f in (3.0, 70.0)
            ]
            theirs = one.at([3.0, 70.0])
            for f in range(2):
                assert np.abs(H[f] - theirs[..., f]).max() < 1e-8 * np.abs(theirs[..., f]).max()
            assert d == n - 3

    def test_poses_that_have_none_say_why(self):
        data = fx.linearize(fx.preset("paper-robot"), {"heave": [0.0, 5.0, 0.01]}, inputs="wrench", outputs="tool")
        assert np.isnan(data.mass.values[1]).all() and np.isfinite(data.mass.values[[0, 2]]).all()
        words = data.reason.attrs["flag_meanings"].split()
        assert words[data.reason.values[0]] == words[data.reason.values[2]] != words[data.reason.values[1]]

    @pytest.mark.parametrize("name", list(MOTIONS))
    def test_matrices_are_smooth_from_pose_to_pose(self, name):
        """Along each motion of a sample, and along that of its file: neighbours half as far apart differ by half."""
        given = sample_study(name)
        moving = given.motion.end_time - given.motion.hold
        ways = [lambda n: kinematics.coordinates(given.motion, np.linspace(0.0, moving, n))[0]]
        for axis in MOTIONS[name]:
            far = (0.005 if axis in model.AXES[:3] else 0.05) * (0.02 if name == "flexures" else 1.0)
            ways.append(lambda n, axis=axis, far=far: {axis: np.linspace(-far, far, n)})
        for way in ways:
            steps = []
            for count in (101, 201):
                data = fx.linearize(given, way(count), inputs="wrench", outputs="tool")
                K, M = data.stiffness.values, data.mass.values
                steps.append([np.abs(np.diff(x, axis=0)).max() / np.abs(x).max() for x in (K, M)])
            assert steps[0] == pytest.approx(2 * np.array(steps[1]), rel=0.1, abs=1e-12)

    def test_the_sample_that_is_left_out_has_one_pose(self):
        assert set(SAMPLES) - set(MOTIONS) == {"strut"}
        strut = sample_study("strut")
        assert strut.robot.platform_fixed
        with pytest.raises(fx.InputError, match="0 motions"):
            fx.linearize(strut, {"heave": [0.0, 0.001]}, inputs="drive", outputs="stroke")


class TestRefused:
    @pytest.mark.parametrize(("inputs", "outputs", "words"), [
        ("wrensh", "tool", "wrensh.*Did you mean 'wrench'"),
        ("wrench:fxx", "tool", "wrench:fx to wrench:mz"),
        ("drive:7", "tool", "drive:1 to drive:6"),
        ("wrench", "tol", "Did you mean 'tool'"),
        ("wrench", "acelerometer:tool", "Did you mean 'accelerometer'"),
        ("wrench", "accelerometer:tol", "no such point.*Did you mean 'tool'"),
        ("wrench", "accelerometer", "no such point"),
        ("wrench", "geophone:tool[-1 Hz]", "is no geophone"),
        ("force:joint-9", "tool", "joint-1 to joint-6"),
        ([], "tool", "are none"),
        ("force-sensor", "tool", "is not a channel"),
        ("drive", "tool", "hold their positions.*drives = \"force\""),
    ])  # fmt: skip
    def test_names(self, inputs, outputs, words):
        with pytest.raises(fx.InputError, match=words):
            fx.linearize(fx.preset("paper-robot"), inputs=inputs, outputs=outputs)

    def test_a_base_that_turns_in_a_plane(self):
        planar = sample_study("planar")
        assert fx.linearize(planar, inputs="floor", outputs="tool").inputs == AXES
        with pytest.raises(fx.InputError, match="floor:x to floor:z"):
            fx.linearize(planar, inputs="floor:rz", outputs="tool")

    def test_channels_of_a_platform_that_is_fixed(self):
        strut = sample_study("strut")
        with pytest.raises(fx.InputError, match="platform is fixed"):
            fx.linearize(strut, inputs="wrench", outputs="stroke")

    def test_settings(self):
        with pytest.raises(fx.InputError, match="drives"):
            fx.linearize(fx.preset("paper-robot"), inputs="wrench", outputs="tool", drives="forces")
        rigid = model.override(fx.preset("paper-robot"), fidelity="rigid")
        with pytest.raises(fx.InputError, match="nothing that could move"):
            fx.linearize(rigid, inputs="wrench", outputs="tool")
