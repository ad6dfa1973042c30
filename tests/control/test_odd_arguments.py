"""What laws, controllers, loops, commands ahead and exports must not be given: refused in words, by key, at once."""

from pathlib import Path

import numpy as np
import pytest
from tests.helpers.odd import NAN, refused, swinging

import flexapod as fx
from flexapod import control

pytestmark = pytest.mark.unit

NONE = (None, NAN, "1 kg", [], [1.0, 2.0], {}, 3 + 2j, object())


@pytest.fixture(scope="module")
def system():
    return swinging()


@pytest.fixture(scope="module")
def double():
    """A mass without spring."""
    return control.StateSpace(
        A=[[0.0, 1.0], [0.0, 0.0]], B=[[0.0], [1.0]], C=[[1.0, 0.0]], D=[[0.0]], inputs=("force",),
        outputs=("place",), states=("place", "speed"), units={},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("law", "key", "more"),
    [
        (lambda v: control.low_pass(v), "corner", [-1.0, 0.0, 1e-300, 1e300]),
        (lambda v: control.low_pass(5.0, 2, v), "damping", [-0.1, 0.0]),
        (lambda v: control.high_pass(5.0, 2, v), "damping", [-0.1, 0.0]),
        (lambda v: control.lead(5.0, v), "ratio", [-1.0, 0.0]),
        (lambda v: control.notch(5.0, v), "damping", [-0.5, 0.0]),
        (lambda v: control.notch(5.0, 0.5, v), "depth", []),
        (lambda v: control.positive_feedback(5.0, v, 1.0), "damping", [-0.1, 0.0]),
        (lambda v: control.positive_feedback(5.0, 0.1, v), "value", []),
        (lambda v: control.pid(1.0, v), "integral", []),
        (lambda v: control.pid(1.0, 0.0, v), "derivative", []),
        (lambda v: control.gain(1.0) * v, "factor", []),
        (lambda v: control.gain(1.0) + v, "law", [2.0]),
        (lambda v: control.ControlLaw(A=v, B=v, C=v, D=v), "A", [2.0]),
        (lambda v: control.Tracker(frequency=v), "frequency", [0.0, -1.0, 1e9]),
        (lambda v: control.Tracker(frequency=1.0, width=v), "width", [0.0]),
        (lambda v: control.AdaptiveDamping(gain=v, tracker=control.Tracker(frequency=1.0)), "gain", []),
        (lambda v: control.AdaptiveDamping(gain=1.0, tracker=v), "tracker", [12.0]),
        (
            lambda v: control.FunctionController(function=v, inputs=("stroke:1",), outputs=("drive:1",)),
            "function",
            [2.0],
        ),
        (lambda v: control.by_jacobian(v), "jacobian", [[[1.0, NAN]]]),
        (lambda v: control.centre_of_stiffness(np.eye(6), v), "stiffness", []),
    ],
)  # fmt: skip
def test_laws_of_no_numbers(law, key, more):
    for given in (*NONE, *more):
        if key == "jacobian" and isinstance(given, list) and given in ([], [1.0, 2.0]):
            continue  # a row is a matrix
        with pytest.raises(fx.InputError) as error:
            law(given)
        assert error.value.key in (key, "jacobian, stiffness"), given


def test_a_low_pass_of_a_rate_that_is_not_there_is_no_frequency_either():
    refused(lambda: control.pid(1.0, low_pass="1 kg"), "low_pass")


