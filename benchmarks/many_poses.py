"""Many poses at once: modes and error budgets of flexible robots, and the closed forms of the rigid one."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from benchmarks.report import Section, goal
from benchmarks.timing import interleaved
from flexapod import kinematics
from flexapod.analysis import budget, modes
from flexapod.design.maps import workspace_map
from flexapod.model import preset

__all__ = ["many_poses"]

COMMAND = "python -m benchmarks many-poses"
POSES, RIGID_POSES, REPEATS = 1000, 100_000, 5


def many_poses() -> list[Section]:
    """One section, processor time."""
    study = preset("paper-robot")
    robot = study.robot
    reach = np.array([0.04, 0.04, 0.04, 0.15, 0.15, 0.15])  # m, rad: well inside the strokes
    some = np.random.default_rng(1).uniform(-reach, reach, size=(POSES, 6))
    path = kinematics.poses(robot, study.motion, np.linspace(0.0, 1.0, RIGID_POSES))
    machine = preset("machine-hexapod").robot
    slice_ = {"surge": np.linspace(-0.02, 0.02, 40), "heave": np.linspace(-0.02, 0.02, POSES // 40)}
    budget(machine)  # compiles
    actions: dict[str, Callable[[], object]] = {
        "modes": lambda: modes(robot, some),
        "budget": lambda: budget(machine),
        "map": lambda: workspace_map(machine, slice_, budget=True),
        "lengths": lambda: kinematics.leg_lengths(
            robot.base_joints, robot.platform_joints, path.position, path.rotation
        ),
        "state": lambda: kinematics.inverse_kinematics(robot, path),
        "forces": lambda: kinematics.inverse_dynamics(robot, path),
    }
    times = interleaved({name: (lambda a=a: _seconds(a)) for name, a in actions.items()}, REPEATS)
    middle = {name: spread.median for name, spread in times.items()}
    rows = [
        [f"modes of {POSES} poses, fx.modes, k = 3", times["modes"].text(), goal(middle["modes"], 2.0, "2 s")],
        ["error budget of machine-hexapod at a pose", times["budget"].text(), goal(middle["budget"], 0.05, "50 ms")],
        [f"map of {POSES} poses of it with budgets", times["map"].text(), goal(middle["map"], 10.0, "10 s")],
        _rate("leg lengths, rigid.leg_lengths", middle["lengths"], 1e6),
        _rate("lengths, joint angles, rates, accelerations, rigid.inverse_kinematics", middle["state"], 2e5),
        _rate("drive and joint forces, rigid.inverse_dynamics, kinematics included", middle["forces"], 1e5),
    ]
    return [
        Section(
            title="Many poses",
            command=COMMAND,
            header=["what", "cost", "goal"],
            rows=rows,
            remarks=[f"Medians of {REPEATS} interleaved runs on one core; rigid: {RIGID_POSES} poses at once."],
        )
    ]


def _seconds(action: Callable[[], object]) -> float:
    begin = time.process_time()
    action()
    return time.process_time() - begin


def _rate(words: str, seconds: float, wanted: float) -> list[str]:
    rate = RIGID_POSES / seconds
    return [words, f"{rate:.3g} poses/s", goal(rate, wanted, f"{wanted:.0e} poses/s", at_least=True)]
