"""What a linear model, a loop about it, a simulation with a controller must not be given: refused in words, by key."""

import numpy as np
import pytest
from tests.helpers.odd import NAN, refused, swinging
from tests.helpers.samples import sample_study

import flexapod as fx
from flexapod import control
from flexapod.output.exchange.formats import uff

pytestmark = pytest.mark.unit


@pytest.fixture(scope="module")
def robot():
    return fx.preset("nano-hexapod")


@pytest.fixture(scope="module")
def system():
    return swinging()


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"inputs": None}, "inputs"),
        ({"inputs": 3}, "inputs"),
        ({"outputs": None}, "outputs"),
        ({"inputs": "force:(nan, 0, 0)"}, "inputs"),
        ({"inputs": "force:(1e400, 0, 0)"}, "inputs"),
        ({"outputs": "geophone:tool[nan, 0.7, 1]"}, "outputs"),
    ],
)
def test_channels_that_are_none(robot, given, key):
    refused(lambda: fx.linearize(robot, **{"inputs": "drive", "outputs": "tool"} | given), key)


def test_one_axis_of_a_geophone_of_given_numbers(robot):
    one = fx.linearize(robot, inputs="drive:1", outputs="geophone:tool[2 Hz, 0.7, 28.8]:x")
    assert one.outputs == ("geophone:tool:x",)
    hz = np.array([1.0, 10.0, 100.0])
    x, ry = fx.linearize(robot, inputs="drive:1", outputs=["tool:x", "tool:ry"]).at(hz)[:, 0]
    s, w = 2j * np.pi * hz, 2 * np.pi * 2.0
    felt = s**2 * x + robot.robot.gravity[2] * ry  # as it leans by ry, weight pulls the proof mass along
    expected = 28.8 * felt * s / (s**2 + 2 * 0.7 * w * s + w**2)
    # accelerations at rest are small differences of large ones: of the largest, rounding times the squared ratio of the
    # fastest mode (some 1e5 Hz) to the first (some 10 Hz)
    assert np.abs(one.at(hz)[0, 0] - expected).max() < 1e-8 * np.abs(expected).max()


@pytest.mark.parametrize("pose", [{"heave": []}, {"heave": [50.0, 60.0]}])
def test_many_poses_of_which_none_is_in_reach(robot, pose):
    found = fx.linearize(robot, pose, inputs="drive", outputs="tool")
    assert found.sizes["pose"] == len(pose["heave"])
    assert np.isnan(found.mass.values).all()


@pytest.mark.parametrize(
    ("name", "call", "key"),
    [
        ("planar", lambda x: fx.transmissibility(x, [1.0]), "robot.plane"),
        ("planar", lambda x: fx.linearize(x, inputs="drive", outputs="force-sensor:base", drives="force"), "outputs"),
        ("strut", lambda x: fx.export(x, "abaqus", "a.inp"), "robot.platform.fixed"),
    ],
)
def test_robots_in_a_plane_and_without_a_platform(name, call, key):
    """Once an error of shapes, a base_motion that nobody had asked for, and an attribute of nothing."""
    refused(lambda: call(sample_study(name)), key)


def test_what_nothing_can_move_in_is_told_by_its_drives():
    strut = fx.model.override(sample_study("strut"), fidelity="rigid")
    with pytest.raises(fx.InputError, match="with the drives released") as error:
        fx.linearize(strut, inputs="drive", outputs="stroke", drives="force")
    assert "releases" not in (error.value.next_step or "")


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"drives": "x"}, "drives"),
        ({"friction": "stuck"}, "friction"),
        ({"load": [0, 0, 1, 0, 0, 0]}, "load"),
        ({"inputs": []}, "inputs"),
        ({"inputs": None}, "inputs"),
        ({"pose": {"rate": NAN}}, "pose.rate"),
        ({"pose": {"rate": "3 kg"}}, "pose.rate"),
        ({"pose": {"rate": [1, 2]}}, "pose.rate"),
    ],
)
def test_single_actuators_take_no_more_than_they_have(given, key):
    study = fx.preset("paper-actuator")
    refused(lambda: fx.linearize(study, **{"inputs": "force:tip", "outputs": "tip"} | given), key)


