"""A drive that is a spring without a damper is remarked on."""

import pytest
from tests.helpers.sweeps import quick

from flexapod import model

pytestmark = pytest.mark.unit


def with_drive(drive):
    robot = quick().robot
    return robot.replace(legs=tuple(leg.replace(drive=drive) for leg in robot.legs))


@pytest.mark.parametrize(
    ("drive", "key"),
    [
        (model.ServoDrive(stiffness=1e7), "leg.drive.damping"),
        (model.ForceDrive(feedback=model.Feedback(stiffness=1e7)), "leg.drive.feedback.damping"),
    ],
)
def test_a_spring_without_damper_is_remarked_on(drive, key):
    """0.2 sqrt(1e7 N/m 100 kg / 6) = 2582 N s/m."""
    remarks = quick().replace(robot=with_drive(drive)).warnings
    assert len(remarks) == 1 and remarks[0].startswith("all legs: the ")
    assert f"no damping: what once vibrates on it goes on; {key} = 2600 N s/m" in remarks[0]


@pytest.mark.parametrize(
    "drive",
    [
        model.PrescribedDrive(),
        model.ServoDrive(stiffness=1e7, damping=1.0),
        model.ForceDrive(),
        model.ForceDrive(feedback=model.Feedback(stiffness=0.0)),
    ],
)
def test_others_are_not(drive):
    assert quick().replace(robot=with_drive(drive)).warnings == ()
