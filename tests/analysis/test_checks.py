"""Paths that no robot could follow are refused before anything is computed, in the user's words."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, with_legs
from tests.helpers.samples import sample_text

import flexapod as fx
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.results.rigid_path import path_instants
from flexapod.model import AxisMotion, ForceDrive, base_circle, loads, platform_circle

pytestmark = pytest.mark.unit


def moving(kind, amplitude, **motion):
    return paper_robot().replace(motion=AxisMotion(type=kind, amplitude=amplitude, duration=1.0, **motion))


def half_angles(study, degrees):
    h = np.deg2rad(degrees)
    return study.replace(
        robot=study.robot.replace(base_joints=base_circle(0.25, h), platform_joints=platform_circle(0.15, h))
    )


def refusal(study):
    with pytest.raises(fx.InputError) as error:
        check_path(study)
    assert error.value.exit_code == 2
    assert error.value.next_step
    # The same path is refused by the calls that would compute on it.
    for call in (fx.simulate, fx.inverse_kinematics, fx.inverse_dynamics):
        with pytest.raises(fx.InputError):
            call(study)
    return error.value


def test_the_presets_pass_without_remarks():
    assert check_path(fx.preset("paper-robot")) == []
    assert check_path(fx.preset("paper-robot-radii")) == []


@pytest.mark.parametrize(("side", "amplitude", "limit"), [("max", 0.2, 1.05), ("min", -0.25, 0.7)])
def test_stroke_excess_names_leg_amount_and_time(side, amplitude, limit):
    study = moving("heave", amplitude)
    error = refusal(study)
    assert error.key == f"leg.stroke.{side}"
    length = fx.kinematics.leg_lengths(
        study.robot.base_joints, study.robot.platform_joints, np.array([0, 0, 0.9 + amplitude]), np.eye(3)
    )
    beyond = 1e3 * np.abs(length - limit).max()
    assert f"by {beyond:.2f} mm" in error.what
    assert "at t = 1.000 s" in error.what
    assert "Leg 1" in error.what
    assert "so do legs 2, 3, 4, 5, 6" in error.what


def test_the_worst_leg_is_named():
    study = moving("roll", np.deg2rad(45), pivot=[0, 0, 0])
    study = with_legs(study, stroke={"min": 0.7, "max": 0.97})
    path = fx.kinematics.poses(study.robot, study.motion, np.array([1.0]))
    length = fx.kinematics.leg_lengths(
        study.robot.base_joints, study.robot.platform_joints, path.position, path.rotation
    )[0]  # fmt: skip
    beyond = np.maximum(length - 0.97, 0.7 - length)
    error = refusal(study)
    assert f"Leg {beyond.argmax() + 1} " in error.what
    assert f"by {1e3 * beyond.max():.2f} mm" in error.what


def test_only_one_leg_of_six():
    study = moving("heave", 0.1)
    legs = [leg.replace(stroke={"min": 0.7, "max": 1.0 if i == 3 else 1.1}) for i, leg in enumerate(study.robot.legs)]
    error = refusal(study.replace(robot=study.robot.replace(legs=tuple(legs))))
    assert "Leg 4" in error.what
    assert "so do" not in error.what


def test_pull_out():
    study = with_legs(moving("heave", 0.1), lambda leg: leg.replace(
        stroke=None, piston=leg.piston.replace(length=0.68, EA=leg.piston.EA)))  # fmt: skip
    error = refusal(study)
    assert "pulled out" in error.what
    assert error.key == "leg.piston.length"
    assert "limit 0.9952 m" in error.what  # mouth 0.31518 plus piston


def test_piston_behind_its_joint_is_only_remarked_on():
    study = with_legs(moving("heave", -0.2), stroke=None)
    remarks = check_path(study)
    assert len(remarks) == 6
    assert "behind its universal joint" in remarks[0]
    assert set(remarks) <= set(fx.inverse_kinematics(study).attrs["warnings"].splitlines())


def test_singular_path_is_refused_with_time_and_measure():
    error = refusal(half_angles(paper_robot(), 29.5))
    assert "passes through a singular pose between t = 0.57" in error.what
    assert "smallest singular value" in error.what
    assert error.key == "motion"


def test_architecture_singularity_is_refused_at_once():
    error = refusal(half_angles(moving("heave", 0.01), 30.0))
    assert "singular" in error.what


def test_what_is_singular_from_the_start_is_so_at_its_start():
    """Rounding made one of the instants the most singular: "at t = 0.0145 s"."""
    study = half_angles(moving("heave", 0.02), 30)
    with pytest.raises(fx.InputError, match=r"is singular at t = 0 s, from the start"):
        check_path(study)


def test_near_singular_path_runs_with_a_warning():
    study = half_angles(paper_robot(), 28)
    remarks = check_path(study)
    assert len(remarks) == 1
    assert remarks[0].startswith("the path comes near a singular pose at t = 1 s: smallest singular value 0.017")
    data = fx.simulate(study, fidelity="lumped", step=2e-3, output_step=2e-3)
    assert remarks[0] in data.attrs["warnings"].splitlines()
    assert data.attrs["partial"] == 0


def test_folding_universal_joint_is_refused():
    # The first axis along the leg: the second must turn by 90 degrees at once.
    study = paper_robot()
    axis = study.robot.home_vectors[2]
    legs = [leg.replace(u_axis=axis) if i == 2 else leg for i, leg in enumerate(study.robot.legs)]
    with pytest.raises(fx.InputError, match="leg 3"):
        check_path(study.replace(robot=study.robot.replace(legs=tuple(legs))))


def test_folding_on_the_way_names_leg_and_time():
    # Sideways until the legs lie along their joints' first axes; sin beta is the part of the leg along that axis.
    study = with_legs(moving("sway", 20.0), lambda leg: leg.replace(
        stroke=None, piston=leg.piston.replace(length=25.0), u_axis=[0, 1, 0]))  # fmt: skip
    t = path_instants(study)
    path = fx.kinematics.poses(study.robot, study.motion, t)
    vectors = path.point(study.robot.platform_joints)[0] - study.robot.base_joints
    first_axes = fx.kinematics.home_frames(study.robot)[:, :, 0]
    beta = np.rad2deg(np.arcsin(np.einsum("tli,li->tl", vectors, first_axes) / np.linalg.norm(vectors, axis=-1)))
    k, leg = np.unravel_index(np.abs(beta).argmax(), beta.shape)
    first = t[np.argmax(np.abs(beta[:, leg]) > 85)]
    error = refusal(study)
    assert error.key == "leg.u_axis"
    assert f"leg {leg + 1} folds to beta = {beta[k, leg]:.1f} deg at t = {t[k]:.6g} s" in error.what
    assert f"from t = {first:.6g} s on" in error.what


def test_pure_force_drives_cannot_start_from_equilibrium():
    study = paper_robot(leg={"drive": ForceDrive(law="rigid")})
    with pytest.raises(fx.InputError, match="holds no position"):
        check_path(study)
    assert check_path(study.replace(initial={"start": "moving"})) == []
    with pytest.raises(fx.InputError, match="holds no position"):
        fx.simulate(study)


def test_the_file_is_named(tmp_path):
    file = tmp_path / "far.toml"
    file.write_text(fx.model.preset_text("paper-robot").replace('amplitude = "26.6 deg"', 'amplitude = "70 deg"'))
    study = fx.load(file)  # reading never checks the path
    with pytest.raises(fx.InputError) as error:
        fx.run(study)
    assert str(file) in str(error.value)


def test_actuator_that_leaves_its_hub():
    study = fx.preset("paper-actuator")
    out = study.replace(motion=study.motion.replace(extension={"law": "rate", "rate": 0.5}))
    with pytest.raises(fx.InputError, match=r"leaves the hub at t = 3\.66") as error:
        fx.run(out)
    assert error.value.key == "motion.extension"
    with pytest.raises(fx.InputError, match="wholly into the hub"):
        fx.run(study.replace(motion=study.motion.replace(extension={"law": "rate", "rate": -0.5})))


def test_a_path_is_looked_at_often_enough_and_not_too_often():
    study = paper_robot()
    assert len(path_instants(study)) == 2001
    assert len(path_instants(paper_robot(duration=2.0, output_step=1e-4))) == 20001
    assert len(path_instants(paper_robot(duration=2.0, output_step=1e-6))) == 50001


@pytest.mark.parametrize(
    ("sample", "old", "new", "left"),
    [
        ("tripod", 'type = "3-RPS"', 'type = "3-UPS"', "3 motions"),
        ("hexapod", "damping = 0.005", "damping = 0.005\npassive = true", "6 motions"),
        ("hexaglide", "damping = 0.005", "damping = 0.005\npassive = true", "6 motions"),
    ],
)
def test_too_few_drives_are_named_as_such(sample, old, new, left):
    # Not as a singular path, whose cure would be other joints or another motion.
    text = sample_text(sample)
    error = refusal(loads(text.replace(old, new)))
    assert error.key == "robot.type"
    assert error.what.startswith(f"with all drives locked it still has {left}")