def test_numbers_of_numpy_and_of_arrays_without_axes_are_taken(system):
    found = control.best_gain(system, control.DVF(1.0)).gain
    assert (control.gain(2.0) * np.float32(0.5)).D[0] == (control.gain(2.0) * np.array(0.5)).D[0] == 1.0
    assert (control.gain(1.0) * found).D[0] == found.item()


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda x: control.root_locus(None, control.PID(1.0), [1.0]), "system"),
        (lambda x: control.best_gain("robot.toml", control.PID(1.0)), "system"),
        (lambda x: control.margins([], control.PID(1.0)), "system"),
        (lambda x: control.by_modes(3), "system"),
        (lambda x: control.by_singular_vectors(None, 1.0), "system"),
        (lambda x: control.impedance({}, [1.0], force="drive:1", place="stroke:1"), "system"),
        (lambda x: control.by_modes(x, count="2"), "count"),
        (lambda x: control.by_modes(x, count=1.0), "count"),
        (lambda x: control.by_modes(x, above=-1.0), "above"),
        (lambda x: control.by_singular_vectors(x, -1.0), "hz"),
        (lambda x: control.best_gain(x, control.DVF(1.0), least=None), "least"),
        (lambda x: control.best_gain(x, control.DVF(1.0), most=np.inf), "most"),
        (lambda x: control.margins(x, control.DVF(1.0), delay=-1e-3), "delay"),
        (lambda x: control.ring_down(np.sin(np.arange(100.0)), 1e-3, 0), "order"),
        (lambda x: control.ring_down(np.sin(np.arange(100.0)), 1e-3, "10"), "order"),
        (lambda x: x.reduce(1, residual="no"), "residual"),
        (lambda x: x.reduce(below=-1.0), "below"),
        (lambda x: x.sampled(1e-300), "sample"),
        (lambda x: x.at("5"), "hz"),
        (lambda x: x.at(1e300), "hz"),
        (lambda x: x.at([True]), "hz"),
        (lambda x: x.psd(np.array([[1.0, 2.0]])), "sources"),
        (lambda x: x.psd({"drive": (1.0, 1.0)}), "density"),
        (lambda x: x.psd({"drive": ([1.0, 2.0], 1.0)}), "density"),
        (lambda x: x.save(None), "path"),
        (lambda x: x.save("a\0.mat"), "path"),
        (lambda x: x.close(control.Parallel(None)), "parts"),
        (lambda x: x.close(control.SensorFusion(2.0, low="stroke", high="stroke", corner=1.0)), "law"),
        (lambda x: x.close(control.Decoupled(None, into=[[1.0]], out=[[1.0]])), "law"),
        (lambda x: x.close(control.Decoupled(["x"], into=[[1.0]], out=[[1.0]])), "law"),
        (lambda x: x.close(control.Decoupled(control.gain(1.0), into="x", out=[[1.0]])), "into"),
        (lambda x: x.close(control.Decoupled(control.gain(1.0), into=[[1.0]], out=[[NAN]])), "out"),
    ],
)
def test_what_is_asked_of_systems_and_loops(system, call, key):
    refused(lambda: call(system), key)


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"inputs": None}, "inputs"),
        ({"inputs": ("a", "a"), "B": [[1.0, 1.0]], "D": [[0.0, 0.0]]}, "inputs"),
        ({"units": None}, "units"),
        ({"sample": "1 kg"}, "sample"),
        ({"sample": [1.0]}, "sample"),
    ],
)
def test_systems_that_are_none(given, key):
    whole = {"A": [[-1.0]], "B": [[1.0]], "C": [[1.0]], "D": [[0.0]], "inputs": ("a",), "outputs": ("b",)}
    refused(lambda: control.StateSpace(**{**whole, "states": ("x",), "units": {}, **given}), key)


def test_a_spectrum_of_no_outputs_is_empty(system):
    assert system.psd({"drive": ([1.0, 2.0], [1.0, 1.0])}, []).rms.size == 0


def test_a_delay_of_no_sample_is_none(system):
    assert len(system.sampled(0.01, 1e-300).A) == len(system.A)


@pytest.mark.parametrize(
    ("given", "pose", "key"),
    [
        ({"axes": None}, {}, "axes"),
        ({"axes": {}}, {}, "axes"),
        ({"axes": {"heave": "x"}}, {}, "axes.heave"),
        ({"axes": {"heave": [0.0, NAN]}}, {}, "axes.heave"),
        ({"controllers": None}, {}, "controllers"),
        ({"controllers": [1, 2]}, {}, "controller"),
        ({}, None, "pose"),
        ({}, {"heav": 0.5}, "pose"),
        ({}, {"heave": "x"}, "heave"),
        ({}, {"heave": NAN}, "heave"),
    ],
)
def test_gains_over_no_pose(given, pose, key):
    whole = {"axes": {"heave": [0.0, 1.0]}, "controllers": [control.PID(1.0), control.PID(2.0)]}
    refused(lambda: control.Scheduled(**(whole | given)).at(pose, ("stroke:1",), ("drive:1",)), key)


