"""The store of a sweep: continued, refused, locked, whole whatever happens while it is written."""

import errno
import os
import subprocess
import sys
from csv import reader
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from tests.sweeps import KEY, diameters, quick, quick_text, start

import flexapod as fx
from flexapod import version
from flexapod import version as identity
from flexapod.errors import ComputationError, InputError
from flexapod.files import scratch
from flexapod.model import loads
from flexapod.schema import csv_tables
from flexapod.surveys.sweeps import SweepStopped, batch, open_sweep, result, run, unstacked, writer
from flexapod.surveys.sweeps.batch import compute_batch
from flexapod.surveys.sweeps.disk import DurableStore
from flexapod.surveys.sweeps.lock import locked
from flexapod.surveys.sweeps.plan import read_plan
from flexapod.surveys.sweeps.points import Points


@pytest.fixture
def path(tmp_path):
    return tmp_path / "sweep.zarr"


def sweep(path, count=4, **settings):
    return fx.sweep(quick(), diameters(count), store=path, workers=0, **settings)


def counted(monkeypatch):
    """Points as they are computed."""
    seen = []

    def compute(version, kept, points, studies):
        seen.extend(points)
        return compute_batch(version, kept, points, studies)

    monkeypatch.setattr(batch, "compute_batch", compute)
    return seen


def stopping(monkeypatch, point, error):
    """A batch that raises at a point."""

    def compute(version, kept, points, studies):
        if point in points:
            raise error
        return compute_batch(version, kept, points, studies)

    monkeypatch.setattr(batch, "compute_batch", compute)


def test_what_is_stored(path):
    made = sweep(path)
    assert made.status.values.tolist() == ["computed"] * 4
    assert made[KEY].values == pytest.approx(np.linspace(0.025, 0.03, 4))
    assert (made[KEY].attrs["units"], made.com_deviation_peak.attrs["units"]) == ("m", "m")
    for other in (open_sweep(path), sweep(None)):
        xr.testing.assert_identical(other, made)
    with xr.open_zarr(path, chunks=None) as plain:  # as anybody would open it, without a warning
        assert plain.com_deviation_peak.values.tolist() == made.com_deviation_peak.values.tolist()
    assert os.listdir(path.parent) == ["sweep.zarr"]


