"""What every flexible robot must respect: the rigid limit, mirrors and turns."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, run_robot, with_legs

from flexapod import kinematics
from flexapod.model import override

pytestmark = pytest.mark.property


def deviation(study):
    run = run_robot(study)
    path = kinematics.poses(study.robot, study.motion, run["time"])
    return run["pose"][:, :3] - path.position - path.rotation @ study.robot.payload.com


def stiffer(study, factor):
    return with_legs(
        study,
        lambda leg: leg.replace(
            piston=leg.piston.replace(EA=factor * leg.piston.EA, EI=factor * leg.piston.EI, E=None, density=None)
        ),
    )


def test_deviation_falls_as_one_over_E():
    study = override(paper_robot(profile="smooth"), step=1e-3, duration=1.0, modes=2)
    peaks = [np.abs(deviation(stiffer(study, factor))).max() for factor in (10, 100, 1000)]
    # The next term of the expansion in 1/E is smaller by the strain, 1e-5, and by (excitation/eigenfrequency)^2.
    assert peaks[0] / peaks[1] == pytest.approx(10, rel=0.02)
    assert peaks[1] / peaks[2] == pytest.approx(10, rel=0.02)


def transformed(study, T, order, **motion):
    """The study with its geometry mapped by the orthogonal matrix T (about z) and its legs reordered."""
    robot = study.robot
    payload = robot.payload.replace(
        com=T @ robot.payload.com, tool=T @ robot.payload.tool, inertia=T @ robot.payload.inertia @ T.T
    )
    robot = robot.replace(
        base_joints=(robot.base_joints @ T.T)[order],
        platform_joints=(robot.platform_joints @ T.T)[order],
        payload=payload,
    )
    return study.replace(robot=robot, motion=study.motion.replace(**motion))


def flexible_heave_and_load(force):
    from flexapod.model import CombinedMotion

    study = override(paper_robot(), step=1e-3, duration=0.4, modes=2)
    motion = CombinedMotion(amplitudes={"sway": 0.03, "roll": 0.2}, duration=0.3, profile="quintic")
    return study.replace(motion=motion, load=study.load.replace(wrench={"law": "constant", "value": force}))


def test_mirrored_robot_gives_the_mirrored_result():
    # Mirror at x = 0: positions flip x; forces flip Fx; moments (axial vectors) flip My, Mz. Roll and sway stay.
    mirror = np.diag([-1.0, 1.0, 1.0])
    study = flexible_heave_and_load([40, 30, 20, 3, 2, 1])
    other = flexible_heave_and_load([-40, 30, 20, 3, -2, -1])
    other = transformed(other, mirror, list(range(6)))
    a, b = deviation(study), deviation(other)
    # Universal joints of mirrored legs turn about mirrored axes: the spin enters with zero axial inertia only.
    np.testing.assert_allclose(b, a @ mirror, atol=1e-6 * np.abs(a).max())


def test_a_turn_by_120_degrees_permutes_the_legs():
    c, s = np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    study = override(paper_robot(), step=1e-3, duration=0.4, modes=2)
    from flexapod.model import AxisMotion

    study = study.replace(motion=AxisMotion(type="heave", amplitude=0.05, duration=0.3, profile="quintic"))
    turned = study.replace(
        robot=study.robot.replace(
            payload=study.robot.payload.replace(
                com=turn @ study.robot.payload.com, tool=turn @ study.robot.payload.tool
            )
        )
    )
    a, b = run_robot(study), run_robot(turned)
    np.testing.assert_allclose(b["drive"][:, [2, 3, 4, 5, 0, 1], 0], a["drive"][:, :, 0], rtol=1e-6, atol=1e-3)
    np.testing.assert_allclose(b["pose"][:, :3], a["pose"][:, :3] @ turn.T, atol=1e-11)
