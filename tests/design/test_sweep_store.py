"""The store of a sweep: continued, refused, locked, whole whatever happens while it is written."""

import os
import sqlite3
import subprocess
import sys
import time
from csv import reader

import numpy as np
import pytest
import xarray as xr
from tests.helpers.sweeps import KEY, diameters, quick, quick_text, start

import flexapod as fx
from flexapod.common import version
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.tables import csv_tables
from flexapod.design.sweeps import SweepStopped, open_sweep, run, store, unstacked, worker
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points
from flexapod.design.sweeps.store import StoredArray, StoreLayout, SweepStore
from flexapod.design.sweeps.worker import compute_batch
from flexapod.model import loads

pytestmark = pytest.mark.unit


@pytest.fixture
def path(tmp_path):
    return tmp_path / "sweep.sqlite"


def sweep(path, count=4, **settings):
    return fx.sweep(quick(), diameters(count), store=path, workers=0, **settings)


def counted(monkeypatch):
    """Points as they are computed."""
    seen = []

    def compute(version, kept, points, studies):
        seen.extend(points)
        return compute_batch(version, kept, points, studies)

    monkeypatch.setattr(worker, "compute_batch", compute)
    return seen


def stopping(monkeypatch, point, error):
    """A batch that raises at a point."""

    def compute(version, kept, points, studies):
        if point in points:
            raise error
        return compute_batch(version, kept, points, studies)

    monkeypatch.setattr(worker, "compute_batch", compute)


def test_what_is_stored(path):
    made = sweep(path)
    assert made.status.values.tolist() == ["computed"] * 4
    assert made[KEY].values == pytest.approx(np.linspace(0.025, 0.03, 4))
    assert (made[KEY].attrs["units"], made.com_deviation_peak.attrs["units"]) == ("m", "m")
    for other in (open_sweep(path), sweep(None)):
        xr.testing.assert_identical(other, made)
    assert os.listdir(path.parent) == ["sweep.sqlite"]
    made.to_netcdf(path.with_suffix(".nc"))
    with xr.open_dataset(path.with_suffix(".nc")) as read:
        assert read[KEY].values.tolist() == made[KEY].values.tolist()
    with sqlite3.connect(path) as plain:  # a row a point: eight bytes a number, four of a checksum
        rows = plain.execute("SELECT point, state, words, scalars FROM points").fetchall()
    plain.close()
    assert [row[:2] for row in rows] == [(point, "computed") for point in range(4)]
    numbers = np.array([np.frombuffer(row[3][:-4], "<f8") for row in rows])
    assert (numbers[:, 0] == made.com_deviation_peak.values).all()
    assert (numbers[:, 1:] == made.com_deviation_peak_by_axis.values).all()


def test_a_finished_sweep_computes_nothing(path, monkeypatch):
    made = sweep(path)
    seen = counted(monkeypatch)
    xr.testing.assert_identical(sweep(path), made)
    assert seen == []


def test_continued_after_ctrl_c(path, monkeypatch):
    whole = sweep(None, 12)
    stopping(monkeypatch, 5, KeyboardInterrupt)
    with pytest.raises(SweepStopped, match=r"stopped after [1-5] of 12 points") as caught:
        sweep(path, 12)
    done = caught.value.dataset.status.values == "computed"
    assert (caught.value.dataset.status.values[~done] == "pending").all()
    assert (np.isnan(caught.value.dataset.com_deviation_peak.values) == ~done).all()
    seen = counted(monkeypatch)
    xr.testing.assert_identical(sweep(path, 12), whole)
    assert seen == np.flatnonzero(~done).tolist()


def test_points_that_are_alike_are_computed_once(path, monkeypatch):
    seen = counted(monkeypatch)
    entry = {"vary": [{"key": KEY, "values": ["27 mm", "30 mm", 0.027, "3 cm"]}]}
    made = fx.sweep(quick(), entry, store=path, workers=0)
    assert seen == [0, 1]
    peak = made.com_deviation_peak.values
    assert (peak[:2] == peak[2:]).all()
    assert peak[0] != peak[1]