def test_other_coordinates_of_a_pose_are_no_names_of_the_grid():
    grid = control.Scheduled(axes={"heave": [0.0, 1.0]}, controllers=[control.PID(1.0), control.PID(2.0)])
    assert grid.at({"heave": 0.5, "roll": 0.1}, ("stroke:1",), ("drive:1",)).D.item() == -1.5


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"end": None}, "end"),
        ({"end": NAN}, "end"),
        ({"end": "1 m"}, "end"),
        ({"end": 1.0, "limit": "x"}, "limit"),
        ({"end": 1.0, "limit": NAN}, "limit"),
        ({"end": 1.0, "robust": "no"}, "robust"),
        ({"end": 1.0, "residual": "5 um"}, "residual"),
        ({"end": 1.0, "speed": 1.0}, "speed"),
        ({"end": 1.0, "start": 0.0}, "start"),
        ({"end": 1.0, "out": "a.toml"}, "out"),
    ],
)
def test_least_time_of_a_linear_system_has_its_own_arguments(double, given, key):
    refused(lambda: fx.time_optimal(double, **given), key)


@pytest.mark.parametrize(
    ("call", "given", "key"),
    [
        (fx.time_optimal, {"limit": 2.0}, "limit"),
        (fx.time_optimal, {"robust": True}, "robust"),
        (fx.time_optimal, {"force": "5 kN", "out": 3}, "out"),
        (fx.compensate, {"out": 3}, "out"),
        (fx.compensate, {"out": "ahead.txt"}, "out"),
        (fx.compensate, {"as_built": "no"}, "as_built"),
        (fx.compensate, {"order": np.array([[1.0, 2.0]])}, "order"),
        (fx.compensate, {"order": False}, "order"),
        (fx.shape, {"out": 3}, "out"),
        (fx.shape, {"kind": []}, "kind"),
        (fx.shape, {"kind": "zvf"}, "kind"),
        (fx.shape, {"modes": True}, "modes"),
        (fx.shape, {"modes": [{}]}, "modes"),
    ],
)
def test_commands_ahead_are_refused_before_anything_is_computed(call, given, key, monkeypatch):
    study = fx.preset("machine-hexapod")
    for place in ("shaping.check_path", "compensation.check_path", "least_time.StraightLine"):
        monkeypatch.setattr(
            f"flexapod.commissioning.feedforward.{place}", lambda *_: pytest.fail("something is computed")
        )
    refused(lambda: call(study, **given), key)


@pytest.mark.parametrize("given", [{"corrections": 3}, {"as_built": False}])
def test_options_of_robots_are_none_of_single_actuators(given):
    refused(lambda: fx.compensate(fx.preset("paper-actuator"), "stable-inversion", **given), next(iter(given)))


@pytest.mark.parametrize("modes", [(12.5, 0.01), [1e300]])
def test_frequencies_far_from_every_mode_are_no_modes(modes):
    """The pair is one mode with its damping ratio where it stands in a list; alone it was 12.5 Hz and 0.01 Hz."""
    with pytest.raises(fx.InputError, match="far from every mode") as error:
        fx.shape(fx.preset("machine-hexapod"), modes=modes)
    assert error.value.key == "modes" and "[(12.5, 0.01)]" in error.value.next_step


@pytest.mark.parametrize(("given", "key"), [({"out": "a.toml"}, "out"), ({"pose": {"roll": 0.1}}, "pose")])
def test_a_motion_alone_has_no_file_and_no_modes(given, key):
    refused(lambda: fx.shape(fx.preset("machine-hexapod").motion, modes=[12.0], **given), key)


