"""`flexapod run` says which step would do when its tolerance made it slow."""

import json

import pytest

from flexapod.surveys.convergence import quicker

SERVO = ('drive = { type = "prescribed" }', 'drive = { type = "servo", stiffness = "10 N/um" }')


@pytest.fixture
def file(study):
    return study(
        SERVO, ('duration = "2 s" ', 'duration = "0.1 s" '), ('fidelity = "assumed-modes"', 'fidelity = "lumped"'),
        ("modes = 3 ", "# "), ("tolerance = 1e-4", "tolerance = 1e-6"),
    )  # fmt: skip


def test_words_and_json(flexapod, file, monkeypatch):
    monkeypatch.setattr(quicker.quicker, "__kwdefaults__", {"slow": 0.0, "progress": None})
    monkeypatch.setattr(quicker, "WORTH", 1.0)  # times are measured: on a machine with other work 4 may read 3
    done = flexapod("run", file, "--no-figures")
    assert done.exit_code == 0, done.stderr
    assert "Slow? In [simulation], step = " in done.stdout and "times faster, with the same result to" in done.stdout
    assert "Warning: all legs: the servo drive has stiffness but no damping" in done.stdout
    found = json.loads(flexapod("run", file, "--no-figures", "--json").stdout)["quicker"]
    assert found["times"] >= 1 and found["difference"] <= 1e-3


def test_a_run_that_is_not_slow_is_not_spoken_of(flexapod, file):
    assert "Slow?" not in flexapod("run", file, "--no-figures").stdout


def test_ctrl_c_while_steps_are_tried_leaves_the_answer(flexapod, file, monkeypatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(quicker, "run", stop)
    monkeypatch.setattr(quicker.quicker, "__kwdefaults__", {"slow": 0.0, "progress": None})
    done = flexapod("run", file, "--no-figures")
    assert done.exit_code == 0 and "misses its rigid path" in done.stdout and "Slow?" not in done.stdout


def test_check_remarks_on_the_servo(flexapod, file):
    done = flexapod("check", file)
    assert "the servo drive has stiffness but no damping" in done.stdout
