"""`flexapod sensitivity` and `flexapod optimise` as a user types them."""

import json
from math import isfinite

import pytest

import flexapod as fx

pytestmark = pytest.mark.cli

LUMPED = ('fidelity = "assumed-modes"', 'fidelity = "lumped"')
DESIGN = """
[[variables]]
key = "leg.piston.diameter"
low = "15 mm"
high = "60 mm"
[objective]
minimise = "piston_mass"
[constraints]
first_frequency = { least = "%s" }
"""


def test_tornado_in_words_and_files(flexapod, study, folder):
    done = flexapod("sensitivity", study(LUMPED), "--key", "leg.piston.diameter", "--key", "payload.mass", "--out", "s")
    assert done.exit_code == 0, done.stderr
    assert "first_frequency 21.7 Hz: per cent for a per cent" in done.stdout
    assert "++++++++++++" in done.stdout
    assert {path.name for path in (folder / "s").iterdir()} == {"sensitivity.nc", "sensitivity.png"}


def test_json_of_sensitivities_at_a_pose(flexapod, study):
    options = ("--key", "payload.mass", "--output", "first_frequency", "--pose", "heave=10mm", "--json")
    one, other = (
        json.loads(flexapod("sensitivity", study(LUMPED), *options, *more).stdout)
        for more in ((), ("--set", "payload.mass=50 kg"))
    )
    assert one["key"] == ["payload.mass"]
    assert isfinite(one["sensitivity"][0][0])
    assert one["value"] < other["value"]


def test_optimum_as_a_study_file(flexapod, study, folder):
    (folder / "design.toml").write_text(DESIGN % "25 Hz")
    done = flexapod("optimise", study(LUMPED), "design.toml", "--out", "best")
    assert done.exit_code == 0, done.stderr
    assert "1 Hz more costs" in done.stdout
    best = fx.load(folder / "best" / "optimum.toml")
    assert fx.modes(best).frequency.values[0] == pytest.approx(25, rel=2e-6)


def test_cannot_has_exit_code_0(flexapod, study, folder):
    (folder / "design.toml").write_text(DESIGN % "2500 Hz")
    done = flexapod("optimise", study(LUMPED), "design.toml", "--json")
    assert done.exit_code == 0
    assert json.loads(done.stdout)["sentences"][0].startswith("Cannot: first_frequency")


@pytest.mark.parametrize(
    ("command", "options", "words"),
    [
        ("sensitivity", ["--key", "leg.piston.diametr"], "leg.piston.diametr"),
        ("sensitivity", ["--output", "first"], "--output"),
        ("sensitivity", ["--pose", "roll=1mm"], "angle"),
        ("optimise", ["nothing.toml"], "cannot be read"),
    ],
)
def test_refused(flexapod, study, command, options, words):
    done = flexapod(command, study(LUMPED), *options)
    assert done.exit_code == 2
    assert words in done.stderr
