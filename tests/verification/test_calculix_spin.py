"""The spin that universal joints impose on the legs, by CalculiX: only where they are well turned, so in no case."""

import numpy as np
import pytest

from flexapod import kinematics, modes
from flexapod.analysis.results.arguments import as_pose
from flexapod.model import Study, preset
from flexapod.output.exchange.pose_deck import abaqus_deck
from flexapod.verification.engines import calculix
from flexapod.verification.engines.engine import CALCULIX

pytestmark = pytest.mark.consistency

POSE = (0.35, 0.1, -0.05, 0.0, 0.0, 0.3)


def turned_robot(axial_inertia):
    """Legs with long and heavy inner parts, no stroke limits, no gravity."""
    study = preset("paper-robot")
    assert isinstance(study, Study)
    robot = study.robot.replace(gravity=[0, 0, 0])
    leg = robot.legs[0]
    cylinder = leg.cylinder.replace(inertia=0.05, axial_inertia=axial_inertia)
    piston = leg.piston.replace(length=0.95)
    return robot.replace(legs=[leg.replace(cylinder=cylinder, piston=piston, stroke=None)] * 6)


@pytest.mark.skipif(not CALCULIX.is_available(), reason=f"CalculiX is not installed: {CALCULIX.install}")
def test_axial_inertia_shifts_frequencies_alike():
    """What it shifts hardly depends on mesh and shear, which themselves are below 1e-3 of a frequency."""
    robots = [turned_robot(inertia) for inertia in (0.0, 0.1)]
    beta = kinematics.inverse_kinematics(robots[0], as_pose(robots[0], POSE)).beta
    assert np.abs(beta).max() > np.deg2rad(15.0)
    ours = [modes(robot, POSE, modes=5).frequency.values[:12] for robot in robots]
    theirs = [calculix.run(abaqus_deck(robot, POSE, elements=12, modes=14)).frequencies()[:12] for robot in robots]
    shift, found = (f[1] / f[0] - 1 for f in (ours, theirs))
    assert shift.min() < -1e-2
    # 1e-3 of the coupling of bending and spin; printing of seven digits
    np.testing.assert_allclose(found, shift, rtol=1e-2, atol=2e-5)
