"""`flexapod check`: validate a study and describe it in words, without a simulation."""

from __future__ import annotations

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json, StudyFile

__all__ = ["add"]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("check")(check)


@guarded
def check(file: StudyFile, json: Json = False) -> None:
    """Validate a study and say in words what it asks of its legs: lengths, strokes, loads, stiffness, frequencies."""
    from flexapod.app.check_actuator import show_actuator
    from flexapod.app.check_robot import show_robot
    from flexapod.app.terminal import print_json
    from flexapod.model import load
    from flexapod.study.before.describe.robot import RobotDescription, describe

    found = describe(load(file))
    if json:
        print_json(found.as_dict())
    elif isinstance(found, RobotDescription):
        show_robot(found)
    else:
        show_actuator(found)