def test_a_study_and_its_tables_are_not_replaced_by_what_is_made_of_them(tmp_path):
    text = fx.preset("machine-hexapod").source_text
    begin, end = text.index("[motion]"), text.index("[simulation]")
    (tmp_path / "robot.csv").write_text("time [s],heave [mm]\n0,0\n1,5\n2,0\n")
    file = tmp_path / "study.toml"
    file.write_text(text[:begin] + '[motion]\ntype = "csv"\nfile = "robot.csv"\n' + text[end:])
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    for name, words in (("study.toml", "the file of the study"), ("robot.toml", "robot.csv, a table that the study")):
        for call in (fx.compensate, fx.shape):
            with pytest.raises(fx.InputError, match=words) as error:
                call(file, out=tmp_path / name)
            assert error.value.key == "out"
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_study_is_written_where_its_other_tables_are(tmp_path):
    """Once its files were there before it was told that they cannot be read."""
    head = "frequency [Hz],x [(m/s^2)^2/Hz],y [(m/s^2)^2/Hz],z [(m/s^2)^2/Hz]"
    (tmp_path / "floor.csv").write_text(f"{head}\n1,1e-8,1e-8,1e-8\n100,1e-8,1e-8,1e-8\n")
    file = tmp_path / "study.toml"
    file.write_text(fx.preset("machine-hexapod").source_text + '\n[disturbance]\nfloor = { spectrum = "floor.csv" }\n')
    (tmp_path / "other").mkdir()
    with pytest.raises(fx.InputError, match=r"where floor\.csv is not") as error:
        fx.compensate(file, out=tmp_path / "other" / "ahead.toml")
    assert error.value.key == "out" and list((tmp_path / "other").iterdir()) == []


@pytest.mark.parametrize(
    ("format", "out", "given", "key"),
    [
        *((name, None, {}, "out") for name in ("abaqus", "fmu", "c", "mjcf", "gltf", "vtk", "mat")),
        ("mat", 3, {}, "out"),
        ("abaqus", "a.inp", {"title": 3}, "title"),
        ("abaqus", "a.inp", {"title": "two\n*STEP"}, "title"),
        ("c", "c", {"commands": np.ones(2)}, "commands"),
        ("c", "c", {"step": 2.5}, "step"),
        ("mjcf", "a.xml", {"fidelity": ""}, "fidelity"),
        ("gltf", "a.glb", {"magnify": 1e300}, "magnify"),
        ("gltf", "a.glb", {"magnify": -1.0}, "magnify"),
        ("mat", "a.mat", {"inputs": ""}, "inputs"),
        ("mat", "a.mat", {"outputs": []}, "outputs"),
    ],
)
def test_exports_of_no_file_and_of_no_options(format, out, given, key, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(lambda: fx.export(fx.preset("nano-hexapod"), format, out, **given), key)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", [None, 3, b"a.csv", "a\0.csv"])
def test_measured_responses_of_no_file(path):
    refused(lambda: fx.read_frf(path), "path")


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"delay_samples": True}, "delay_samples"),
        ({"seed": True}, "seed"),
        ({"noise": np.ones((1, 2))}, "noise"),
        ({"saturate": {"drive:1": np.ones((1, 2))}}, "saturate"),
        ({"quantise": np.ones((1, 2))}, "quantise"),
    ],
)
def test_settings_of_samples_that_are_none(given, key):
    study = fx.preset("nano-hexapod")
    refused(lambda: fx.simulate(study, controller=control.IFF(50.0), sample=2e-4, **given), key)


def test_samples_that_no_step_could_end_on():
    with pytest.raises(fx.InputError, match="shorter than steps within a tolerance") as error:
        fx.simulate(fx.preset("nano-hexapod"), controller=control.IFF(50.0), sample=1e-9, duration=0.001)
    assert error.value.key == "sample"


@pytest.mark.parametrize("given", ["x", None, [1j], [1.0, 2.0], [NAN]])
def test_functions_that_return_no_numbers(given):
    """Some once ended in an error of the conversion."""
    asked = control.FunctionController(function=lambda t, y: given, inputs=("stroke:1",), outputs=("drive:1",))
    with pytest.raises(fx.InputError, match="at t = 0 s") as error:
        fx.simulate(fx.preset("nano-hexapod"), controller=asked, sample=2e-4, duration=0.001)
    assert error.value.key == "controller" and error.value.allowed == "1 finite numbers"


@pytest.mark.parametrize("given", ["3e-4", "1 kg", [1.0]])
def test_what_is_no_time_and_no_rate(system, given):
    with pytest.raises(fx.InputError) as error:
        system.sampled(given)
    assert error.value.key == "sample" and "5 kHz" in error.value.allowed and "0.2 ms" in error.value.allowed


