"""What is computed, or loaded, only once or not at all."""

import pickle
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.description import residual_vibration
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.results.variables import COORDINATES, VARIABLES, dataset
from flexapod.kinematics import robot as of_robot

pytestmark = pytest.mark.unit


def test_home_frames_are_computed_once_for_equal_robots(monkeypatch):
    calls = []
    plain = of_robot.limbs
    monkeypatch.setattr(of_robot, "limbs", lambda *given, **more: calls.append(1) or plain(*given, **more))
    robot = fx.preset("paper-robot").robot.replace(home_height=0.8871)
    path = kinematics.home_pose(robot)
    for subject in (robot, robot, pickle.loads(pickle.dumps(robot)), robot.replace(home_height=0.8871)):
        kinematics.home_frames(subject)
        kinematics.inverse_dynamics(subject, path)
    assert len(calls) == 1
    kinematics.home_frames(robot.replace(home_height=0.8872))
    assert len(calls) == 2


def test_nobody_can_change_frames_that_others_use():
    with pytest.raises(ValueError, match="read-only"):
        kinematics.home_frames(fx.preset("paper-robot").robot)[0, 0, 0] = 2.0


def test_a_copy_with_another_value_has_its_own_hash():
    robot = fx.preset("paper-robot").robot
    before = hash(robot)
    for other in (robot.replace(home_height=0.95), robot.model_copy(update={"home": robot.home.raised(0.95)})):
        assert hash(other) != before
        assert other != robot
    assert "hash" not in robot.model_dump()


def test_the_hash_of_another_process_is_not_taken_over():
    """Texts hash differently in every process; a robot that brought its hash along would not be found again."""
    code = (
        "import pickle, sys; import flexapod as fx; r = fx.preset('paper-robot').robot; hash(r); "
        "sys.stdout.buffer.write(pickle.dumps(r))"
    )
    sent = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True).stdout
    robot = fx.preset("paper-robot").robot
    assert pickle.loads(sent) == robot
    assert hash(pickle.loads(sent)) == hash(robot)


def test_a_study_without_other_settings_is_itself_and_results_say_whose_they_are():
    study, stiff = fx.preset("paper-robot"), {"basis": "clamped-free"}
    assert fx.model.override(study) is study
    seen = [fx.stiffness(one, **more).study_hash for one, more in ((study, {}), (study, stiff), (study, {}))]
    higher = study.replace(robot=study.robot.replace(home_height=0.95))
    assert seen[0] == seen[2] != seen[1]
    assert fx.stiffness(higher).study_hash not in seen
    assert fx.stiffness(fx.preset("paper-robot")).study_hash == seen[0]


def test_a_study_is_described_with_each_pose_solved_once_and_no_time_integration(monkeypatch):
    poses, plain = [], residual_vibration.single_pose_modes
    monkeypatch.setattr(residual_vibration, "single_pose_modes", lambda locked: poses.append(locked) or plain(locked))
    assert describe(fx.preset("paper-robot")).vibration is not None
    assert len(poses) == 2  # the start and the end, whose modes the vibration takes
    code = (
        "import sys, flexapod.analysis.description.robot_description; "
        "print([x for x in sys.modules if x.startswith('flexapod.solve.time')])"
    )
    assert (
        subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.strip() == "[]"
    )


def test_a_dataset_is_the_one_that_xarray_would_make():
    t = np.linspace(0.0, 1.0, 5)
    values = {"com_position": np.ones((5, 3)), "leg_length": np.ones((5, 6)), "kind": ["bending", "axial"]}
    found = dataset(values, {"time": t, "mode": np.arange(1, 3)}, {"a": 1})
    attrs = {name: {"units": VARIABLES[name].units, "long_name": VARIABLES[name].long_name} for name in values}
    plain = xr.Dataset(
        {name: (VARIABLES[name].dims, values[name], attrs[name]) for name in values},
        coords={
            "axis": ("axis", *COORDINATES["axis"][:1], {"long_name": COORDINATES["axis"][1]}),
            "leg": ("leg", np.arange(1, 7), {"long_name": "leg"}),
            "time": ("time", t, {"units": "s", "long_name": "time"}),
            "mode": ("mode", np.arange(1, 3), {"long_name": "mode"}),
        },
        attrs={"a": 1},
    )
    xr.testing.assert_identical(found, plain)
    assert {n: v.dtype for n, v in found.variables.items()} == {n: v.dtype for n, v in plain.variables.items()}
    assert found.sel(leg=3, axis="z").com_position.shape == (5,)


def test_a_first_dataset_needs_neither_units_nor_clusters():
    """Loading pint and dask took a third of the time from a cold start to a finished simulation."""
    code = (
        "import sys, numpy as np, flexapod as fx; fx.preset('paper-robot'); fx.simulate; "
        "from flexapod.analysis.results.variables import dataset; "
        "dataset({'com_position': np.zeros((2, 3))}, {'time': np.arange(2.0)}); "
        "print([m for m in ('pint', 'dask', 'scipy.optimize', 'matplotlib', 'casadi', 'skfem') if m in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert found.stdout.strip() == "[]"