def test_failed_points_keep_their_message(path, monkeypatch):
    strokes = {"vary": [{"key": "leg.stroke.max", "values": ["1.05 m", "0.8 m", "-1 m"]}]}
    made = fx.sweep(quick(), strokes, store=path, workers=0)
    assert made.status.values.tolist() == ["computed", "failed", "failed"]
    assert "Leg 3 is longer than its stroke allows: length 0.9176 m, limit 0.8000 m" in made.message.values[1]
    assert "leg.stroke" in made.message.values[2]
    assert np.isnan(made.com_deviation_peak_by_axis.values[1:]).all()
    seen = counted(monkeypatch)
    fx.sweep(quick(), strokes, store=path, workers=0)
    assert seen == []
    again = fx.sweep(quick(), strokes, store=path, workers=0, retry_failed=True)
    assert seen == [1]
    xr.testing.assert_identical(again, made)


def test_a_number_that_is_none_is_a_failure(monkeypatch):
    nothing = worker.ROBOT_SCALARS["com_deviation_peak"]._replace(value=lambda run: np.nan)
    monkeypatch.setitem(worker.ROBOT_SCALARS, "com_deviation_peak", nothing)
    made = sweep(None, 2)
    assert made.message.values.tolist() == ["com_deviation_peak is not finite"] * 2


def test_a_fault_is_the_failure_of_a_point(monkeypatch):
    def fault(*_):
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(worker, "check_path", fault)
    assert "unexpected ZeroDivisionError: by zero (a fault of flexapod)" in sweep(None, 2).message.values[0]


def test_a_simulation_that_stops_early_is_a_failure(tmp_path):
    forces = ", ".join(f"leg {i} [N]" for i in range(1, 7))
    (tmp_path / "none.csv").write_text(f"time [s], {forces}\n0{6 * ', 0'}\n2{6 * ', 0'}\n", encoding="utf-8")
    text = quick_text(('type = "prescribed"', 'type = "force", law = "csv", file = "none.csv"'))
    falling = loads(text + '\n[initial]\nstart = "moving"\n', path=tmp_path / "study.toml")
    made = fx.sweep(falling, {"vary": [{"key": "simulation.duration", "values": ["20 ms", "0.5 s"]}]}, workers=0)
    assert made.status.values.tolist() == ["computed", "failed"]
    assert "the simulation stopped at t = 0.357 s: leg 1 left the range of the model" in made.message.values[1]
    assert np.isnan(made.com_deviation_peak.values[1])


def test_another_study_sweep_or_version_is_refused(path, monkeypatch):
    sweep(path)
    heavier = loads(quick_text(('mass = "100 kg"', 'mass = "101 kg"')))
    with pytest.raises(InputError, match=r"study_hash = .*holds another study.*--out"):
        fx.sweep(heavier, diameters(4), store=path, workers=0)
    with pytest.raises(InputError, match=r"holds another sweep of this study"):
        sweep(path, 5)
    fx.sweep(loads(quick_text() + "\n# a comment\n"), diameters(4), store=path, workers=0)  # no other study
    monkeypatch.setattr(version, "__version__", "9.9")
    with pytest.raises(InputError, match=r"flexapod_version = .*was made by another version.*Allowed: 9.9"):
        sweep(path)


def test_other_sources_are_refused(path, monkeypatch):
    """Changed code under an unchanged version once went on with an old store."""
    sweep(path)
    monkeypatch.setattr(version, "_KINDS", (".py",))
    version.sources.cache_clear()
    with pytest.raises(InputError, match=r"flexapod_sources = .*was made by other sources of flexapod"):
        sweep(path)
    monkeypatch.undo()
    version.sources.cache_clear()
    sweep(path)


