"""`flexapod map` as a user types it."""

import json

import pytest

from flexapod.analysis import open_results
from flexapod.analysis.checks import resource_limits
from flexapod.design.maps.findings import SCALARS

pytestmark = pytest.mark.cli

LUMPED = ('fidelity = "assumed-modes"', 'fidelity = "lumped"')


def test_map_answers_in_words_and_writes_everything(flexapod, study, folder):
    done = flexapod(
        "map", study(LUMPED), "--x", "surge=-500..500mm:5", "--y", "heave:5", "--at", "roll=2deg", "--out", "m"
    )
    assert done.exit_code == 0, done.stderr
    lines = done.stdout.splitlines()
    assert "of 25 poses are reached" in lines[0]
    assert "at roll 2 deg" in lines[0]
    assert "a leg is longer than its stroke allows" in done.stdout
    assert "First natural frequency" in done.stdout
    assert "least at surge" in done.stdout
    names = {path.name for path in (folder / "m").iterdir()}
    pictures = {f"map-{name.replace('_', '-')}.png" for name in SCALARS}
    assert names == {"map.nc"} | pictures
    data = open_results(folder / "m" / "map.nc")
    assert data.sizes["surge"] == 5
    assert data.surge.values[[0, -1]].tolist() == [-0.5, 0.5]
    assert data.attrs["at_roll"] == pytest.approx(0.0349065850398)


def test_json(flexapod, study):
    options = ("--x", "heave=0..20mm:3", "--direction", "1,0,1", "--acceleration", "0,0,5 m/s^2", "--mode", 2)
    done = flexapod("map", study(LUMPED), *options, "--json", "--out", "m")
    found = json.loads(done.stdout)
    assert (found["poses"], found["reached"], found["reasons"]) == (3, 3, {})
    by_name = {quantity["name"]: quantity for quantity in found["quantities"]}
    assert by_name["frequency"]["words"] == "natural frequency of mode 2"
    assert by_name["frequency"]["least_at"]["heave"] in (0.0, 0.02)
    assert by_name["dynamic_deviation"]["words"].endswith("[0, 0, 5] m/s²")
    assert len(found["files"]) == 1 + len(by_name)


def test_nothing_in_reach_is_an_answer(flexapod, study):
    done = flexapod("map", study(LUMPED), "--x", "heave=2..3:3", "--out", "m")
    assert done.exit_code == 0
    assert "0 of 3 poses are reached" in done.stdout
    assert "Nothing to map" in done.stdout


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--x", "surg"], "Did you mean 'surge'"),
        (["--x", "surge=0.2..-0.2"], "begins where it should end"),
        (["--x", "surge=1..2:0"], "not a number of points"),
        (["--x", "surge=0..10deg"], "not a length"),
        (["--x", "roll=0..10mm"], "not an angle"),
        (["--x", "surge="], "is not an axis"),
        (["--x", "surge=0.1"], "is not an axis"),
        (["--x", "surge", "--y", "surge"], "given twice"),
        (["--x", "roll", "--at", "roll=1deg"], "varies in this map"),
        (["--at", "surge=1mm"], "varies in this map"),
        (["--at", "roll"], "has no value"),
        (["--at", "rol=1deg"], "Did you mean 'roll'"),
        (["--direction", "up"], "is not a direction"),
        (["--direction", "0,0,0"], "has no direction"),
        (["--acceleration", "1,2"], "is not a vector"),
        (["--acceleration", "1,2,3 kg"], "not an acceleration"),
        (["--x", "heave=0..1mm:2", "--mode", "999"], "not a mode of this robot"),
        (["--x", "surge=0..1:2000", "--y", "heave=0..1:2000"], "too many poses"),
    ],
)
def test_options_that_are_refused(flexapod, study, folder, options, words):
    done = flexapod("map", study(LUMPED), *options, "--out", "m")
    assert done.exit_code == 2
    assert words in done.stderr
    assert options[-2] in done.stderr or "--x" in done.stderr
    assert not (folder / "m").exists()


def test_an_actuator_has_no_map(flexapod, study):
    done = flexapod("map", study(preset="paper-actuator"))
    assert done.exit_code == 2
    assert "single actuator" in done.stderr


def test_stopped_by_the_user_nothing_is_half_written(flexapod, study, folder, monkeypatch):
    import flexapod.design.maps.maps as workspace

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(workspace, "batch_values", stop)
    done = flexapod("map", study(LUMPED), "--out", "m")
    assert done.exit_code == 130
    assert "Ctrl-C" in done.stderr
    assert not (folder / "m").exists()


def test_a_map_beyond_the_disk_is_refused_before_it_is_computed(flexapod, study, folder, monkeypatch):
    monkeypatch.setattr(resource_limits, "free_disk", lambda folder: 1.5e8)
    axes = ["--x", "surge=-1..1mm:100", "--y", "sway=-1..1mm:100", "--z", "heave=-1..1mm:100"]
    done = flexapod("map", study(LUMPED), *axes, "--out", "m")
    assert done.exit_code == 2
    assert "on the disk, where 0.15 GB is free" in " ".join(done.stderr.split())
    assert not (folder / "m").exists()
