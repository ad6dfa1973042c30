"""The rigid path as series: against the same path solved instant by instant, at jumps, and where legs do not reach."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.model import Load, StepWrench, Study
from flexapod.solve.statics.ideal_robot import rigid_errors, rigid_forces
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.consistency

EXAMPLES = Path(__file__).parents[2] / "examples" / "mechanisms"
NAMES = ("tripod", "delta", "tricept", "hexaglide", "planar")


def _study(name: str) -> Study:
    return fx.load(EXAMPLES / f"{name}.toml")


def _near(found: Array, expected: Array, allowed: float) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=allowed * max(np.abs(expected).max(), 1e-9))


@pytest.mark.parametrize("name", NAMES)
def test_places_forces_and_errors_are_those_of_the_instants(name: str) -> None:
    study = _study(name)
    path = RigidPath(
        study.replace(load=Load(wrench=StepWrench(amplitude=(30.0, -20.0, 50.0, 1.0, 2.0, 0.5), time=0.1234567)))
    )
    exact = path.series.exact(path.time)
    assert path.is_commanded
    for part, allowed in (("position", 1e-14), ("rotation", 1e-14), ("velocity", 1e-13), ("acceleration", 1e-13)):
        _near(getattr(path.poses, part), getattr(exact.poses, part), allowed)
    for coordinate in COORDINATES:
        for found, expected in zip(path.legs.coordinate(coordinate), exact.legs.coordinate(coordinate), strict=True):
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * max(1.0, np.abs(exact.legs.accel).max()))
    expected = rigid_forces(exact, path.wrench)
    size = np.abs(expected.joint_force).max()
    np.testing.assert_allclose(path.forces.joint_force, expected.joint_force, rtol=0, atol=1e-13 * size)
    np.testing.assert_allclose(path.forces.drive_force, expected.drive_force, rtol=0, atol=1e-13 * size)
    assert path.forces.open_forces == expected.open_forces
    _near(path.displacement_by_error, rigid_errors(exact), 1e-12)
    _near(path.singularity.smallest_singular_value, exact.singularity.smallest_singular_value, 1e-12)


@pytest.mark.parametrize(("profile", "duration"), [("linear", 0.5), ("trapezoid", 0.5), ("trapezoid", 0.39)])
def test_at_jumps_the_value_is_that_of_the_instant(profile: str, duration: float) -> None:
    """Phases of 0.39 s end, in their own numbers, a bit after the knot between them."""
    study = _study("tripod")
    path = RigidPath(study.replace(motion=study.motion.replace(profile=profile, duration=duration)))
    t = np.unique(np.concatenate([path.time, path.series.knots]))
    found, exact = path.series.at(t), path.series.exact(t)
    assert found.moved is not None
    _near(found.legs.rate, exact.legs.rate, 1e-13)
    _near(found.legs.accel, exact.legs.accel, 1e-12)


def test_instants_outside_of_the_path_are_solved_there() -> None:
    series = RigidPath(_study("tripod")).series
    _ = series.at(np.linspace(0.0, series.duration, 2001))
    beyond = np.linspace(series.duration, series.duration + 0.5, 7)
    np.testing.assert_array_equal(series.at(beyond).poses.position, series.exact(beyond).poses.position)


def test_a_path_out_of_reach_is_refused_in_the_words_of_its_instants() -> None:
    study = _study("hexaglide")
    amplitudes = {axis: (1 if axis == "yaw" else 12) * value for axis, value in study.motion.amplitudes.items()}
    far = study.replace(motion=study.motion.replace(amplitudes=amplitudes))
    path = RigidPath(far)
    with pytest.raises(InputError) as refused:
        check_path(far, path)
    exact = kinematics.rigid_poses(far.robot, far.motion, path.time).reach
    assert not list(path.coarse_paths) and exact.lost.any()
    assert f"t = {path.time[np.argmax(exact.lost)]:.6g} s" in str(refused.value)
    assert not path.series.has_series


def test_checks_march_and_results_share_what_was_made(monkeypatch: pytest.MonkeyPatch) -> None:
    study, asked = _study("tripod"), []
    groups = kinematics.PathSeries._groups

    def counted(self: kinematics.PathSeries, t: Array) -> list[Array]:
        asked.append(len(t))
        return groups(self, t)

    monkeypatch.setattr(kinematics.PathSeries, "_groups", counted)
    path = RigidPath(study)
    check_path(study, path)
    made = sum(asked)
    assert made <= 160
    for chunk in prepare(study, path=path.series).chunks:
        assert len(path.at(chunk.recording.time).poses) == len(chunk.recording.time)
    assert sum(asked) == made