def test_what_is_no_store_is_refused_and_left_alone(tmp_path):
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    for place in (tmp_path, tmp_path / "notes.txt"):
        with pytest.raises(InputError, match="is not a store of a sweep"):
            sweep(place)
    assert (tmp_path / "notes.txt").read_text(encoding="utf-8") == "mine"


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_two_sweeps_on_one_store(path):
    """The second is refused; the lock of a process that was killed is no hindrance."""
    code = "import sys, pathlib; from flexapod.design.sweeps.store import store_lock\n"
    code += "with store_lock(pathlib.Path(sys.argv[1])): print('held', flush=True); sys.stdin.read()"
    holder = start("-c", code, path, stdin=-1)
    assert holder.stdout.readline() == "held\n"
    with pytest.raises(ComputationError, match="in use by another sweep"):
        sweep(path)
    holder.kill()
    holder.communicate()
    assert path.with_name("sweep.sqlite.lock").exists()
    assert sweep(path).status.values.tolist() == ["computed"] * 4


def test_a_folder_without_locks_is_refused(path, monkeypatch):
    class None_(sqlite3.Connection):
        def execute(self, *_):
            error = sqlite3.OperationalError("disk I/O error")
            error.sqlite_errorcode = sqlite3.SQLITE_IOERR_LOCK
            raise error

    with monkeypatch.context() as broken:
        broken.setattr(store.sqlite3, "connect", lambda *_, **__: None_(":memory:"))
        with pytest.raises(ComputationError, match=r"cannot be locked \(disk I/O error\)"):
            sweep(path)


def full(monkeypatch, more):
    """A disk that holds so many pages more than what a store has when it is opened."""
    connect = sqlite3.connect

    def limited(*arguments, **settings):
        made = connect(*arguments, **settings)
        (pages,) = made.execute("PRAGMA page_count").fetchone()
        made.execute(f"PRAGMA max_page_count = {pages + more}")
        return made

    monkeypatch.setattr(store.sqlite3, "connect", limited)


RECORDS = {"scalars": ["com_deviation_peak"], "records": ["deviation_by_cause"]}  # two pages a point


@pytest.mark.parametrize("more", range(0, 9, 2))
def test_full_disk(path, monkeypatch, more):
    """Whichever page has no room: what the store says to be computed is, and the next run completes it."""
    whole = sweep_of_records(None)
    with monkeypatch.context() as broken:
        full(broken, 1)
        with pytest.raises(ComputationError, match=r"No space left on device. Make space"):
            sweep_of_records(path)
    assert os.listdir(path.parent) == []
    monkeypatch.setattr(worker, "OFTEN", 0.0)
    monkeypatch.setattr(worker, "SHARE", np.inf)
    with monkeypatch.context() as broken:
        stopping(broken, 2, KeyboardInterrupt)
        with pytest.raises(KeyboardInterrupt):
            sweep_of_records(path)
    with monkeypatch.context() as broken:
        full(broken, more)
        with pytest.raises(
            ComputationError, match=r"No space left on device; the points stored before \(\d\) are whole.*run the same"
        ):
            sweep_of_records(path)
    found = open_sweep(path)
    done = found.status.values == "computed"
    assert done[:2].all() and not done.all()
    for name in RECORDS["scalars"] + RECORDS["records"]:
        assert (found[name].values[done] == whole[name].values[done]).all()
    xr.testing.assert_identical(sweep_of_records(path), whole)


def sweep_of_records(path):
    return fx.sweep(quick(), diameters(6, **RECORDS), store=path, workers=0)


#: Rows of 200 points, all of them again and again with the number of the turn, until it is killed.
WRITING = """
import sys
from pathlib import Path
import numpy as np
from flexapod.design.sweeps.store import StoredPoint, SweepStore

with SweepStore.open(Path(sys.argv[1])) as store:
    for turn in range(int(sys.argv[2]), 10**9):
        numbers, record = (np.full(n, turn, "<f8").tobytes() for n in (3, 600))
        store.write(StoredPoint(point, "computed", str(turn), numbers, (record,)) for point in range(200))
        print(turn, flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_killed_at_any_instant(path):
    """Rows are those of one turn, whole, and never of one before the last that was acknowledged."""
    made = {"axis": StoredArray(("point", "axis"), (200, 3), {}), "all": StoredArray(("point", "time"), (200, 600), {})}
    SweepStore.open_or_create(path, StoreLayout(200, {"flexapod_sweep_format": store.FORMAT}, made)).__exit__()
    instants, turn = np.random.default_rng(1).uniform(0.0, 0.05, 8), 0
    for instant in instants.tolist():
        process = start("-c", WRITING, path, turn)
        process.stdout.readline()
        time.sleep(instant)
        of_one_turn(path, turn)  # while it is written, too
        process.kill()
        said, shown = process.communicate()
        turn = of_one_turn(path, int(said.split()[-1]) if said else turn) + 1
        assert not shown


def of_one_turn(path, least):
    found = open_sweep(path)
    turns = {float(x) for x in found["axis"].values.ravel()} | {float(words) for words in found.remarks.values}
    assert len(turns) == 1 and least <= min(turns)
    return int(min(turns))


#: A transaction that has overwritten half of the file when its process is killed.
HALF = """
import os, sqlite3, sys

