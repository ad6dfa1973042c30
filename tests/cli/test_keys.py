"""`flexapod keys`: every key of a study file, in the terminal, as JSON and as a page."""

import json

from typer.testing import CliRunner

from flexapod.app.cli import app
from flexapod.model.page import markdown

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


def test_the_page_is_written(tmp_path):
    assert RUN.invoke(app, ["keys", "--markdown", str(tmp_path / "page.md")]).exit_code == 0
    assert (tmp_path / "page.md").read_text(encoding="utf-8") == markdown()
