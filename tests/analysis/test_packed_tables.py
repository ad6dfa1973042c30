"""Results hold the whole study: tables of files and arrays of Python come back to the bit, whatever lies around."""

import io
import os
import pickle
import shutil
import zipfile

import numpy as np
import pytest
from xarray import Dataset

import flexapod as fx
from flexapod.analysis import open_results, save
from flexapod.analysis.results.attributes import FORMER, TABLES, attributes, result_study, robot_of
from flexapod.analysis.results.packed_tables import pack, unpack
from flexapod.app.browser.document import Document, read
from flexapod.app.browser.header import open_source
from flexapod.app.browser.uploads import read_upload, store_table, study_download
from flexapod.common.tables.named_files import Stored
from flexapod.common.tables.reference import reference
from flexapod.common.tables.toml import toml_text
from flexapod.model.file.key_trials import study_data
from flexapod.model.stored_tables import stored_tables
from flexapod.model.study.mount import BaseMotion

pytestmark = pytest.mark.contract

EXAMPLES = {
    f"{entry.table} {entry.title}".strip(): text
    for entry in reference().entries
    if any(file in (text := toml_text(study_data(entry))) for file in reference().files)
}
T = np.linspace(0.0, 0.02, 41)
U = T / T[-1]


@pytest.fixture
def empty(tmp_path, monkeypatch):
    """The folder in which a test runs; nothing lies in it, and nothing that was known is remembered."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("flexapod.analysis.results.attributes._known", {})
    monkeypatch.setattr("flexapod.analysis.results.attributes._latest", [])
    return tmp_path


def arrays_of(study):
    """All arrays of a study with their bits, wherever they are."""
    found, waiting = {}, [("", study)]
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, np.ndarray):
            found[path] = (value.shape, value.tobytes())
        elif isinstance(value, tuple):
            waiting += [(f"{path}[{i}]", item) for i, item in enumerate(value)]
        elif hasattr(type(value), "model_fields"):
            waiting += [(f"{path}.{name}", getattr(value, name)) for name in type(value).model_fields]
    return found


def moved(heave=1e-3, **changes):
    """A study of 20 ms whose motion is given in Python."""
    pose = np.zeros((len(T), 6))
    pose[:, 2] = heave * (10 * U**3 - 15 * U**4 + 6 * U**5)
    study = fx.model.override(fx.preset("paper-robot"), fidelity="lumped", duration=0.03)
    return study.replace(motion=fx.model.CsvMotion(time=T, pose=pose), **changes)


def foreign(name=FORMER, heave=5e-3):
    """A table that lies around and has nothing to do with anything."""
    columns = np.column_stack([T, 1e3 * heave * (10 * U**3 - 15 * U**4 + 6 * U**5)])
    rows = [f"{t!r},{h!r}" for t, h in columns.tolist()]
    with open(name, "w") as file:
        file.write("\n".join(["time [s], heave [mm]", *rows]) + "\n")


@pytest.mark.parametrize("title", EXAMPLES)
def test_every_table_that_a_file_may_hold_comes_back(title, empty):
    """In an empty folder, and where other tables have their names."""
    home, text = empty / "home", EXAMPLES[title]
    home.mkdir()
    for file, content in reference().files.items():
        (home / file).write_text(content)
    study = fx.loads(text, path=home / "study.toml")
    digest = attributes(study)["study_hash"]
    save(Dataset(attrs=attributes(study)), "results.nc")
    shutil.rmtree(home)
    for name in (*reference().files, FORMER):
        foreign(name)
    again = fx.load("results.nc")
    assert arrays_of(again) == arrays_of(study)
    assert attributes(again)["study_hash"] == digest
    assert again.source_text == text
    data = open_results("results.nc")
    assert arrays_of(result_study(data)) == arrays_of(study)
    if isinstance(study, fx.Study):
        assert arrays_of(robot_of(data)) == arrays_of(study.robot)


def test_arrays_from_python_are_those_of_the_result_and_no_text_names_a_file(empty):
    """It was 18.55 um for 19.76 um where another table lay there; the other one moves five times as far here."""
    study = moved()
    data = fx.simulate(study)
    save(data, "results.nc")
    foreign()
    assert ".csv" not in study.source_text
    with pytest.raises(fx.InputError, match="was given in Python"):
        fx.loads(study.source_text)
    again = fx.load("results.nc")
    assert again.motion.file is None
    assert ".csv" not in again.replace(initial=fx.model.Initial(start="straight")).source_text
    assert arrays_of(again) == arrays_of(study)
    repeated = fx.simulate(again)
    assert repeated.attrs["study_hash"] == data.attrs["study_hash"]
    np.testing.assert_array_equal(repeated.tool_deviation, data.tool_deviation)
    way = repeated.com_position_rigid.sel(axis="z")
    assert float(way[-1] - way[0]) == pytest.approx(1e-3)  # and not the 5 mm of the other one


@pytest.mark.parametrize("kind", ["wrench", "base", "heat", "floor", "noise", "law", "drives"])
def test_tables_of_every_part_may_come_from_python(kind, empty):
    """What is read of a file may be given as arrays, without a name."""
    study, f = fx.preset("paper-robot"), np.array([1.0, 10.0, 100.0])
    robot, wave = study.robot, np.outer(np.sin(40 * T), np.ones(6))
    leg, force = robot.legs[0], fx.model.ForceDrive(law="csv", time=T, force=np.sin(T))
    pushed = leg.replace(drive=fx.model.ForceDrive(law="csv", time=T, force=np.cos(T)))  # one object, two legs
    changes = {
        "wrench": lambda: {"load": fx.model.Load(wrench=fx.model.CsvWrench(time=T, wrench=wave))},
        "base": lambda: {"robot": robot.replace(base_motion=BaseMotion(time=T, values=wave))},
        "heat": lambda: {
            "robot": robot.replace(heat=fx.model.Heat(time=T, columns=("base", "piston 3"), table=20 + wave[:, :2]))
        },
        "floor": lambda: {
            "disturbance": fx.model.Disturbance(floor=fx.model.Floor(frequency=f, density=np.ones((3, 3)) / 3))
        },
        "noise": lambda: {
            "disturbance": fx.model.Disturbance(
                force_noise=fx.model.Spectrum(frequency=f, density=np.ones((3, 6)) / 7),
                wrench=fx.model.Spectrum(frequency=f, density=np.ones((3, 6)) / 3),
            )
        },
        "law": lambda: {},
        "drives": lambda: {"robot": robot.replace(legs=(leg.replace(drive=force), *(leg,) * 3, *[pushed] * 2))},
    }
    if kind == "law":
        law = fx.model.CsvLaw(time=T, value=np.sin(T))
        beam = fx.preset("paper-actuator")
        study = beam.replace(motion=beam.motion.replace(rotation=law))
    else:
        study = study.replace(**changes[kind]())
    assert ".csv" not in study.source_text
    for name in (FORMER, "None", "motion.csv"):
        foreign(name)
    with pytest.raises(fx.InputError, match="was given in Python"):
        fx.loads(study.source_text)
    save(Dataset(attrs=attributes(study)), "results.nc")
    again = fx.load("results.nc")
    assert arrays_of(again) == arrays_of(study)
    assert attributes(again)["study_hash"] == attributes(study)["study_hash"]


def test_a_table_that_is_changed_is_not_the_file_any_more(empty):
    foreign("path.csv")
    head = fx.preset("paper-robot").source_text.split("[motion]")[0]
    study = fx.loads(f'{head}[motion]\ntype = "csv"\nfile = "path.csv"\n')
    other = study.replace(motion=study.motion.replace(pose=study.motion.pose / 2))
    assert other.motion.file is None
    assert "path.csv" not in other.source_text
    assert 'file = "path.csv"' in study.replace(motion=study.motion.replace(hold=1.0)).source_text


def test_eleven_megabytes_of_csv_take_four(empty):
    """The least favourable numbers: noise, where each digit is news; 11.6 digits of a cell are 38.5 bits, so that 1
    letter of 8 bits is at least 3.5 bits: 11 MB at least 4.3 MB as deflated text."""
    rng = np.random.default_rng(31)
    rows = 112_000
    table = rng.standard_normal((rows, 6)) * 1e-3
    lines = (f"{1e-4 * i:.4f}," + ",".join(f"{x:.12f}" for x in row) for i, row in enumerate(table.tolist()))
    with open("path.csv", "w") as file:
        file.write("time [s],surge [mm],sway [mm],heave [mm],roll [deg],pitch [deg],yaw [deg]\n")
        file.writelines(f"{line}\n" for line in lines)
    assert os.path.getsize("path.csv") > 11e6
    head = fx.preset("paper-robot").source_text.split("[motion]")[0]
    study = fx.loads(f'{head}[motion]\ntype = "csv"\nfile = "path.csv"\n')
    save(Dataset(attrs=attributes(study)), "results.nc")
    os.remove("path.csv")
    assert os.path.getsize("results.nc") < 4e6
    assert arrays_of(fx.load("results.nc")) == arrays_of(study)


def test_numbers_of_any_kind_come_back_to_the_bit():
    """Zeros of both signs, the ends of the range, what was written in another unit, a column of one number."""
    rng = np.random.default_rng(0)
    odd = np.array([0.0, -0.0, 5e-324, -5e-324, 1.7976931348623157e308, -1e-308, 0.1, 1 / 3, -1e22, 2.0**53 + 2])
    columns = {
        "odd": odd, "whole": np.arange(-500.0, 500.0), "one": np.array([0.1]), "none": np.zeros(0),
        "mm": np.round(rng.standard_normal(999), 4) * 1e-3, "deg": np.round(rng.standard_normal(999), 3) * np.pi / 180,
        "bits": rng.integers(-(2**62), 2**62, 500).view(np.float64), "mixed": np.append(np.round(odd[:1], 3), 1e-30),
    }  # fmt: skip
    stored = {"a.file": Stored("", {name: ("length", values) for name, values in columns.items()})}
    found = unpack(pack(stored))["a.file"].content
    assert list(found) == list(columns)
    for name, values in columns.items():
        assert found[name][1].tobytes() == values.tobytes(), name


@pytest.mark.parametrize("spoil", ["cut", "turned", "bomb", "another", "number"])
def test_tables_that_are_spoilt_are_refused(spoil, empty):
    study = moved()
    packed = attributes(study)[TABLES].copy()
    if spoil == "turned":
        packed[len(packed) // 2 :] ^= 255
    made = {
        "cut": packed[: len(packed) // 2],
        "turned": packed,
        "bomb": np.frombuffer(packed.tobytes()[:18] + (2**62).to_bytes(8, "little") + bytes(100), np.uint8),
        "another": np.frombuffer(b"something else", np.uint8),
        "number": 3.0,
    }[spoil]
    save(Dataset(attrs=attributes(study) | {TABLES: made}), "results.nc")
    with pytest.raises(fx.InputError, match="study_tables: are not the tables"):
        fx.load("results.nc")


def test_former_results_name_the_table_that_is_missing(empty):
    """They held none: it is looked for where it was, and another one in place of that from Python is refused."""
    foreign("path.csv")
    head = fx.preset("paper-robot").source_text.split("[motion]")[0]
    study = fx.loads(f'{head}[motion]\ntype = "csv"\nfile = "path.csv"\n')
    former = {name: value for name, value in attributes(study).items() if name != TABLES}
    save(Dataset(attrs=former), "results.nc")
    assert arrays_of(fx.load("results.nc")) == arrays_of(study)
    os.remove("path.csv")
    with pytest.raises(fx.InputError, match=r"motion\.file = 'path\.csv': cannot be read"):
        fx.load("results.nc")
    from_python = attributes(moved())
    text = from_python["study"].replace('file = ""', f'file = "{FORMER}"')
    save(Dataset(attrs={k: v for k, v in from_python.items() if k != TABLES} | {"study": text}), "python.nc")
    with pytest.raises(fx.InputError, match=r"motion\.file = 'table\.csv': cannot be read"):
        fx.load("python.nc")
    foreign()
    with pytest.raises(fx.InputError, match=r"motion\.file = 'table\.csv': is not the table of this result"):
        fx.load("python.nc")
    with open(FORMER, "w") as file:
        rows = np.column_stack([moved().motion.time, moved().motion.pose]).tolist()
        file.write("time [s],surge [m],sway [m],heave [m],roll [rad],pitch [rad],yaw [rad]\n")
        file.writelines(",".join(map(repr, row)) + "\n" for row in rows)
    np.testing.assert_array_equal(fx.load("python.nc").motion.pose, moved().motion.pose)


def test_sweeps_vary_arrays_from_python_and_their_stores_hold_them(empty):
    foreign()
    study = moved()
    vary = {"vary": [{"key": "payload.mass", "values": ["90 kg", "110 kg"]}]}
    data = fx.sweep(study, vary, store="sweep.zarr", workers=0)
    again = fx.load("sweep.sqlite")
    assert arrays_of(again) == arrays_of(fx.load("sweep.zarr")) == arrays_of(study)
    assert attributes(again)["study_hash"] == data.attrs["study_hash"]
    light = study.replace(robot=study.robot.replace(payload=study.robot.payload.replace(mass=90.0)))
    name = "com_deviation_peak"
    alone = np.linalg.norm(fx.simulate(light).com_deviation, axis=1).max()
    assert float(data[name][0]) == pytest.approx(alone, rel=1e-9)  # the same instants, another order of summing
    held = pickle.loads(pickle.dumps(again)).replace(initial=study.initial)
    np.testing.assert_array_equal(fx.sweep(held, vary, workers=0)[name], data[name])


def test_the_page_opens_results_with_their_tables(empty):
    study = moved()
    save(fx.run(study), "results.nc")
    foreign()
    source = open_source(empty / "results.nc")
    assert arrays_of(source.study) == arrays_of(study)
    assert "tables" not in " ".join(source.study.notes)


@pytest.mark.parametrize("title", EXAMPLES)
def test_a_study_is_taken_from_the_page_with_its_tables_and_sent_again(title, empty):
    """What one page gives another one takes: the same study, whatever its tables were called and wherever they lay."""
    home, sent = empty / "there", empty / "sent"
    home.mkdir()
    sent.mkdir()
    text = EXAMPLES[title]
    for file, content in reference().files.items():
        (home / f"my {file}").write_text(content)
        text = text.replace(f'"{file}"', f'"../there/my {file}"')
    (home / "study.toml").write_text(text)
    source = open_source(home / "study.toml")
    ending, content = study_download(source.document, source.study)
    assert ending == ".zip"
    with zipfile.ZipFile(io.BytesIO(content)) as files:
        found = {name: files.read(name) for name in files.namelist()}
    for name in found:
        if name != "study.toml":
            assert store_table(name, found[name], sent) == name
    again = read(read_upload("study.toml", found["study.toml"], sent)).study
    assert arrays_of(again) == arrays_of(source.study)
    assert len(found) == 1 + len({table.name for table in stored_tables(source.study).values()})


def test_a_study_with_arrays_from_python_is_taken_along_whole(empty):
    sent = empty / "sent"
    sent.mkdir()
    save(fx.run(moved()), "results.nc")
    source = open_source(empty / "results.nc")
    with zipfile.ZipFile(io.BytesIO(study_download(source.document, source.study)[1])) as files:
        assert files.namelist() == ["study.toml", "motion.csv"]
        store_table("motion.csv", files.read("motion.csv"), sent)
        again = read(read_upload("study.toml", files.read("study.toml"), sent)).study
    assert arrays_of(again) == arrays_of(moved())
    plain = fx.preset("paper-robot")
    assert study_download(Document(plain.source_text, None), plain) == (".toml", plain.source_text.encode())


def test_commands_are_not_written_where_a_table_from_python_would_be_lost(empty):
    wrench = fx.model.CsvWrench(time=T, wrench=np.outer(U, np.ones(6)))
    study = moved(load=fx.model.Load(wrench=wrench))
    with pytest.raises(fx.InputError, match=r"load\.wrench\.file: cannot be written"):
        fx.compensate(study, out="ahead.toml")
    assert not os.path.exists("ahead.toml")
