"""`--set KEY=VALUE`: another value at a key of the study, for one call."""

import json

import pytest

import flexapod as fx

pytestmark = pytest.mark.cli


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(fx.preset("paper-robot").source_text, encoding="utf-8")
    return path


def test_a_value_of_the_command_line_is_the_one_of_the_file(flexapod, study):
    before = json.loads(flexapod("modes", study, "--json").stdout)["modes"]
    given = flexapod("modes", study, "--set", "payload.mass=50 kg", "--set", 'leg.piston.diameter="30 mm"', "--json")
    other = study.with_name("other.toml")
    values = {"payload.mass": "50 kg", "leg.piston.diameter": "30 mm"}
    other.write_text(fx.load(study).with_values(values).source_text, encoding="utf-8")
    assert json.loads(given.stdout)["modes"] == json.loads(flexapod("modes", other, "--json").stdout)["modes"] != before


@pytest.mark.parametrize("command", ["check", "budget", "run", "map", "modes"])
@pytest.mark.parametrize(
    ("setting", "words"),
    [("payload.mass", "KEY=VALUE"), ("leg.pistn.diameter=1", "leg.piston.diameter"), ("payload.mass=5 mm", "a mass")],
)
def test_what_is_refused(flexapod, study, command, setting, words):
    found = flexapod(command, study, "--set", setting)
    assert found.exit_code == 2
    assert "--set" in found.stderr
    assert words in found.stderr
    assert study.name not in found.stderr