def test_netcdf(path, tmp_path):
    made = sweep(path)
    made.to_netcdf(tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc") as read:
        assert read[KEY].values.tolist() == made[KEY].values.tolist()


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
    nothing = batch.ROBOT_SCALARS["com_deviation_peak"]._replace(value=lambda run: np.nan)
    monkeypatch.setitem(batch.ROBOT_SCALARS, "com_deviation_peak", nothing)
    made = sweep(None, 2)
    assert made.message.values.tolist() == ["com_deviation_peak is not finite"] * 2


def test_a_fault_is_the_failure_of_a_point(monkeypatch):
    def fault(*_):
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(batch, "check_path", fault)
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
    monkeypatch.setattr(version, "__version__", "9.9")
    with pytest.raises(InputError, match=r"flexapod_version = .*was made by another version.*Allowed: 9.9"):
        sweep(path)


def test_other_sources_are_refused(path, monkeypatch):
    """Changed code under an unchanged version once went on with an old store."""
    sweep(path)
    monkeypatch.setattr(identity, "_KINDS", (".py",))
    identity.sources.cache_clear()
    with pytest.raises(InputError, match=r"flexapod_sources = .*was made by other sources of flexapod"):
        sweep(path)
    monkeypatch.undo()
    identity.sources.cache_clear()
    sweep(path)


def test_a_comment_in_the_study_is_no_other_study(path):
    sweep(path)
    fx.sweep(loads(quick_text() + "\n# a comment\n"), diameters(4), store=path, workers=0)


def test_what_is_no_store_is_refused_and_left_alone(tmp_path):
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    for place in (tmp_path, tmp_path / "notes.txt"):
        with pytest.raises(InputError, match="is not a store of a sweep"):
            sweep(place)
    assert (tmp_path / "notes.txt").read_text(encoding="utf-8") == "mine"


def test_two_sweeps_on_one_store(path):
    with locked(path), pytest.raises(ComputationError, match="in use by another sweep"):
        sweep(path)
    assert sweep(path).status.values.tolist() == ["computed"] * 4


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_the_lock_of_a_killed_process_is_no_hindrance(path):
    code = (
        "import sys, pathlib; from flexapod.surveys.sweeps.lock import locked\n"
        "with locked(pathlib.Path(sys.argv[1])): print('held', flush=True); sys.stdin.read()"
    )
    holder = start("-c", code, path, stdin=-1)
    assert holder.stdout.readline() == "held\n"
    with pytest.raises(ComputationError, match="in use by another sweep"):
        sweep(path)
    holder.kill()
    holder.communicate()
    assert path.with_name("sweep.zarr.lock").exists()
    assert sweep(path).status.values.tolist() == ["computed"] * 4


def test_a_folder_without_locks_is_refused(path, monkeypatch):
    def none(handle, kind):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(pytest.importorskip("fcntl"), "flock", none)
    with pytest.raises(ComputationError, match="cannot be locked"):
        sweep(path)


def failing_writes(monkeypatch, after):
    """Every write to a disk after so many fails: it is full."""
    whole, left = DurableStore.set, [after]

    async def full(self, key, value):
        left[0] -= 1
        if left[0] < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        await whole(self, key, value)

    monkeypatch.setattr(DurableStore, "set", full)


@pytest.mark.parametrize("after", range(0, 9))
def test_full_disk(path, monkeypatch, after):
    """Whichever write fails: what the store says to be computed is, and the next run completes it."""
    whole = sweep(None, 6)
    monkeypatch.setattr(writer, "OFTEN", 0.0)
    monkeypatch.setattr(writer, "SHARE", np.inf)
    with monkeypatch.context() as broken:
        stopping(broken, 2, KeyboardInterrupt)
        with pytest.raises(KeyboardInterrupt):
            sweep(path, 6)
    with monkeypatch.context() as broken:
        failing_writes(broken, after)
        with pytest.raises(ComputationError, match=r"No space left on device.*points stored before.*run the same"):
            sweep(path, 6)
    found = open_sweep(path)
    done = found.status.values == "computed"
    assert done[:2].all()
    for name in ("com_deviation_peak", "com_deviation_peak_by_axis"):
        assert (found[name].values[done] == whole[name].values[done]).all()
    xr.testing.assert_identical(sweep(path, 6), whole)


def test_full_disk_at_the_very_start(path, monkeypatch):
    with monkeypatch.context() as broken:
        failing_writes(broken, 3)
        with pytest.raises(ComputationError, match="No space left on device"):
            sweep(path)
    assert not path.exists()
    assert sweep(path).status.values.tolist() == ["computed"] * 4


def test_chunks_are_renamed_into_place(path, monkeypatch):
    """What a reader, or a process that comes after one that was killed, finds is never half a file."""
    sweep(path)
    moved = []
    replace = Path.replace
    monkeypatch.setattr(Path, "replace", lambda self, target: moved.append(Path(target)) or replace(self, target))
    monkeypatch.setattr(run, "COMPUTED", 9)  # compute all again
    sweep(path, retry_failed=True)
    written = {p.relative_to(path).parts[0] for p in moved if path in p.parents}
    assert {"com_deviation_peak", "com_deviation_peak_by_axis", "status"} <= written


def test_remains_of_a_killed_process_are_removed(path):
    made = sweep(path)
    rest = path / "status" / "c" / ".flexapod-0123"
    rest.write_bytes(b"half")
    xr.testing.assert_identical(open_sweep(path), made)
    assert rest.exists()  # who only reads does not know whether its writer is alive
    xr.testing.assert_identical(sweep(path), made)
    assert not rest.exists()


def chunk(path, name):
    return next(file for file in (path / name / "c").rglob("*") if file.is_file())


def one_bit(content: bytes) -> bytes:
    """The same with a bit of the last number turned; the checksum's four bytes follow it."""
    return content[:-5] + bytes([content[-5] ^ 1]) + content[-4:]


SPOILT = {"missing": None, "empty": lambda _: b"", "garbage": lambda _: b"garbage", "one bit": one_bit}
STROKE = "leg.stroke.max"
KEPT = {
    "scalars": ["com_deviation_peak", "com_deviation_peak_by_axis", "stress_peak"],  # of the last NaN is legal
    "records": ["com_deviation"],
}


@pytest.mark.parametrize("spoil", SPOILT.values(), ids=SPOILT)
@pytest.mark.parametrize("name", [*KEPT["scalars"], *KEPT["records"], "message", "remarks", "status", "axis", STROKE])
def test_what_a_power_failure_spoilt_is_computed_again(path, monkeypatch, caplog, name, spoil):
    """Values were lost, their status was not: the point once stayed computed, without values, for good."""
    sweep_of = {"vary": [{"key": STROKE, "values": ["1.05 m", "0.8 m", "1.06 m"]}], "keep": KEPT}
    made = fx.sweep(quick(), sweep_of, store=path, workers=0)
    assert made.status.values.tolist() == ["computed", "failed", "computed"]
    file = chunk(path, name)
    file.unlink() if spoil is None else file.write_bytes(spoil(file.read_bytes()))
    if spoil is None and name not in ("axis", STROKE):
        assert open_sweep(path).status.values.tolist() == ["pending"] * 3
    elif name in KEPT["records"]:
        with pytest.raises(RuntimeError):  # when it is used
            open_sweep(path)[name].load()
    else:
        with pytest.raises(ComputationError, match=f"{name} cannot be read.*Run the sweep again"):
            open_sweep(path)
    seen = counted(monkeypatch)
    again = fx.sweep(quick(), sweep_of, store=path, workers=0)
    assert seen == ([] if name in ("axis", STROKE) else [0, 1, 2])  # of what is known nothing is computed
    if (name, spoil) != ("status", None):  # no file of it is also how a sweep begins
        assert bool(seen) == ("Results of 3 points" in caplog.text)
    xr.testing.assert_identical(again, made)
    xr.testing.assert_identical(open_sweep(path), made)


@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="/proc tells which file is meant")
def test_files_are_on_the_disk_before_the_next_is_named(path, monkeypatch):
    """Every file is waited for before it gets its name, and every name before the status says that it is there."""
    sweep(path)
    seen = []
    waited, renamed = os.fsync, Path.replace
    monkeypatch.setattr(
        os, "fsync", lambda handle: seen.append(os.readlink(f"/proc/self/fd/{handle}")) or waited(handle)
    )
    monkeypatch.setattr(Path, "replace", lambda self, to: seen.append((str(self), Path(to))) or renamed(self, to))
    monkeypatch.setattr(run, "COMPUTED", 9)  # compute all again
    sweep(path, retry_failed=True)
    moves = [(i, *entry) for i, entry in enumerate(seen) if isinstance(entry, tuple) and path in entry[1].parents]
    status = next(i for i, _, to in moves if to.relative_to(path).parts[0] == "status")
    assert len(moves) > 3
    for i, source, to in moves:
        assert source in seen[:i], to
        if i != status:
            assert str(to.parent) in seen[i:status], to


