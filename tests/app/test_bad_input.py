"""Bad input: refused before anything is computed, in words, exit code 2, nothing written."""

import json

import pytest

from flexapod.model import preset_text

pytestmark = pytest.mark.cli

BASE = 'base     = { radius = "250 mm", half_angle = "10 deg" }'
PLATFORM = 'platform = { radius = "150 mm", half_angle = "10 deg" }'
JOINTS = "[[0.25, 0, 0], [0.2, 0.1, 0], [0, 0.25, 0], [-0.2, 0.1, 0], [-0.2, -0.1, 0], [nan, 0, 0]]"

REFUSED = {
    "unknown key": ([('mass = "100 kg"', 'mas = "100 kg"')], ["payload.mas", "unknown key", "Did you mean 'mass'?"]),
    "wrong unit": ([('mass = "100 kg"', 'mass = "100 mm"')], ["payload.mass = 100 mm", "is not a mass", "kg"]),
    "no unit": ([('home_height = "0.9 m"', 'home_height = "0.9"')], ["robot.home_height", "has no unit"]),
    "negative mass": ([('mass = "100 kg"', 'mass = "-100 kg"')], ["payload.mass = -100 kg", "above 0"]),
    "impossible inertia": (
        [("[17.88, 17.88, 17.88]", "[1, 1, 17.88]")],
        ["payload.inertia", "an inertia that no body can have", "sum of the other two"],
    ),
    "com": ([('com = [0, "373 mm", 0]', "com = [0, nan, 0]")], ["payload.com[2]", "is not finite"]),
    "joints": ([(BASE, f"base = {{ joints = {JOINTS} }}")], ["robot.base.joints[6][1]", "is not finite"]),
    "wide piston": ([('diameter = "27 mm"', 'diameter = "0.8 m"')], ["leg.piston.diameter", "wider than long"]),
    "free length": ([('mouth = "315.18 mm"', 'mouth = "0.93 m"')], ["no piston is left outside the cylinder"]),
    "pulled out": (
        [('length = "750 mm"', 'length = "650 mm"')],
        ["leg.piston.length", "Leg 3: the piston is pulled out of its cylinder", "by 13.68 mm at t = 1.000 s"],
    ),
    "stroke": (
        [('max = "1.05 m"', 'max = "0.96 m"')],
        ["leg.stroke.max", "Leg 3 is longer than its stroke allows", "by 18.86 mm at t = 1.000 s", "so does leg 2"],
    ),
    "singular": (
        [(BASE, BASE.replace("10 deg", "30 deg")), (PLATFORM, PLATFORM.replace("10 deg", "30 deg"))],
        ["the path is singular at t = 0 s, from the start", "smallest singular value", "half_angle"],
    ),
    "fidelity": ([('"assumed-modes"', '"beam-fem"')], ["simulation.modes = 3", "two shapes per element"]),
    "basis": ([("modes = 3", 'modes = 3\nbasis = "hermite"')], ["simulation.basis = hermite", 'fidelity = "beam-fem"']),
    "modes": ([("modes = 3", "modes = 13")], ["simulation.modes = 13", "12"]),
    "not TOML": ([("[payload]", "[payload")], ["is not valid TOML", "line 20"]),
}  # fmt: skip


def refusal(result, *words):
    """Exit code 2, nothing on stdout, all words on stderr, no traceback."""
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert result.stderr.startswith("Error: ")
    assert "Traceback" not in result.stderr
    for word in words:
        assert word in result.stderr
    return True


@pytest.mark.parametrize("changes, words", REFUSED.values(), ids=REFUSED)
@pytest.mark.parametrize("command", ["check", "run"])
def test_bad_study(flexapod, study, folder, command, changes, words):
    file = study(*changes)
    assert refusal(flexapod(command, file), "study.toml", *words)
    assert [path.name for path in folder.iterdir()] == ["study.toml"]


def follow_table(folder):
    """A study whose motion is the table motion.csv."""
    text = preset_text("paper-robot")
    before, after = text.index("[motion]"), text.index("[simulation]")
    file = folder / "study.toml"
    motion = '[motion]\ntype = "csv"\nfile = "motion.csv"\n\n'
    file.write_text(text[:before] + motion + text[after:], encoding="utf-8")
    return file.name


@pytest.mark.parametrize(
    "table, words",
    [
        ("time [s],roll [deg]\n0,0\n0.5,\n1,5\n", ["line 3, column 'roll'", "is empty", "Fill the gap"]),
        ("time [s],roll [deg]\n0,0\n0.5\n1,5\n", ["line 3", "has 1 cells for 2 columns"]),
        ("time [s],roll [deg]\n0,0\n1,5\n0.5,3\n", ["line 4, column 'time' = 0.5", "goes back in time", "above 1 s"]),
        ("time [s],roll [deg]\n0,0\n1,5\n1,3\n", ["line 4", "repeats the instant before"]),
        ("time [s],roll [mm]\n0,0\n1,5\n", ["line 1, column 'roll'", "is not an angle"]),
        ("time,roll\n0,0\n1,5\n", ["line 1, column 'time'", "has no unit in the header"]),
        ("", ["is empty", "time [s]"]),
    ],
    ids=["gap", "short line", "unsorted", "double", "wrong unit", "no unit", "empty"],
)
def test_bad_table(flexapod, folder, table, words):
    (folder / "motion.csv").write_text(table)
    file = follow_table(folder)
    assert refusal(flexapod("run", file), "motion.csv", *words)
    assert not (folder / "study-run").exists()


def test_missing_table(flexapod, folder):
    assert refusal(flexapod("check", follow_table(folder)), "motion.csv", "No such file")


