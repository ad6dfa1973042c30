"""Marches of robots and actuators collected into arrays, for tests."""

from functools import lru_cache

import numpy as np
from tests.helpers.layouts import layout

from flexapod.mechanics.leg.layout import LEG_PARAMETERS
from flexapod.mechanics.shapes import axial_basis, lateral_basis
from flexapod.model import override, preset
from flexapod.solve.kernel import interpreted_kernel
from flexapod.solve.time.actuator_march import prepare_actuator
from flexapod.solve.time.robot_march import prepare

FIELDS = ("time", "q", "v", "v_dot", "lam", "drive", "pose", "reaction", "energy", "sums", "closure", "friction")


def collect(chunks):
    """All chunks of a march as one dictionary of arrays."""
    recordings = [chunk.recording for chunk in chunks]
    return {name: np.concatenate([getattr(r, name) for r in recordings]) for name in FIELDS}


def run_robot(study, state=None):
    return collect(prepare(study, state).chunks)


def run_actuator(study, amplitudes=None, rates=None):
    return collect(prepare_actuator(study, amplitudes, rates).chunks)


def paper_robot(*, profile="quintic", start="equilibrium", motion=None, leg=None, **simulation):
    """The preset `paper-robot` with another profile, motion, start, other parts of legs and settings."""
    study = preset("paper-robot")
    moved = study.motion.replace(profile=profile, **(motion or {}))
    study = study.replace(motion=moved, initial=study.initial.replace(start=start))
    study = override(study, **simulation) if simulation else study
    return with_legs(study, **leg) if leg else study


def with_legs(given, change=None, **parts):
    """The study, or robot, with every leg replaced by `change(leg)`, or with other parts."""
    robot = getattr(given, "robot", given)
    robot = robot.replace(legs=tuple(change(leg) if change else leg.replace(**parts) for leg in robot.legs))
    return given.replace(robot=robot) if hasattr(given, "robot") else robot


def balance(run):
    """Constant of the energy balance, (T,) [J]."""
    return run["energy"].sum(axis=1) + run["sums"][:, 0] - run["sums"][:, 1:].sum(axis=1)


def leg_vector(**values):
    """Parameters of one leg as kernels read them; what is not given is zero, its home frame the world's."""
    values = {"R0": np.eye(3).ravel()} | values
    return np.concatenate([np.ravel(values.get(name, np.zeros(size))) for name, size in LEG_PARAMETERS])


@lru_cache(maxsize=16)
def uncompiled(basis, modes, axial_modes, *, planar=False):
    """Functions of a leg for tests that call them a few times: no C compiler need run for that."""
    lateral = lateral_basis(basis, modes)
    other = lateral_basis(basis, 0) if planar else lateral
    meeting = {"planar": True, "closure": "none", "tip_body": True} if planar else {}
    return interpreted_kernel(layout(a=lateral, b=other, axial=axial_basis(axial_modes), **meeting))


@lru_cache(maxsize=16)
def uncompiled_kernel(shapes):
    """Functions of a robot for tests that need few matrices: no C compiler need run for that."""
    return interpreted_kernel(shapes)
