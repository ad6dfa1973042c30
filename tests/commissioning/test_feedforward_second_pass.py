"""Errors that the linear model along a path tells of itself, against the march in time of the nonlinear robot."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from tests.helpers.moving import moving

import flexapod as fx
from flexapod.commissioning.feedforward.modal_path import path_vibration
from flexapod.commissioning.feedforward.second_pass import _displaced, error_sentence, linear_error
from flexapod.commissioning.feedforward.shaping import shape_study
from flexapod.kinematics import RigidPoses, poses
from flexapod.kinematics.rotations import matrix
from flexapod.solve.rigid_motion import rigid_motion

pytestmark = pytest.mark.consistency

#: By kind: what is told may differ from the truth by the square of it, or by what the march and the steps err.
PRESETS = ("paper-robot", "tripod", "motion-base")
KINDS = ("3-PUU", "planar 3-PRR")


def study_of(name: str) -> fx.Study:
    if name in PRESETS:
        return fx.preset(name)
    study = moving(name)
    return study.replace(initial=study.initial.replace(start="equilibrium"))


def true_error(study: fx.Study, found) -> float:
    """Largest difference on the way between the tool of the march, less its rest at each pose, and of the model."""
    until = float(found.model.time[-1])
    exact = study.simulation.replace(tolerance=1e-6, step=None, output_step=until / 400, duration=None)
    data = fx.simulate(study.replace(simulation=exact))
    on = data.time.values <= until * (1 + 1e-9)
    t, rest, payload = data.time.values[on], found.model.locked.equilibria.states.pose, study.robot.payload
    there = rest[:, :3] + matrix(rest[:, 3:]) @ (payload.tool - payload.com)
    sag = there - poses(study.robot, study.motion, found.model.time).place(study.robot.tool)
    off = data.tool_deviation.values[on] - CubicSpline(found.model.time, sag, bc_type="clamped")(t)
    linear = CubicSpline(found.time[: len(found.motion)], found.tool[: len(found.motion)])(t)
    return float(np.linalg.norm(off - linear, axis=1).max() / found.largest)


@pytest.mark.parametrize("name", [*PRESETS, *KINDS])
def test_the_error_that_is_told_is_the_true_one(name: str) -> None:
    """To a tenth of it, and what a run within 1e-6 and eight instants in a period leave, 3e-4 of the vibration."""
    study = study_of(name)
    until = study.motion.end_time - study.motion.hold
    found = path_vibration(study, until, until * 1.001)
    told, true = linear_error(study, found), true_error(study, found)
    assert told == pytest.approx(true, rel=0.1, abs=3e-4)
    assert true > 5e-4  # there is something to tell


def test_who_decides_is_said() -> None:
    plain, rubs = fx.preset("paper-robot"), fx.preset("machine-hexapod")
    assert error_sentence(plain, 0.01).endswith("errs by 1 % of the largest distance, by a second pass")
    for told in (error_sentence(plain, 0.06), error_sentence(plain, np.nan), error_sentence(rubs, 1e-4)):
        assert "does not decide" in told
    assert "friction" in error_sentence(rubs, 1e-4)
    assert "friction" not in error_sentence(plain, 0.06)


def test_a_shaped_study_names_its_error() -> None:
    found = shape_study(fx.preset("paper-robot"), "zv")
    assert 1e-4 < found.error < 2e-3
    assert "by a second pass" in found.sentence and "does not decide" not in found.sentence
    assert "does not decide" in shape_study(fx.preset("machine-hexapod"), "zv").sentence


def test_accelerations_on_the_way_are_those_of_the_velocities() -> None:
    """Of a linear motion without acceleration of its own, on a path that turns: by differences in time."""
    study = fx.preset("paper-robot")
    study = study.replace(motion=fx.model.AxisMotion(type="yaw", amplitude=0.2, duration=0.5, hold=0.1))
    at = path_vibration(study, 0.5, 0.51).model
    t = np.linspace(0.0, 0.5, 2001)
    rate = 1e-3 * np.random.default_rng(4).normal(size=at.flat.shape[2])
    z, v = (t - 0.25)[:, None] * rate, np.tile(rate, (len(t), 1))
    rigid = rigid_motion(at.locked.system, RigidPoses(at.locked.robot, poses(study.robot, study.motion, t)))
    moved, still = _displaced(at, t, rigid, z, v)[1], _displaced(at, t, rigid, 0 * z, 0 * v)[1]
    near = np.abs(t - 0.25) < 0.02  # where what is added is small
    for name, rates in (("u", moved.u - still.u), ("v", moved.v - still.v)):
        slope = np.gradient(rates, t, axis=0)[near]
        added = (getattr(moved, f"{name}_dot") - getattr(still, f"{name}_dot"))[near]
        np.testing.assert_allclose(added, slope, rtol=0, atol=2e-2 * np.abs(slope).max())
