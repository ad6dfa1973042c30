"""`flexapod new --from`: a first robot as a user asks for it."""

import json

import pytest

import flexapod as fx

pytestmark = pytest.mark.cli

WISH = "home=300 mm, payload=20 kg, stroke=60 mm"


def test_says_what_it_found_and_passes_check(flexapod, folder):
    done = flexapod("new", "first.toml", "--from", WISH, "--ideal")
    assert done.exit_code == 0, done.stderr
    for words in ("292.9 to 352.9 mm", "pistons 8 mm thick", "Euler load", "lowest frequency", "first.toml written"):
        assert words in done.stdout
    assert WISH in (folder / "first.toml").read_text(encoding="utf-8")
    checked = flexapod("check", "first.toml")
    assert checked.exit_code == 0, checked.stderr
    assert "The path keeps all limits." in checked.stdout
    assert "Ideal, without give: joints, drives, plates;" in checked.stdout.splitlines()[-1]
    assert json.loads(flexapod("check", "first.toml", "--json").stdout)["remarks"] == []


def test_a_machine_of_catalogue_parts_passes_check_and_runs(flexapod, folder):
    for extra in ("", ", drive=hydraulic"):
        done = flexapod("new", "machine.toml", "--force", "--from", WISH + extra)
        assert done.exit_code == 0 and "Remark" not in done.stdout, done.stdout + done.stderr
        checked = flexapod("check", "machine.toml")
        assert checked.exit_code == 0 and checked.stdout.rstrip().endswith("None."), checked.stderr
    written = (folder / "machine.toml").read_text(encoding="utf-8")
    assert 'type = "hydraulic"' in written and "[tolerances]" in written and "[heat]" in written


def test_a_box_of_poses_and_what_is_kept(flexapod, folder):
    wish = "travel=15 mm, tilt=3 deg, payload=25 kg, repeatability=1 um"
    done = flexapod("new", "stage.toml", "--from", wish, "--json")
    assert done.exit_code == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["attainable"] == [] and "Yes: all 3 requirements are kept." in found["remarks"]
    study = fx.load("stage.toml")
    assert study.requirement.repeatability == 1e-6 and abs(study.robot.home_height - 0.1843) < 1e-3
    low = flexapod("new", "low.toml", "--from", f"home=150 mm, {wish}")
    assert low.exit_code == 2 and "home = 184.3 mm" in " ".join(low.stderr.split())


def test_ideal_goes_with_from_alone(flexapod, folder):
    alone = flexapod("new", "a.toml", "--ideal")
    assert alone.exit_code == 2 and "without --from" in alone.stderr
    both = flexapod("new", "a.toml", "--from", f"{WISH}, drive=electric", "--ideal")
    assert both.exit_code == 2 and "given together with --from drive" in both.stderr
    assert list(folder.iterdir()) == []


def test_json_and_remarks(flexapod, folder):
    done = flexapod("new", "light.toml", "--from", "home=2 m, payload=1 kg, motion=yaw", "--ideal", "--json")
    found = json.loads(done.stdout)
    assert (found["file"], found["from"]) == ("light.toml", "home=2 m, payload=1 kg, motion=yaw")
    assert any("the legs weigh" in remark for remark in found["remarks"])
    assert fx.load("light.toml").motion.type == "yaw"


def test_refusals_leave_no_file(flexapod, folder):
    for wish, words in (
        ("home=50 mm, payload=10 t", "at most 1.55 kg"),
        ("hom=1 m", "Did you mean 'home'?"),
    ):
        done = flexapod("new", "a.toml", "--from", wish)
        assert done.exit_code == 2 and words in done.stderr
    both = flexapod("new", "a.toml", "--from", WISH, "--preset", "paper-robot")
    assert both.exit_code == 2 and "given together with --from" in both.stderr
    assert list(folder.iterdir()) == []