database = sqlite3.connect(sys.argv[1], isolation_level=None)
database.execute("PRAGMA cache_size = 1")
database.execute("BEGIN")
database.execute("UPDATE points SET words = 'spoilt', scalars = zeroblob(5000), deviation_by_cause = NULL")
os.kill(os.getpid(), 9)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
@pytest.mark.parametrize("opening", [open_sweep, sweep_of_records])
def test_what_a_killed_process_had_half_written_is_taken_back(path, opening):
    made, before = sweep_of_records(path).load(), path.read_bytes()
    subprocess.run([sys.executable, "-c", HALF, path], check=False)
    assert path.read_bytes() != before
    assert path.with_name("sweep.sqlite-journal").stat().st_size
    xr.testing.assert_identical(opening(path).load(), made)
    assert os.listdir(path.parent) == ["sweep.sqlite"]
    subprocess.run([sys.executable, "-c", HALF, path], check=False)
    path.unlink()  # by hand; what it had half written is not for the next one
    xr.testing.assert_identical(sweep_of_records(path).load(), made)


STROKE = "leg.stroke.max"
KEPT = {
    "scalars": ["com_deviation_peak", "com_deviation_peak_by_axis", "stress_peak"],  # of the last NaN is legal
    "records": ["com_deviation"],
}


def spoilt(path, statement):
    with sqlite3.connect(path) as database:
        database.execute(statement)
    database.close()


@pytest.mark.parametrize(
    "what",
    [
        "words = 'another'", "state = 'failed'", "scalars = NULL", "scalars = x'00'", "point = 7",
        "com_deviation = NULL",
        "scalars = (SELECT scalars FROM points WHERE point = 2)",
        "com_deviation = (SELECT com_deviation FROM points WHERE point = 2)",
    ],
)  # fmt: skip
def test_a_row_that_is_not_what_was_written_is_computed_again(path, monkeypatch, caplog, what):
    """A point once stayed computed, without values, for good."""
    sweep_of = {"vary": [{"key": STROKE, "values": ["1.05 m", "0.8 m", "1.06 m"]}], "keep": KEPT}
    made = fx.sweep(quick(), sweep_of, store=path, workers=0).load()
    assert made.status.values.tolist() == ["computed", "failed", "computed"]
    spoilt(path, f"UPDATE points SET {what} WHERE point = 0")
    with pytest.raises(ComputationError, match=r"point [07] cannot be read.*Run the sweep again"):
        open_sweep(path)["com_deviation"].load()  # the record is read when it is used
    seen = counted(monkeypatch)
    again = fx.sweep(quick(), sweep_of, store=path, workers=0)
    assert seen == [0]
    assert "Results of 1 points" in caplog.text
    xr.testing.assert_identical(again.load(), made)
    xr.testing.assert_identical(open_sweep(path).load(), made)


@pytest.mark.parametrize("how", ["UPDATE known SET content = x'0000000000'", "DELETE FROM known", "DROP TABLE known"])
def test_a_part_that_is_lost_is_named(path, how):
    sweep(path)
    spoilt(path, how)
    for opening in (open_sweep, sweep):
        with pytest.raises(InputError, match=r"is (a damaged store .*: what describes it cannot be read|not a store)"):
            opening(path)


