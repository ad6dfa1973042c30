"""The path of a study file is accepted wherever a study is; `run` takes a robot with its motion as well."""

import numpy as np
import pytest
from tests.helpers.sweeps import quick, quick_text

import flexapod as fx
from flexapod.design.convergence import converge
from flexapod.design.convergence.ladder import ladder
from flexapod.design.convergence.plan import checked_trials
from flexapod.model import preset_text

pytestmark = pytest.mark.unit

BEAM = preset_text("paper-actuator").replace('duration = "10 s"', 'duration = "10 ms"')


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(quick_text(), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "call",
    [
        fx.run,
        fx.simulate,
        fx.modes,
        fx.stiffness,
        fx.inverse_kinematics,
        fx.inverse_dynamics,
        lambda study: fx.forward_kinematics(study, quick().robot.home_lengths),
        lambda study: fx.workspace_map(study, {"heave": [0.0, 1e-3]}),
        lambda study: fx.sweep(study, {"vary": [{"key": "payload.mass", "values": [100.0]}]}, workers=0),
    ],
    ids=["run", "simulate", "modes", "stiffness", "inverse_kinematics", "inverse_dynamics", "forward_kinematics",
         "workspace_map", "sweep"],
)  # fmt: skip
def test_path_in_place_of_a_study(file, call):
    direct = call(fx.load(file))
    for path in (file, str(file)):
        found = call(path)
        assert set(found.data_vars) == set(direct.data_vars)
        assert found.identical(direct.assign_attrs(found.attrs))
        assert found.attrs.get("study_hash") == direct.attrs.get("study_hash")


def test_convergence_of_a_file(file):
    assert checked_trials(str(file), None).study == fx.load(file)
    for call in (converge, ladder):
        with pytest.raises(fx.InputError, match=r"nowhere\.toml: cannot be read"):
            call("nowhere.toml")


def test_actuator_from_its_file(tmp_path):
    path = tmp_path / "beam.toml"
    path.write_text(BEAM, encoding="utf-8")
    study = fx.load(path)
    for found in (fx.run(str(path)), fx.simulate_actuator(path), fx.run(study)):
        np.testing.assert_array_equal(found.tip_deflection, fx.run(study).tip_deflection)
    solid = {"size": 0.05, "kind": "hex8", "spacing": 0.61, "step": 1e-3}
    direct = fx.simulate_solid(study, **solid)
    np.testing.assert_array_equal(fx.simulate_solid(str(path), **solid).tip_deflection, direct.tip_deflection)


def test_run_of_a_robot_and_a_motion(file):
    study = quick()
    one, other = fx.run(study.robot, study.motion), fx.simulate(study.robot, study.motion)
    np.testing.assert_array_equal(one.com_deviation, other.com_deviation)
    still = study.motion.replace(amplitude=0.0)
    assert np.ptp(fx.run(file, still).com_position_rigid.values, axis=0).max() == 0
    with pytest.raises(fx.InputError, match="Give a motion") as error:
        fx.run(study.robot)
    assert error.value.key == "motion"


@pytest.mark.parametrize("subject", [None, 5, {"robot": 1}])
def test_what_is_neither(subject):
    with pytest.raises(fx.InputError, match=r"flexapod\.load\(FILE\), its \.robot, or FILE itself"):
        fx.run(subject)


def test_a_file_of_the_other_kind_is_told(tmp_path, file):
    path = tmp_path / "beam.toml"
    path.write_text(BEAM, encoding="utf-8")
    with pytest.raises(fx.InputError, match="is neither a robot nor the study of one"):
        fx.stiffness(path)
    with pytest.raises(fx.InputError, match="is neither an actuator nor the study of one"):
        fx.simulate_actuator(file)
