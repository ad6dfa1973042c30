"""`flexapod keys`: every key of a study file, in the terminal, as JSON and as a page."""

import json
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from flexapod.app.cli.cli import app
from flexapod.common.tables.key_rows import list_entries
from flexapod.model.file.page import study_file_page

pytestmark = pytest.mark.cli

RUN = CliRunner()


def test_a_table_with_its_keys_and_examples():
    found = RUN.invoke(app, ["keys", "leg.drive"])
    assert found.exit_code == 0
    assert "[leg.drive] servo" in found.stdout
    assert 'drive = { type = "servo", stiffness = "50 N/um", damping = "20 kN s/m"' in found.stdout
    assert "[leg.drive.feedback]" in found.stdout
    assert "[leg.piston]" not in found.stdout


def test_json_has_every_table():
    found = json.loads(RUN.invoke(app, ["keys", "--json"]).stdout)
    assert {item["entry"]["table"] for item in found} >= {"robot", "leg.drive", "motion", "actuator", "simulation"}
    assert {row["key"] for item in found for row in item["rows"]} >= {"home_height", "amplitudes", "rho_inf"}


def test_a_table_that_does_not_exist_is_refused():
    found = RUN.invoke(app, ["keys", "leg.drve"])
    assert found.exit_code == 2
    assert "Did you mean 'leg.drive'?" in found.stderr


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ("nut", "Did you mean 'leg.drive.nut'?"),
        ("stribeck", "'leg.base_joint.friction.stribeck' or "),
        ("home_height", "`flexapod keys robot`"),
        ("leg.drive.nut.preload", "`flexapod keys leg.drive.nut`"),
        ("piston.diamter", "the key leg.piston.diameter? `flexapod keys leg.piston`"),
        ("leg.dirve", "Did you mean 'leg.drive'?"),
        ("pistn", "Did you mean 'leg.piston'?"),
        ("qqqqqq", "`flexapod keys` lists all"),
    ],
)
def test_the_last_name_of_a_table_or_a_key_is_enough_to_find_it(wrong, words):
    """Once seventy names, and not the one that was meant."""
    told = RUN.invoke(app, ["keys", wrong]).stderr
    assert words in told and len(told) < 500, told


def test_a_wrong_table_is_answered_without_the_model():
    """The model takes most of a second to load, and is not needed for it: no module of it is."""
    code = (
        "import sys; from flexapod.app.cli.commands_study import check_table\n"
        "from flexapod.common.errors import InputError\n"
        "try: check_table('nut')\n"
        "except InputError: print([name for name in sys.modules if name.startswith('flexapod.model')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_all_keys_are_listed_without_the_model():
    """Once all of them were tried out for it, in two seconds."""
    code = (
        "import sys; from typer.testing import CliRunner; from flexapod.app.cli.cli import app\n"
        "assert CliRunner().invoke(app, ['keys']).exit_code == 0\n"
        "print([name for name in sys.modules if name.startswith('flexapod.model')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_part_of_the_page_is_as_in_the_whole():
    part = [item for item in list_entries() if f"{item.entry.table}.".startswith("leg.drive.")]
    assert list_entries("leg.drive") == part and len(part) > 10


def test_the_page_is_written(tmp_path):
    assert RUN.invoke(app, ["keys", "--markdown", str(tmp_path / "page.md")]).exit_code == 0
    assert (tmp_path / "page.md").read_text(encoding="utf-8") == study_file_page()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--markdown", "a.md", "--schema", "a.md"], "is that of --markdown, too"),
        (["control", "--markdown", "a.md"], "which has all tables"),
    ],
)
def test_files_have_all_tables_and_are_two(flexapod, folder, arguments, words):
    said = flexapod("keys", *arguments)
    assert said.exit_code == 2 and words in said.stderr
    assert not list(folder.iterdir())