@pytest.mark.parametrize("hz", [None, "10 km", [NAN], [np.inf], [[1.0, 2.0]]])
def test_frequencies_that_are_none(robot, system, hz):
    late = system.close(control.PID(1.0), delay="1 ms")
    for call in (system.at, system.frequency_response, late.at, control.gain(1.0).at):
        refused(lambda call=call: call(hz), "hz")
    refused(lambda: fx.compliance(robot, hz), "hz")
    refused(lambda: fx.transmissibility(robot, hz), "hz")


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda x: x.select(3), "inputs"),
        (lambda x: x.reduce(2.5), "modes"),
        (lambda x: x.reduce("3"), "modes"),
        (lambda x: x.step(1.0, 2.0), "step"),
        (lambda x: x.step("1 kg"), "duration"),
        (lambda x: x.step(1e9, 1e-6), "duration"),
        (lambda x: x.sampled("0 Hz"), "sample"),
        (lambda x: x.sampled(1e-4, -1.0), "delay"),
        (lambda x: x.sampled(1e-4, 1e3), "delay"),
        (lambda x: x.psd("noise.csv"), "sources"),
        (lambda x: x.psd({"drive": None}), "sources[drive]"),
        (lambda x: x.psd({"drive": ([1.0, 2.0], [1.0, NAN])}), "density[2][1]"),
        (lambda x: x.close(3), "controller"),
        (lambda x: x.close(control.IFF), "controller"),
        (lambda x: x.close(control.IFF("1 kg", sensor="stroke")), "gain"),
        (lambda x: x.close(control.IFF(NAN, sensor="stroke")), "gain"),
        (lambda x: x.close(control.PID(NAN)), "numerator"),
        (lambda x: x.close(control.Decentralised(3.0, sensor="stroke")), "law"),
        (lambda x: x.close(control.Parallel(())), "parts"),
        (lambda x: control.root_locus(x, control.PID(1.0), []), "gains"),
        (lambda x: control.root_locus(x, control.PID(1.0), [NAN]), "gains"),
        (lambda x: control.ring_down([], 1e-3), "samples"),
        (lambda x: control.ring_down([NAN] * 100, 1e-3), "samples"),
        (lambda x: control.robot_jacobian(x), "robot"),
        (lambda x: control.robot_jacobian(fx.preset("tripod"), [0.0, 0.0, NAN]), "at"),
        (lambda x: control.robot_jacobian(fx.preset("tripod"), [0.0, 0.0]), "at"),
        (lambda x: control.robot_jacobian(fx.preset("tripod"), "cok", [1.0, 2.0]), "stiffness"),
        (lambda x: control.by_jacobian("x"), "jacobian"),
        (lambda x: control.by_jacobian([[NAN]]), "jacobian"),
    ],
)
def test_what_is_asked_of_a_system(system, call, key):
    refused(lambda: call(system), key)


def test_directions_without_any_stroke_are_not_told_apart():
    with pytest.raises(fx.ComputationError, match="not told apart"):
        control.by_jacobian(np.zeros((6, 6)))


def test_a_system_has_finite_matrices():
    names = {"inputs": ("a",), "outputs": ("b",), "states": ("x",), "units": {}}
    for A in ([[NAN]], [["x"]]):
        refused(lambda A=A: control.StateSpace(A=A, B=[[1.0]], C=[[1.0]], D=[[0.0]], **names), "A")


def test_every_name_of_the_package_is_there():
    assert [name for name in control.__all__ if not hasattr(control, name)] == []


def test_texts_and_numbers_of_numpy_are_taken(system):
    assert np.array_equal(system.step("10 ms", "1 ms").time, system.step(0.01, 0.001).time)
    assert system.sampled(np.float32(0.25)).sample == system.sampled(0.25).sample == 0.25


