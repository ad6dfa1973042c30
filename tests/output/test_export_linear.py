"""Linear models as files of matrices, and their responses as universal files, read by other readers."""

import numpy as np
import pytest
import pyuff
import xarray as xr
from scipy.io import loadmat

import flexapod as fx
from flexapod.model import override
from flexapod.output.exchange.formats import uff

pytestmark = pytest.mark.consistency

STUDY = override(fx.preset("tripod"), modes=1)
CHANNELS = {"inputs": ["wrench", "command"], "outputs": ["tool", "stroke:2"]}


def names_of(values):
    return [str(np.ravel(x)[0]) for x in np.ravel(values)]


@pytest.fixture(scope="module")
def model():
    return fx.linearize(STUDY, **CHANNELS)


def test_matrices_names_and_units_survive_every_format(model, tmp_path):
    """MATLAB's, NumPy's and NetCDF's own readers; numbers to the bit."""
    for ending in (".mat", ".npz", ".nc"):
        found = fx.export(STUDY, "mat", tmp_path / f"robot{ending}", **CHANNELS)
        if ending == ".mat":
            read = loadmat(found.path)
        elif ending == ".npz":
            read = dict(np.load(found.path))
        else:
            with xr.open_dataset(found.path) as data:
                read = {name: data[name].values for name in "ABCD"}
                read |= {"inputs": data.input.values, "outputs": data.output.values, "states": data.state.values}
                read["output_units"] = data.output_units.values
        for name in "ABCD":
            assert np.array_equal(read[name], getattr(model, name)), (ending, name)
        assert names_of(read["inputs"]) == list(model.inputs), ending
        assert names_of(read["outputs"]) == ["tool:x", "tool:y", "tool:z", "tool:rx", "tool:ry", "tool:rz", "stroke:2"]
        assert names_of(read["output_units"])[-1] == "m"
        assert str(tmp_path).encode() not in found.path.read_bytes()
    assert found.left_out


def test_without_names_all_of_the_robots_own_are_written(tmp_path):
    read = dict(np.load(fx.export(STUDY, "mat", tmp_path / "robot.npz").path))
    groups = {str(name).split(":")[0] for name in (*read["inputs"], *read["outputs"])}
    assert groups == {"wrench", "command", "floor", "tool", "stroke", "drive-force"}
    with pytest.raises(fx.InputError, match="wrench"):
        fx.export(STUDY, "mat", tmp_path / "a.npz", inputs=["wrnch"])


def records(text):
    """Datasets of a universal file by the columns of its definition: headers, abscissae, complex ordinates."""
    found = []
    for block in text.split("    -1\n    58\n")[1:]:
        lines = block.split("    -1\n")[0].splitlines()
        kind, count, even = (int(lines[6][k : k + 10]) for k in (0, 10, 20))
        start, step = float(lines[6][30:43]), float(lines[6][43:56])
        rows = "".join(lines[11:]) if even else "".join(line[13:] for line in lines[11:])
        numbers = np.array([float(rows[k : k + 20]) for k in range(0, len(rows), 20)]).reshape(-1, 2)
        at = start + step * np.arange(count) if even else np.array([float(line[:13]) for line in lines[11:]])
        assert kind == 6 and len(numbers) == count and int(lines[5][:5]) == 4
        found.append((lines, at, numbers @ [1, 1j]))
    return found


@pytest.mark.parametrize(("hz", "even"), [(np.linspace(5, 200, 40), 1), (np.geomspace(1, 1000, 31), 0)])
def test_responses_are_datasets_58(model, hz, even):
    """Columns as the format defines them: ordinates to 13 digits, frequencies to 6."""
    data = model.frequency_response(hz)
    found = records(uff(data))
    values = data.frequency_response.values @ [1, 1j]
    assert len(found) == len(model.inputs) * len(model.outputs)
    for k, (lines, at, response) in enumerate(found):
        i, j = divmod(k, len(model.inputs))
        assert lines[0] == f"{model.outputs[i]} / {model.inputs[j]}"
        assert int(lines[6][20:30]) == even
        assert at == pytest.approx(hz, rel=1e-5)
        assert response == pytest.approx(values[i, j], rel=2e-12)
    tool_z = next(lines for lines, _, _ in found if lines[0] == "tool:z / wrench:fx")
    assert tool_z[5].split() == ["4", "0", "0", "0", "tool", "1", "3", "wrench", "1", "1"]
    assert tool_z[8].split() == ["8", "0", "0", "0", "tool:z", "m"] and tool_z[9].split()[0] == "13"
    stroke = next(lines for lines, _, _ in found if lines[0] == "stroke:2 / command:3")
    assert stroke[5].split() == ["4", "0", "0", "0", "stroke", "2", "0", "command", "3", "0"]


def test_pyuff_reads_them(model, tmp_path):
    data = model.frequency_response(np.linspace(5, 200, 40))
    path = tmp_path / "robot.uff"
    path.write_text(uff(data), encoding="ascii")
    sets = pyuff.UFF(str(path)).read_sets()
    assert len(sets) == len(model.inputs) * len(model.outputs)
    values = data.frequency_response.values @ [1, 1j]
    for k, one in enumerate(sets):
        i, j = divmod(k, len(model.inputs))
        assert one["type"] == 58 and one["func_type"] == 4 and one["id1"].strip().startswith(model.outputs[i])
        assert one["x"] == pytest.approx(np.linspace(5, 200, 40), rel=1e-5)
        assert one["data"] == pytest.approx(values[i, j], rel=2e-12)


def test_read_frf_has_them_back(model, tmp_path):
    """By the package's own reader of measurements: names, units, numbers."""
    data = model.frequency_response(np.linspace(5, 200, 40))
    path = tmp_path / "robot.uff"
    path.write_text(uff(data), encoding="ascii")
    read = fx.read_frf(path).sel(output=data.output.values, input=data.input.values)
    assert read.output_units.values.tolist() == data.output_units.values.tolist()
    assert read.input_units.values.tolist() == data.input_units.values.tolist()
    ours, theirs = (x.frequency_response.transpose("output", "input", "frequency", "part").values for x in (data, read))
    assert theirs == pytest.approx(ours, rel=1e-11, abs=1e-12 * np.abs(ours).max())


def test_other_results_are_no_responses():
    with pytest.raises(fx.InputError, match="no response over frequency"):
        uff(fx.stiffness(STUDY))