def test_opened_while_it_is_written(path, monkeypatch):
    """A writer adds points between two reads of a reader: no point is computed without values, or the other way."""
    names = ["stress_peak", "com_deviation_peak", "com_deviation_peak_by_axis"]  # of the first NaN is legal
    plan = diameters(12, scalars=names)
    stopping(monkeypatch, 5, KeyboardInterrupt)
    with pytest.raises(SweepStopped):
        fx.sweep(quick(), plan, store=path, workers=0)
    monkeypatch.undo()
    load, first = result._load, []

    def interrupted(data, name, place):
        load(data, name, place)
        if not first:
            first.append(name)
            fx.sweep(quick(), plan, store=path, workers=0)

    monkeypatch.setattr(result, "_load", interrupted)
    found = open_sweep(path)
    assert first
    done = found.status.values == "computed"
    assert 0 < done.sum() < 12
    for name in names:
        assert (np.isfinite(found[name].values.reshape(12, -1)).all(axis=1) == done).all(), name


def test_a_missing_part_is_named(path):
    sweep(path)
    (path / "com_deviation_peak" / "zarr.json").unlink()
    for opening in (lambda: open_sweep(path), lambda: sweep(path)):
        with pytest.raises(InputError, match="damaged store of a sweep: there is no com_deviation_peak"):
            opening()


