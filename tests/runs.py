"""Marches of robots and actuators collected into arrays, for tests."""

import numpy as np

from flexapod.model import override, preset
from flexapod.solve.actuator_march import prepare_actuator
from flexapod.solve.robot_march import prepare

FIELDS = ("time", "q", "v", "v_dot", "lam", "drive", "pose", "energy", "sums", "closure")


def collect(chunks):
    """All chunks of a march as one dictionary of arrays."""
    recordings = [chunk.recording for chunk in chunks]
    return {name: np.concatenate([getattr(r, name) for r in recordings]) for name in FIELDS}


def run_robot(study, state=None):
    return collect(prepare(study, state).chunks)


def run_actuator(study, amplitudes=None, rates=None):
    return collect(prepare_actuator(study, amplitudes, rates).chunks)


def paper_robot(*, profile="quintic", start="equilibrium", **simulation):
    """The preset `paper-robot` with another profile, start or simulation settings."""
    study = preset("paper-robot")
    study = study.replace(motion=study.motion.replace(profile=profile), initial=study.initial.replace(start=start))
    return override(study, **simulation) if simulation else study


def with_legs(study, change):
    """The study with every leg replaced by `change(leg)`."""
    legs = tuple(change(leg) for leg in study.robot.legs)
    return study.replace(robot=study.robot.replace(legs=legs))


def balance(run):
    """Constant of the energy balance, (T,) [J]."""
    return run["energy"].sum(axis=1) + run["sums"][:, 0] - run["sums"][:, 1] - run["sums"][:, 2]
