"""Quantities on the command line: one rule. Without a unit a number is in SI, a unit is read where one stands.

The table has every option that takes a word: of a new one the test asks whether it is a quantity.
"""

import json

import pytest
import typer
from tests.helpers.short_runs import BRIEF

from flexapod.app.cli.cli import program

pytestmark = pytest.mark.cli

#: What an option says in SI, in units, and in a unit of something else; more words that the command needs.
QUANTITIES = {
    ("modes", "--pose"): ("roll=0.1,heave=-0.01", "roll=0.1 rad, heave=-10mm", "roll=1 mm"),
    ("frf", "--pose"): ("yaw=0.05", "yaw=50mrad", "yaw=50 N"),
    ("damp", "--pose"): ("surge=2e-3", "surge=2 mm", "surge=2 deg"),
    ("budget", "--pose"): ("heave=0.02", "heave=20 mm", "heave=20 s"),
    ("sensitivity", "--pose"): ("heave=0.02", "heave=20 mm", "heave=20 kg"),
    ("optimise", "--pose"): ("heave=0.02", "heave=20 mm", "heave=20 kg"),
    ("export", "--pose"): ("heave=0.02", "heave=2 cm", "heave=20 kg"),
    ("export", "--step"): ("5e-4", "0.5ms", "0.5 mm"),
    ("frf", "--from"): ("20", "0.02 kHz", "20 s"),
    ("frf", "--to"): ("900", "0.9kHz", "900 rad/s"),
    ("map", "--x"): ("heave=-0.01..0.01:3", "heave=-10..10mm:3", "heave=-10..10deg:3"),
    ("map", "--y"): ("roll=-0.01..0.01:3", "roll=-10..10mrad:3", "roll=-1..1mm:3"),
    ("map", "--z"): ("sway=-0.002..0.002:2", "sway=-2mm..2 mm:2", "sway=-2..2 s:2"),
    ("map", "--at"): ("yaw=0.01", "yaw=10mrad", "yaw=10mm"),
    ("map", "--acceleration"): ("0,0,5", "0, 0, 500 cm/s^2", "0,0,5 m"),
    ("new", "--from"): (
        "home=0.3, payload=20, stroke=0.06, diameter=0.018, duration=0.5",
        "home=300 mm, payload=20 kg, stroke=60 mm, diameter=18mm, duration=500 ms",
        "home=300 kg, payload=20 kg",
    ),
}
MORE = {
    "map": ("--x", "heave=-0.01..0.01:3", "--y", "surge=0..1mm:2"),
    "export": ("--format", "abaqus", "--elements", "4"),
    "frf": ("--points", "5"),
    "sensitivity": ("--key", "payload.mass", "--output", "first_frequency"),
    "optimise": ("design.toml", "--quiet"),
}
DESIGN = """
[[variables]]
key = "leg.piston.diameter"
low = "20 mm"
high = "40 mm"

[objective]
minimise = "piston_mass"

[constraints]
first_frequency = { least = "20 Hz" }
"""
#: Words that are no quantities: names, files, addresses, directions and ratios.
OTHERS = {
    "file", "sweep_file", "name", "table", "--out", "--preset", "--example", "--notebook", "--markdown", "--schema",
    "--format", "--input", "--output", "--inputs", "--outputs", "--drives", "--friction", "--uff", "--mat",
    "--direction", "--scheduler", "--only", "--html", "--fidelity", "--commands", "--host", "--name", "--set",
    "design", "--key",
}  # fmt: skip
#: Numbers that are counts, and two ratios.
NUMBERS = {
    "--count", "--points", "--mode", "--elements", "--workers", "--port", "--accuracy", "--magnify",
}  # fmt: skip


def test_every_option_of_every_command_is_a_quantity_or_known_to_be_none():
    found, flags = set(), set()
    for command, made in typer.main.get_command(program()).commands.items():
        for option in made.params:
            name = option.opts[0]
            if getattr(option, "is_flag", False):
                flags.add(name)
            elif name not in OTHERS | NUMBERS | {"--help"}:
                found.add((command, name))
    assert found == set(QUANTITIES)
    assert "--json" in flags


@pytest.mark.parametrize(("command", "option"), QUANTITIES, ids=lambda word: word.lstrip("-"))
def test_a_number_without_a_unit_is_in_si_and_a_unit_is_read(flexapod, study, folder, command, option):
    """Both ways the same answer, digit for digit; a unit of something else is refused with the option's name."""
    file = study(*BRIEF)
    (folder / "design.toml").write_text(DESIGN, encoding="utf-8")
    bare, with_unit, wrong = QUANTITIES[command, option]
    if option == "--step":
        arguments = (command, file, "--format", "c")
    elif command == "new":
        arguments = (command, "new.toml")
    else:
        given = MORE.get(command, ())
        taken = [k for k in range(0, len(given), 2) if given[k] != option]
        arguments = (command, file, *(x for k in taken for x in given[k : k + 2]))
    answers = []
    for text in (bare, with_unit):
        run = flexapod(*arguments, option, text, "--json", *(("--force",) if command in ("export", "new") else ()))
        assert run.exit_code == 0, run.stderr
        files = [path for path in sorted(folder.rglob("*")) if path.suffix in (".toml", ".inp", ".h", ".c")]
        said = json.loads(run.stdout)
        for name in ("wall_time", "from"):  # the second: as it was typed
            said.pop(name, None)
        answers.append((said, {path.name: without_words(path) for path in files}))
    assert answers[0] == answers[1]
    run = flexapod(*arguments, option, wrong, "--json", *(("--force",) if command in ("export", "new") else ()))
    error = json.loads(run.stderr)["error"]
    assert run.exit_code == 2 and error["key"].startswith(option) and error["allowed"], error


def without_words(path):
    """Lines of a file but those that repeat what was typed."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line for line in lines if not line.startswith("# A first robot, from")]