@pytest.mark.parametrize("name", ["", "status", "com_deviation_peak", KEY, "axis"])
def test_a_spoilt_description_is_named(path, name):
    """Whichever array's description was spoilt, "there is no status" was said once."""
    made = sweep(path)
    file = path / name / "zarr.json"
    content = file.read_bytes()
    for spoilt in (b"", content[: len(content) // 2], b"{}"):
        file.write_bytes(spoilt)
        for opening in (lambda: open_sweep(path), lambda: sweep(path)):
            words = f"the array {name} cannot be read" if name else "the whole cannot be read|is not a store of a sweep"
            with pytest.raises(InputError, match=words):
                opening()
    file.write_bytes(content)
    xr.testing.assert_identical(open_sweep(path), made)


def test_a_lost_description_of_a_label_is_told(path):
    """A bare KeyError once."""
    sweep(path)
    (path / "axis" / "zarr.json").unlink()
    with pytest.raises(InputError, match="damaged store of a sweep: there is no axis"):
        sweep(path)


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


def test_what_a_process_left_that_was_killed_while_it_made_a_store(path):
    child = subprocess.Popen(["true"])
    child.wait()
    with scratch(path.parent) as folder:
        begin = folder.name.rsplit(str(os.getpid()), 1)[0]
    gone, alive = (path.with_name(f"{begin}{number}-0123456789ab") for number in (child.pid, os.getppid()))
    for left in (gone, alive):
        (left / "store").mkdir(parents=True)
    sweep(path)
    assert sorted(os.listdir(path.parent)) == [alive.name, "sweep.zarr"]


@pytest.mark.parametrize("store", [".", "", "..", "/proc/x.zarr", 3])
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
    assert made.time.values == pytest.approx([0, 5e-3, 10e-3, 15e-3, 20e-3])
    one = fx.run(loads(quick_text(('diameter = "27 mm"', f"diameter = {float(made[KEY][1])!r}"))))
    for name in names:  # the same operations on the same numbers
        assert (made[name].values[1] == one[name].values[::5]).all()


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
@pytest.mark.parametrize("name", ["zarr.json", "status/zarr.json", "status", "com_deviation_peak", "axis"])
def test_a_pipe_in_the_place_of_a_file_of_a_store(path, monkeypatch, name):
    """Reading it would wait for ever: refused, and a chunk of results is computed again."""
    sweep_of = diameters(2) | {"keep": {"scalars": ["com_deviation_peak", "com_deviation_peak_by_axis"]}}
    made = fx.sweep(quick(), sweep_of, store=path, workers=0)
    file = path / name if name.endswith("json") else chunk(path, name)
    file.unlink()
    os.mkfifo(file)
    with pytest.raises(InputError, match="it is not a regular file"):
        open_sweep(path)
    if name.endswith("json"):
        with pytest.raises(InputError, match="it is not a regular file"):
            fx.sweep(quick(), sweep_of, store=path, workers=0)
        return
    seen = counted(monkeypatch)
    again = fx.sweep(quick(), sweep_of, store=path, workers=0)
    assert seen == ([] if name == "axis" else [0, 1])
    xr.testing.assert_identical(again, made)