def test_a_loop_that_grows_without_end_is_named_as_a_cause():
    with pytest.raises(fx.ComputationError, match="t = ") as error:
        fx.simulate(
            fx.preset("nano-hexapod"), controller=control.DVF(1e12), sample=2e-4, duration=0.004, output_step=0.002
        )
    assert "reduce gain or delay" in (error.value.next_step or "")


def test_matrices_do_not_have_the_loop_of_the_study(tmp_path):
    text = fx.preset("nano-hexapod").source_text + '\n[control]\nlaw = "iff"\ngain = 50\nsample = "0.2 ms"\n'
    made = fx.export(fx.loads(text), "mat", tmp_path / "a.npz", inputs="wrench", outputs="tool")
    assert "[control]: the loop of a controller" in made.left_out


def test_names_and_flags_of_linear_models():
    study = fx.preset("nano-hexapod")
    refused(lambda: fx.linearize(study, inputs="drive", outputs="tool", drives=np.ones((1, 2))), "drives")
    refused(lambda: fx.transmissibility(study, [1.0], tilt="no"), "tilt")


def test_paths_with_blanks_and_letters_of_all_kinds(system, tmp_path):
    place = system.save(tmp_path / "Größe und Ärger.npz")
    assert place == Path(tmp_path / "Größe und Ärger.npz") and place.stat().st_size


@pytest.mark.parametrize(
    ("draw", "key"),
    [
        (lambda x, _: fx.plot.bode(x.frequency_response([1.0, 2.0]), 3), "inputs"),
        (lambda x, _: fx.plot.pole_map(x.damp(), "x"), "below"),
        (lambda x, _: fx.plot.pole_map(x.damp(), np.inf), "below"),
        (lambda x, _: fx.plot.transmissibility({"a": None}), "transmissibility"),
        (lambda x, psd: fx.plot.cumulative(x.psd(psd), []), "outputs"),
        (lambda x, psd: fx.plot.cumulative({"a": x.psd(psd), "b": x.psd(psd, [])}), "outputs"),
    ],
)
def test_figures_of_what_is_not_there(system, draw, key):
    refused(lambda: draw(system, {"drive": ([1.0, 2.0], [1.0, 1.0])}), key)


@pytest.mark.parametrize("rate", [1e300, "x"])
def test_hubs_that_turn_faster_than_every_machine(rate):
    study = fx.preset("paper-actuator")
    refused(lambda: fx.linearize(study, {"rate": rate}, inputs="force:tip", outputs="tip"), "pose.rate")


def test_a_system_that_is_at_its_end_needs_no_time(double):
    refused(lambda: fx.time_optimal(double, end=0.0), "end")


def by_matrices(A, B, C, D):
    n = len(A)
    return control.StateSpace(
        A=A, B=np.reshape(B, (n, -1)), C=np.reshape(C, (-1, n)), D=D, inputs=("drive:1",), outputs=("stroke:1",),
        states=tuple(f"x{i}" for i in range(n)), units={},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda swings, sums: control.margins(swings, control.PID(1.0), delay=0.1), "a pole lies there"),
        (lambda swings, sums: control.integrator(1.0).at([0.0]), "a pole lies there"),
        (lambda swings, sums: sums.reduce(0), "no static response"),
        (lambda swings, sums: control.by_modes(sums), "not told apart"),
    ],
)
def test_poles_that_matrices_cannot_be_divided_at(call, words):
    """An undamped mode, three integrators in a row: once errors of linear algebra."""
    swings = by_matrices([[0.0, 1.0], [-4.0, 0.0]], [0.0, 1.0], [1.0, 0.0], [[0.0]])
    sums = by_matrices(np.eye(3, k=1), [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [[0.0]])
    with pytest.raises(fx.ComputationError, match=words):
        call(swings, sums)


def test_systems_without_channels_are_none_of_other_programs(system):
    refused(lambda: system.select([], []).to_control(), "system")


def test_rest_has_no_place_on_an_axis_of_logarithms(system):
    refused(lambda: fx.plot.bode(system.frequency_response([0.0])), "frequency")
    data = fx.compliance(fx.preset("small-hexapod"), [0.0])
    refused(lambda: fx.plot.transmissibility(data), "frequency")
