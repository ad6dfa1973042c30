"""Spectra, histories and files of linear systems against `flexapod.vibration`, closed forms and what readers give."""

from pathlib import Path

import numpy as np
import pytest

import flexapod as fx
import flexapod.control as fc
from flexapod.common.errors import InputError
from flexapod.model import Disturbance
from flexapod.model.study.disturbance import Floor, Spectrum
from flexapod.solve.linear.random_vibration import LinearRobot, random_vibration, sources_of

pytestmark = pytest.mark.consistency

TWIST = ("x", "y", "z", "rx", "ry", "rz")


def both(seed=2, modes=9):
    """The same modes as a robot's linear model and as a state space."""
    rng = np.random.default_rng(seed)
    omega = 2 * np.pi * np.geomspace(8, 400, modes)
    full = rng.standard_normal((modes, modes))
    damping = np.diag(0.04 / omega) + 1e-5 * full @ full.T / modes
    tool = 1e-4 * rng.standard_normal((6, modes))
    inputs = {
        "floor": 1e-3 * rng.standard_normal((modes, 3)),
        "wrench": tool.T,
        "drive": 1e-4 * rng.standard_normal((modes, 4)),
    }
    robot = LinearRobot(omega=omega, damping=damping, tool=tool, inputs=inputs)
    given = np.hstack([inputs["floor"], inputs["wrench"], inputs["drive"]])
    W = np.diag(omega**2)
    names = (*(f"floor:{a}" for a in "xyz"), *(f"wrench:{a}" for a in TWIST), *(f"drive:{i}" for i in range(1, 5)))
    space = fc.StateSpace(
        A=np.block([[np.zeros((modes, modes)), np.eye(modes)], [-W, -W @ damping]]),
        B=np.vstack([np.zeros((modes, 13)), W @ given]),
        C=np.hstack([tool, np.zeros((6, modes))]),
        D=np.zeros((6, 13)),
        inputs=names,
        outputs=tuple(f"tool:{a}" for a in TWIST),
        states=tuple(f"x{i}" for i in range(2 * modes)),
        units=dict.fromkeys(names, "N"),
    )
    return robot, space


def disturbance():
    f = np.array([2.0, 30.0, 200.0])
    return Disturbance(
        floor=Floor.by_curve("VC-C"),
        wrench=Spectrum(frequency=f, density=np.outer([1e-4, 1e-5, 0.0], np.arange(1, 7))),
        force_noise=Spectrum(frequency=f, density=np.array([[1e-3], [1e-3], [1e-6]])),
    )


def test_spectra_equal_those_of_a_robots_vibration():
    robot, space = both()
    given = disturbance()
    sources = sources_of(given, robot)
    exact, data = random_vibration(robot, sources, refine=2), space.psd(given)
    # The same integral through eigenvalues of other matrices: panels may differ in their last bits, responses by 1e-10.
    np.testing.assert_allclose(data.rms, exact.rms, rtol=1e-9)
    np.testing.assert_allclose(data.psd, exact.psd, rtol=1e-7)
    np.testing.assert_allclose(data.covariance, exact.covariance, rtol=1e-8, atol=1e-12 * exact.covariance.max())
    np.testing.assert_allclose(data.cumulative_rms[0], exact.rms, rtol=1e-9)
    assert data.attrs["estimated_error"] < 1e-5
    each = space.by_source(given)
    assert list(each.source.values) == [source.name for source in sources]
    np.testing.assert_allclose(each.rms_by_source, exact.by_source, rtol=1e-9)
    one = space.psd({"wrench:x": (given.wrench.frequency, given.wrench.density[:, 0])}, "tool:z")
    alone = Disturbance(wrench=Spectrum(frequency=given.wrench.frequency, density=given.wrench.density * np.eye(6)[0]))
    np.testing.assert_allclose(one.rms, random_vibration(robot, sources_of(alone, robot)).rms[2], rtol=1e-5)


def test_tables_of_many_rows_shake_fewer_outputs_than_inputs():
    # Responses are then polynomials of their own panels: as many numbers as outputs times inputs.
    robot, space = both()
    f = np.geomspace(2.0, 200.0, 4000)
    wrench = Spectrum(frequency=f, density=np.outer(1e-4 / f, np.arange(1, 7)))
    found = space.psd({"wrench": (f, wrench.density)}, "tool:z")
    sources = sources_of(Disturbance(wrench=wrench), robot)
    np.testing.assert_allclose(found.rms, random_vibration(robot, sources, refine=2).rms[2], rtol=1e-8)


def mode(m=2.0, k=5e3, c=4.0):
    return fc.StateSpace(
        A=[[0, 1], [-k / m, -c / m]], B=[[0, 0], [1 / m, -1]], C=[[1, 0], [-k / m, -c / m]], D=[[0, 0], [1 / m, 0]],
        inputs=("force:z", "floor:z"), outputs=("tool:z", "accelerometer:z"), states=("z", "z rate"),
        units={"force:z": "N", "floor:z": "m s-2", "tool:z": "m", "accelerometer:z": "m s-2"},
    )  # fmt: skip


def test_white_force_and_acceleration_shake_one_mode_as_miles_says():
    m, k, c, S = 2.0, 5e3, 4.0, 1e-3
    wide = np.array([1e-3, 1e5])
    flat = np.full(2, S)
    data = mode().psd({"force": (wide, flat)}, "tool")
    # S / (4 k c) of a one-sided density; the band leaves out less than 1e-6 of it.
    np.testing.assert_allclose(data.rms**2, S / (4 * k * c), rtol=1e-5)
    data = mode().psd({"floor": (wide, flat)}, "tool")
    np.testing.assert_allclose(data.rms**2, S * m**2 / (4 * k * c), rtol=1e-5)