def test_a_turned_bit_anywhere_changes_nothing_or_is_told(path):
    """Or takes points away, which are pending then; what is said names the file."""
    made, content, random = sweep(path, 40), path.read_bytes(), np.random.default_rng(1)
    told = 0
    for at, bit in zip(random.integers(len(content), size=150), random.integers(8, size=150), strict=True):
        path.write_bytes(content[:at] + bytes([content[at] ^ (1 << bit)]) + content[at + 1 :])
        try:
            found = open_sweep(path)
        except (InputError, ComputationError) as error:
            told += "sweep.sqlite" in str(error)
        else:
            done = found.status.values == "computed"
            xr.testing.assert_identical(found.isel(point=done), made.isel(point=done))
            told += not done.all()
    assert told > 40  # half of the file holds something


def test_a_truncated_file_is_refused(path):
    sweep(path, 40)
    content = path.read_bytes()
    for share in (0.01, 0.3, 0.6, 0.99):
        path.write_bytes(content[: int(share * len(content))])
        with pytest.raises((InputError, ComputationError), match=r"sweep.sqlite: (is|point \d+ cannot be read)"):
            open_sweep(path)
        with pytest.raises(InputError, match=r"sweep.sqlite: is (not a|a damaged) store of a sweep"):
            sweep(path, 40)


def test_another_program_that_does_not_let_go(path, monkeypatch):
    sweep(path)
    monkeypatch.setattr(store, "PATIENCE", 0.05)
    with sqlite3.connect(path) as other:
        other.execute("BEGIN EXCLUSIVE")
        for opening in (open_sweep, sweep):
            with pytest.raises(ComputationError, match=r"sweep.sqlite is in use by another program"):
                opening(path)
    other.close()
    open_sweep(path)


def test_a_full_store_is_opened_again_without_reading_its_tables_again(path, tmp_path, monkeypatch):
    """A table of 800 lines once cost 9 ms at every point: 18 s for 2000 points."""
    lines = "".join(f"{t / 1000},{t / 1e5}\n" for t in range(800))
    (tmp_path / "roll.csv").write_text(f"time [s],roll [deg]\n{lines}", encoding="utf-8")
    head, _, tail = quick_text().partition("[motion]")
    text = f'{head}[motion]\ntype = "csv"\nfile = "roll.csv"\n{tail[tail.index("[simulation]") :]}'
    study = loads(text, path=tmp_path / "study.toml")
    read = []
    monkeypatch.setattr(csv_tables.csv, "reader", lambda stream: read.append(1) or iter(list(reader(stream))))
    points = Points(study, read_plan(diameters(20)))
    first = points.resolve().hash
    assert read == []  # it was read with the study
    (tmp_path / "roll.csv").write_text(f"time [s],roll [deg]\n{lines.replace('0.799,', '0.7995,')}", encoding="utf-8")
    assert Points(study, read_plan(diameters(20))).resolve().hash != first  # the content counts, not its date
    assert read == [1]


@pytest.mark.parametrize("store", [".", "", "..", "/proc/x.sqlite", "/proc/x.zarr", 3])
def test_places_that_cannot_be(store):
    with pytest.raises(InputError):
        sweep(store)


def test_refused_points_cost_little():
    """The points to do were once made a set again for every refused point: hours for a million of them."""

    class Counted(list):
        passes = 0

        def __iter__(self):
            Counted.passes += 1
            return super().__iter__()

    job = run._Job(points=None, resolved=Refused({n: "no" for n in range(50)}), kept=None, store=None)
    assert len(job._refused(Counted(range(50))).points) == 50
    assert Counted.passes == 1


class Refused:
    def __init__(self, refused):
        self.refused = refused