def test_wide_piston_is_remarked_on(flexapod, study):
    result = flexapod("check", study(('diameter = "27 mm"', 'diameter = "80 mm"')))
    assert result.exit_code == 0, result.stderr
    assert "the piston is 0.08 m wide" in result.stdout
    assert "Euler-Bernoulli beam is strained" in result.stdout


def test_near_singular_path_is_remarked_on(flexapod, study):
    changes = [(text, text.replace("10 deg", "28 deg")) for text in (BASE, PLATFORM)]
    widened = [('min = "700 mm", max = "1.05 m"', 'min = "600 mm", max = "1.2 m"')]
    result = flexapod("check", study(*changes, *widened))
    assert result.exit_code == 0, result.stderr
    assert "comes near a singular pose at t = " in result.stdout


def test_lost_equilibrium_is_a_result_of_check_and_stops_run(flexapod, study, folder):
    file = study(more="\n[load]\nwrench = { law = 'constant', value = [0, 0, -1e6, 0, 0, 0] }\n")
    found = flexapod("check", file)
    assert found.exit_code == 0
    assert "no equilibrium" in found.stdout
    assert "buckles" in found.stdout
    result = flexapod("run", file)
    assert result.exit_code == 1
    assert "no equilibrium" in result.stderr
    assert "Traceback" not in result.stderr
    assert not (folder / "study-run").exists()


@pytest.mark.parametrize("command", ["check", "run", "modes", "actuator"])
def test_files_that_are_none(flexapod, folder, command):
    (folder / "folder.toml").mkdir()
    (folder / "latin.toml").write_bytes(b'[robot]\ntype = "6-UPS" # \xe9\xff\n')
    (folder / "empty.toml").write_text("")
    assert refusal(flexapod(command, "nowhere.toml"), "nowhere.toml", "No such file", "flexapod new")
    assert refusal(flexapod(command, "folder.toml"), "folder.toml", "cannot be read", "directory")
    assert refusal(flexapod(command, "latin.toml"), "latin.toml", "not UTF-8 text")
    assert refusal(flexapod(command, "empty.toml"), "empty.toml", "neither [robot] nor [actuator]")


def test_wrong_kind_of_study(flexapod, study):
    assert refusal(flexapod("actuator", study()), "study.toml: is the study of a robot", "`flexapod run study.toml`")
    actuator = study(preset="paper-actuator")
    assert refusal(flexapod("modes", actuator, "--pose", "roll=1deg"), "--pose", "a single actuator", "Leave it out")


def test_actuator_that_leaves_its_hub(flexapod, study):
    file = study(('duration = "10 s"', 'duration = "20 s"'), preset="paper-actuator")
    for command in ("check", "actuator", "run"):
        assert refusal(flexapod(command, file), "leaves the hub at t = 18.3", "motion.extension")


@pytest.mark.parametrize(
    "pose, words",
    [
        ("rol=20deg", ["--pose = rol=20deg", "surge, sway", "Did you mean 'roll'?"]),
        ("roll", ["is not an axis with its value"]),
        ("roll=20 kg", ["--pose roll = 20 kg", "is not an angle"]),
        ("roll=1deg,roll=2deg", ["is given twice"]),
        ("heave=inf", ["is not finite"]),
        ("heave=1m", ["pose", "longer than its stroke allows"]),
    ],
)
def test_bad_pose(flexapod, study, pose, words):
    assert refusal(flexapod("modes", study(), "--pose", pose), *words)


def test_unknown_command_and_option(flexapod):
    for arguments in (("swep",), ("run",), ("check", "a.toml", "--unknown")):
        result = flexapod(*arguments)
        assert result.exit_code == 2
        assert result.stdout == ""


@pytest.mark.parametrize("command", ["check", "run", "modes"])
def test_errors_as_json(flexapod, study, command):
    result = flexapod(command, study(('mass = "100 kg"', 'mass = "-100 kg"')), "--json")
    assert result.exit_code == 2
    assert result.stdout == ""
    error = json.loads(result.stderr)["error"]
    assert error["kind"] == "input"
    assert (error["file"], error["key"], error["value"]) == ("study.toml", "payload.mass", "-100 kg")
    assert error["exit_code"] == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("run", "--json"), "Missing argument 'FILE'"),
        (("check", "a.toml", "--unknown", "--json"), "No such option: --unknown"),
        (("modes", "a.toml", "--count", "0", "--json"), "--count"),
        (("swep", "--json"), "No such command 'swep'"),
    ],
)
def test_a_wrong_command_line_as_json(flexapod, arguments, words):
    """Where JSON was asked for, the command line's own errors came as a box of text."""
    result = flexapod(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    error = json.loads(result.stderr)["error"]
    assert (error["kind"], error["exit_code"]) == ("input", 2)
    assert words in error["what"]
    assert "--help" in error["next_step"]


@pytest.mark.parametrize(
    ("command", "option", "value"),
    [("export", "--count", "0"), ("export", "--elements", "1"), ("converge", "--accuracy", "3")],
)
def test_errors_name_the_option_that_was_typed(flexapod, study, command, option, value):
    """`--count 0` was refused as "modes = 0", the keyword of the Python call behind it."""
    result = flexapod(command, study(), option, value)
    assert refusal(result, f"Error: {option} = {value}")
    assert json.loads(flexapod(command, study(), option, value, "--json").stderr)["error"]["key"] == option
    assert refusal(flexapod("new", "a.toml", "--preset", "papr-robot"), "Error: --preset = papr-robot", "Did you mean")