def test_a_study_has_the_jacobian_of_its_robot(robot):
    assert np.array_equal(control.robot_jacobian(robot), control.robot_jacobian(robot.robot))


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"quantise": "1 N"}, "quantise"),
        ({"quantise": [1, 2]}, "quantise"),
        ({"saturate": "5 N"}, "saturate"),
        ({"noise": (1, 2)}, "noise"),
        ({"noise": {"psd": "1 kg"}}, "noise.psd"),
        ({"noise": 1.0, "seed": -1}, "seed"),
        ({"noise": 1.0, "seed": 1.5}, "seed"),
        ({"delay_samples": 10**9}, "delay_samples"),
    ],
)
def test_settings_of_a_sampled_controller(robot, given, key):
    refused(lambda: fx.simulate(robot, controller=control.IFF(50.0), **{"sample": 2e-4} | given), key)


def test_a_study_is_no_name_of_a_preset(robot):
    refused(lambda: fx.open_values(robot), "preset")


@pytest.mark.parametrize("modes", [1.5, None, "12 Hz", [(12.0,)], [None]])
def test_modes_that_a_shaper_cannot_take(modes):
    motion = fx.preset("machine-hexapod").motion
    refused(lambda: fx.shape(motion, modes=modes), "modes")


def test_formats_and_results_that_are_none(robot, tmp_path):
    refused(lambda: fx.export(robot, ["fmu"], tmp_path / "x.fmu"), "format")
    refused(lambda: fx.export(robot, "gltf", tmp_path / "x.glb", data=3), "data")
    refused(lambda: fx.export(robot, "vtk", tmp_path / "x.pvd", data=3), "data")
    refused(lambda: uff(None), "data")


def test_a_motion_of_another_robot_is_not_written(robot, tmp_path):
    other = fx.simulate(fx.preset("machine-hexapod"), fidelity="rigid", duration=0.002, output_step=0.001)
    for study in (robot, fx.preset("tripod"), fx.preset("small-hexapod")):
        refused(lambda study=study: fx.export(study, "gltf", tmp_path / "x.glb", data=other), "data")
        refused(lambda study=study: fx.export(study, "vtk", tmp_path / "x.pvd", data=other), "data")


def test_results_that_are_none_are_not_drawn():
    for draw in (fx.plot.bode, fx.plot.pole_map, fx.plot.transmissibility, fx.plot.cumulative):
        for none in (None, 3, {}):
            with pytest.raises(fx.InputError):
                draw(none)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("twice.csv", b"f,a/b real,a/b imag,a/b real,a/b imag\n1,1,2,3,4\n2,1,1,3,4\n"),
        ("nan.csv", b"f,a/b real,a/b imag\nnan,1,2\n2,1,1\n"),
        ("damaged.mat", b"garbage"),
        ("empty.mat", b""),
    ],
)
def test_measured_responses_that_cannot_be_taken(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(fx.InputError) as error:
        fx.read_frf(path)
    assert error.value.file == str(path)


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda s: fx.linearize(s, inputs="wrnch", outputs="tool"), "inputs"),
        (lambda s: fx.compliance(s, "a"), "hz"),
        (lambda s: fx.transmissibility(s, [1.0], at="nowhere"), "at"),
        (lambda s: fx.shape(s, ["zv"]), "kind"),
        (lambda s: fx.shape(s, out="shaped.txt"), "out"),
        (lambda s: fx.compensate(s, out="ahead.txt"), "out"),
        (lambda s: fx.time_optimal(s, force="2 kN", out="fast.txt"), "out"),
        (lambda s: fx.export(s, "gltf", "motion.glb", magnify=-1.0), "magnify"),
        (lambda s: fx.export(s, "abaqus", "deck.inp", elements=0), "elements"),
    ],
)
def test_what_is_refused_is_so_before_anything_is_computed(robot, call, key, monkeypatch):
    def computed(*given, **named):
        raise AssertionError("computed first")

    for name in (
        "solve.modal.elastic_robot.lock",
        "analysis.simulation.run_simulation",
        "analysis.checks.checks.check_path",
    ):
        monkeypatch.setattr(f"flexapod.{name}", computed)
    refused(lambda: call(robot), key)