def test_records(path):
    names = ["com_deviation", "actuator_force_rigid"]
    made = fx.sweep(quick(), diameters(3, records=names, record_step=5e-3), store=path, workers=0)
    assert made.com_deviation.dims == ("point", "time", "axis")
    there = open_sweep(path).com_deviation
    for at in ((0,), (-1, 2), (slice(2, 0, -1), 0, 1), (slice(1, 1),), (..., 2), ([2, 0], [1, 3])):
        xr.testing.assert_identical(there[at], made.com_deviation.load()[at])  # read, and in memory
    there[0] = 0.0  # a copy in memory
    assert (open_sweep(path).com_deviation == made.com_deviation).all()
    assert made.time.values == pytest.approx([0, 5e-3, 10e-3, 15e-3, 20e-3])
    one = fx.run(loads(quick_text(('diameter = "27 mm"', f"diameter = {float(made[KEY][1])!r}"))))
    assert (made.com_deviation.values[1] == one.com_deviation.values[::5]).all()  # the same steps
    forces = (data.actuator_force_rigid.values for data in (made.isel(point=1), one.isel(time=slice(None, None, 5))))
    np.testing.assert_allclose(*forces, rtol=1e-12, atol=1e-9)  # by compiled rows and in NumPy


def test_unstacked():
    mass = {"key": "payload.mass", "values": [50, 100]}
    made = fx.sweep(quick(), diameters(3, more=[mass]), workers=0)
    grid = unstacked(made)
    assert dict(grid.com_deviation_peak.sizes) == {KEY: 3, "payload.mass": 2}
    assert grid[KEY].dims == (KEY,)
    assert (grid.com_deviation_peak.values.ravel() == made.com_deviation_peak.values).all()
    assert float(grid.com_deviation_peak.sel({"payload.mass": 100})[2]) == made.com_deviation_peak.values[5]


def test_unstacked_where_a_key_varies_and_scatters():
    """The grid was once labelled with the first draw, and the values that were given were nowhere."""
    masses = {"vary": [{"key": "payload.mass", "values": [50, 100]}]}
    law = {"count": 3, "tolerance": [{"key": "payload.mass", "normal": "1 %"}]}
    grid = unstacked(fx.sweep(quick(), masses | {"random": law}, workers=0))
    assert grid["payload.mass"].values.tolist() == [50, 100]
    drawn = grid["payload.mass_drawn"]
    assert drawn.dims == ("payload.mass", "draw")
    assert (np.unique(drawn.values).size, drawn.attrs["units"]) == (6, "kg")
    assert grid.com_deviation_peak.sel({"payload.mass": 50}).dims == ("draw",)


def test_a_scalar_that_a_point_may_lack():
    """Legs without a section have no stress, rigid ones no frequency: everything else of the point was thrown away."""
    section = ('piston = { diameter = "27 mm"', "piston = { EI = 5400, EA = 1.2e8, rhoA = 4.5")
    text = quick_text(section, (', material = "steel" }', " }"))
    scalars = ["com_deviation_peak", "stress_peak", "stress_peak_by_leg"]
    made = fx.sweep(
        loads(text), {"vary": [{"key": "payload.mass", "values": [90]}], "keep": {"scalars": scalars}}, workers=0
    )
    assert made.status.values.tolist() == ["computed"]
    assert np.isnan(made.stress_peak_by_leg.values).all()
    assert "stress_peak has no value: a piston or strut is given by EI, EA and rhoA" in made.remarks.values[0]
    kinds = {
        "vary": [{"key": "simulation.fidelity", "values": ["rigid", "lumped"]}],
        "keep": {"scalars": ["first_frequency"]},
    }
    assert np.isnan(fx.sweep(quick(), kinds, workers=0).first_frequency.values).tolist() == [True, False]


def test_actuator():
    text = fx.model.preset_text("paper-actuator").replace('duration = "10 s"', 'duration = "0.2 s"\nstep = "1 ms"')
    starts = ["5 mm", "10 mm"]
    made = fx.sweep(loads(text), {"vary": [{"key": "initial.tip_displacement", "values": starts}]}, workers=0)
    for start_at, peak in zip(starts, made.tip_deflection_peak.values, strict=True):
        alone = fx.run(loads(text.replace('"5 mm"', f'"{start_at}"')))
        assert peak == fx.study.summary(alone).peak


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have names")
def test_a_pipe_in_the_place_of_a_store(path):
    """Reading it would wait for ever."""
    os.mkfifo(path)
    for opening in (open_sweep, sweep):
        with pytest.raises(InputError, match="is not a store of a sweep"):
            opening(path)