def test_sources_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match="has 3 columns"):
        mode().psd({"force": (np.array([1.0, 2.0]), np.ones((2, 3)))})
    with pytest.raises(InputError, match="Did you mean 'floor'"):
        mode().psd({"flor": (np.array([1.0, 2.0]), np.ones(2))})
    with pytest.raises(InputError, match="nothing shakes"):
        mode().psd({})


def test_steps_and_impulses_are_exact():
    m, k, c = 2.0, 5e3, 4.0
    step, impulse = mode().step(2.0, 1e-3), mode().impulse()
    w, zeta = np.sqrt(k / m), c / (2 * np.sqrt(k * m))
    wd = w * np.sqrt(1 - zeta**2)
    t = step.time.values
    assert t[-1] == pytest.approx(2.0)
    z = (1 - np.exp(-zeta * w * t) * (np.cos(wd * t) + zeta * w / wd * np.sin(wd * t))) / k
    found = step.step_response.sel(output="tool:z", input="force:z")
    np.testing.assert_allclose(found, z, atol=1e-10 / k)  # 2000 steps of a recurrence
    assert step.step_response.sel(output="accelerometer:z", input="force:z")[0] == 1 / m
    t = impulse.time.values
    assert t[-1] == pytest.approx(5 / (zeta * w), rel=0.01)
    exact = np.exp(-zeta * w * t) * np.sin(wd * t) / (m * wd)
    np.testing.assert_allclose(impulse.impulse_response[0, 0], exact, atol=1e-10 / (m * wd))


def read_back(path: Path) -> dict[str, object]:
    """A reader of the three formats that knows nothing of the writer."""
    if path.suffix == ".mat":
        from scipy.io import loadmat

        data = loadmat(path, squeeze_me=False)
        texts = ("inputs", "outputs", "states", "input_units", "output_units")
        found = {name: [str(cell[0]) for cell in data[name].ravel()] for name in texts}
        return found | {name: data[name] for name in "ABCD"} | {"sample": float(data["sample"].item())}
    if path.suffix == ".npz":
        with np.load(path) as data:
            return {name: data[name].tolist() if data[name].dtype.kind == "U" else data[name] for name in data}
    import netCDF4

    with netCDF4.Dataset(path) as data:
        names = {"inputs": "input", "outputs": "output", "states": "state"}
        names |= {name: name for name in ("input_units", "output_units", *"ABCD")}
        found = {name: data[of][:] for name, of in names.items()}
        return {n: list(x) if x.dtype.kind in "OU" or x.dtype is str else x for n, x in found.items()} | {
            "sample": data.sample
        }


@pytest.mark.parametrize("ending", [".mat", ".npz", ".nc"])
@pytest.mark.parametrize("sample", [None, 2e-4])
def test_files_keep_matrices_names_and_units(tmp_path, ending, sample):
    system = mode() if sample is None else mode().sampled(sample)
    path = system.save(tmp_path / f"robot{ending}")
    found = read_back(path)
    for name in "ABCD":
        np.testing.assert_array_equal(found[name], getattr(system, name))
    for name in ("inputs", "outputs", "states"):
        assert tuple(found[name]) == getattr(system, name)
    assert found["input_units"] == ["N", "m s-2"] and found["output_units"] == ["m", "m s-2"]
    assert float(found["sample"]) == (sample or 0.0)


def test_other_endings_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"Allowed: \.mat, \.npz, \.json, \.nc"):
        mode().save(tmp_path / "robot.csv")


def test_python_control_has_the_same_system():
    control = pytest.importorskip("control")
    system = mode()
    other = system.to_control()
    assert isinstance(other, control.StateSpace)
    assert other.input_labels == list(system.inputs) and other.state_labels == list(system.states)
    np.testing.assert_allclose(np.sort_complex(other.poles()), np.sort_complex(system.poles()), rtol=1e-12)
    hz = np.geomspace(0.1, 100, 20)
    np.testing.assert_allclose(other(2j * np.pi * hz), system.at(hz), rtol=1e-9)


def test_without_python_control_words_say_what_to_install(monkeypatch):
    import sys

    from flexapod.common.errors import ComputationError

    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(ComputationError, match="pip install"):
        mode().to_control()


@pytest.mark.parametrize("name", ["machine-hexapod", "nano-hexapod"])
def test_spectra_of_a_robot_equal_its_vibration(name):
    study = fx.preset(name)
    f = np.array([2.0, 300.0])
    wrench = Spectrum(frequency=f, density=np.outer([1e-4, 1e-5], np.arange(1, 7)))
    study = study.replace(disturbance=Disturbance(floor=Floor.by_curve("VC-A"), wrench=wrench))
    exact = fx.vibration(study)
    model = fx.linearize(study, inputs=["floor", "wrench"], outputs="tool")
    data, each = model.psd(study.disturbance), model.by_source(study.disturbance)
    # The same panels; modes there, states here: responses to 1e-9.
    np.testing.assert_allclose(data.rms, exact.vibration_rms, rtol=1e-8)
    np.testing.assert_allclose(data.covariance, exact.vibration_covariance, atol=1e-8 * data.covariance.max().item())
    largest = exact.vibration_rms.values
    np.testing.assert_allclose(each.rms_by_source / largest, exact.vibration_by_source / largest, atol=1e-8)
