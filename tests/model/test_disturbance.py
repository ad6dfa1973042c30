"""The table [disturbance]: what it reads, what it refuses."""

import numpy as np
import pytest

import flexapod as fx
from flexapod import model

pytestmark = pytest.mark.unit

TABLES = {
    "floor.csv": "frequency [Hz], x [(um/s^2)^2/Hz], z [(um/s^2)^2/Hz]\n1, 1, 4\n10, 100, 4\n",
    "speed.csv": "frequency [Hz], x [(mm/s)^2/Hz]\n1, 1\n10, 100\n",
    "wrench.csv": "frequency [Hz], Fx [N^2/Hz], Mz [(N m)^2/Hz]\n1, 1, 0.1\n10, 1, 0.1\n",
    "all.csv": "frequency [Hz], force [N^2/Hz]\n1, 1\n10, 1\n",
    "legs.csv": "frequency [Hz], leg 2 [N^2/Hz], leg 5 [N^2/Hz]\n1, 1, 2\n10, 1, 2\n",
    "gap.csv": "frequency [Hz], force [N^2/Hz]\n1, 1\n10, \n",
    "negative.csv": "frequency [Hz], force [N^2/Hz]\n1, 1\n10, -3\n",
    "unsorted.csv": "frequency [Hz], force [N^2/Hz]\n5, 1\n2, 1\n",
    "zero.csv": "frequency [Hz], force [N^2/Hz]\n0, 1\n2, 1\n",
    "single.csv": "frequency [Hz], force [N^2/Hz]\n2, 1\n",
    "both.csv": "frequency [Hz], force [N^2/Hz], leg 1 [N^2/Hz]\n1, 1, 1\n2, 1, 1\n",
    "times.csv": "time [s], force [N^2/Hz]\n0, 1\n2, 1\n",
    "units.csv": "frequency [Hz], force [N]\n1, 1\n2, 1\n",
}


@pytest.fixture
def read(tmp_path):
    for name, text in TABLES.items():
        (tmp_path / name).write_text(text)

    def study(lines: str) -> model.Study:
        file = tmp_path / "study.toml"
        file.write_text(model.preset_text("machine-hexapod") + f"\n[disturbance]\n{lines}\n")
        return fx.load(file)

    return study


def test_the_floor_by_its_class(read):
    found = read('floor = "VC-C"').disturbance
    assert found == read('floor = { curve = "VC-C" }').disturbance
    assert found.floor.of == "velocity" and found.floor.frequency.tolist() == [1.0, 80.0]
    assert found == model.Disturbance(floor=model.Floor.by_curve("VC-C"))


def test_tables_of_all_kinds_in_their_units(read):
    found = read('floor = "floor.csv"\nwrench = "wrench.csv"\nforce_noise = "legs.csv"').disturbance
    assert found.floor.of == "acceleration"
    assert found.floor.density == pytest.approx(1e-12 * np.array([[1.0, 0.0, 4.0], [100.0, 0.0, 4.0]]))
    assert found.wrench.density.tolist() == [[1.0, 0, 0, 0, 0, 0.1]] * 2
    assert found.force_noise.density.tolist() == [[0, 1.0, 0, 0, 2.0, 0]] * 2
    speed = read('floor = { spectrum = "speed.csv", of = "velocity" }\nforce_noise = "all.csv"').disturbance
    assert speed.floor.density[:, 0] == pytest.approx([1e-6, 1e-4])
    assert speed.force_noise.density.tolist() == [[1.0], [1.0]]


def test_a_study_written_and_read_again_is_the_same(read, tmp_path):
    for lines in ('floor = "VC-A"', 'floor = { spectrum = "speed.csv", of = "velocity" }\nforce_noise = "legs.csv"'):
        study = read(lines)
        assert model.loads(model.to_toml(study), path=tmp_path / "again.toml").disturbance == study.disturbance


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ('floor = "VC-X"', ["disturbance.floor.curve", "VC-X", "VC-A, VC-B", "Did you mean"]),
        ('floor = { curve = "VC-A", of = "velocity" }', ["unknown key", "disturbance.floor.of"]),
        ('floor = { spectrum = "speed.csv" }', ["speed.csv", "(mm/s)^2/Hz", "acceleration spectrum"]),
        ('floor = { spectrum = "speed.csv", of = "speed" }', ["floor.of", "acceleration, velocity, displacement"]),
        ('force_noise = "gap.csv"', ["gap.csv", "line 3", "force", "Fill the gap"]),
        ('force_noise = "negative.csv"', ["negative.csv", "-3", "is negative", "0 or more", "decibels"]),
        ('force_noise = "unsorted.csv"', ["unsorted.csv", "frequency[2]", "2", "not above 5 Hz", "Sort the lines"]),
        ('force_noise = "zero.csv"', ["zero.csv", "frequency[1]", "not above 0"]),
        ('force_noise = "single.csv"', ["single.csv", "fewer than two rows"]),
        ('force_noise = "both.csv"', ["force_noise.spectrum", "either of the two"]),
        ('force_noise = "times.csv"', ["times.csv", "time", "frequency"]),
        ('force_noise = "units.csv"', ["units.csv", "force spectrum", "N^2/Hz"]),
        ('force_noise = "none.csv"', ["none.csv", "cannot be read"]),
        ("force_noise = 3", ["disturbance.force_noise", "3", "is not a table"]),
        ("", ["disturbance", "names nothing", "floor, wrench, force_noise"]),
        ('ground = "VC-A"', ["unknown key", "disturbance.ground"]),
    ],
)
def test_what_is_refused(read, lines, words):
    with pytest.raises(fx.InputError) as error:
        read(lines)
    for word in words:
        assert word in str(error.value)


def test_tables_from_python_need_their_columns():
    study = fx.preset("machine-hexapod")
    table = model.Spectrum(frequency=np.array([1.0, 2.0]), density=np.ones((2, 3)))
    with pytest.raises(fx.InputError, match=r"disturbance\.wrench\.density.* 3 columns"):
        study.replace(disturbance=model.Disturbance(wrench=table))
