"""Real parts in Exudyn against ours: joints that give way, springs, screws with rotors; and what its model refuses."""

import numpy as np
import pytest

from flexapod import model
from flexapod.analysis.simulation import simulate
from flexapod.common.errors import InputError
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.spring import AxialSpring
from flexapod.verification.cases.exudyn_parts import LOOP, MOTION, with_dampers
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.engines.exudyn_integration import Integration
from flexapod.verification.engines.exudyn_robot import simulate_robot

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(not EXUDYN.is_available(), reason="needs Exudyn")]

STEP, DURATION = 5e-4, 0.2
HEXAPOD = model.preset("machine-hexapod").robot


def compared(robot):
    """Deviations by Exudyn and by us, pistons rigid, (T, 3) each."""
    theirs = simulate_robot(robot, MOTION, Integration(duration=DURATION, step=STEP), elements=0)
    ours = simulate(robot, MOTION, fidelity="rigid", step=STEP, output_step=STEP, duration=DURATION)
    return theirs.com_deviation, ours.com_deviation.values


def alone(**parts):
    """The robot with one of its parts, on prescribed strokes unless there is a drive."""
    ideal = {"base_joint": Joint(), "platform_joint": Joint(), "springs": (), "drive": model.PrescribedDrive()}
    robot = with_dampers(HEXAPOD)
    return robot.replace(legs=tuple(leg.replace(**ideal | parts) for leg in robot.legs))


SOFT = with_dampers(HEXAPOD).legs[0].base_joint
PLAIN = model.JointFriction(mu=0.1, diameter=0.05)
RUBS = model.JointFriction(moment=10.0)
SPRING = AxialSpring(name="bracket", stiffness=5e7, damping=1e4)
OIL = model.HydraulicDrive(bore=0.16, rod=0.06, stroke=0.5, bottom=0.1, dead_volume=1e-4, bulk_modulus=1.4e9)


@pytest.mark.parametrize(
    "robot",
    [
        alone(base_joint=SOFT),
        alone(platform_joint=SOFT),
        alone(springs=(SPRING,)),
        alone(springs=(SPRING.replace(at="base"), SPRING.replace(name="other", at="platform"))),
        alone(springs=(SPRING,), drive=model.ServoDrive(stiffness=1e8, damping=1e4)),
        alone(drive=with_dampers(HEXAPOD).legs[0].screw),
        alone(drive=with_dampers(HEXAPOD, command="servo", loop=LOOP).legs[0].screw),
        alone(springs=(SPRING,), drive=OIL),
        alone(base_joint=SOFT.replace(friction=RUBS), platform_joint=SOFT.replace(friction=RUBS)),
        alone(drive=with_dampers(HEXAPOD).legs[0].screw.replace(friction=model.ScrewFriction(torque=0.8))),
    ],
    ids=["base", "platform", "nut", "ends", "servo", "screw", "loop", "oil", "joint friction", "screw friction"],
)
def test_a_part_alone_moves_the_robot_alike(robot):
    # Both integrate with the same method and step. Theirs takes rates of commands as central differences, wrong by
    # (w h)^2 / 6 in the dampers, 1e-3 at a frequency of 30 Hz; the sag has no such error but k at the commanded length,
    # wrong by the deviation over the nut's distance, 1e-5 / 0.3.
    theirs, ours = compared(robot)
    assert ours[0] == pytest.approx(theirs[0], abs=1e-4 * np.abs(theirs[0]).max())
    assert ours == pytest.approx(theirs, abs=1e-3 * np.abs(theirs).max())


def lossy(leg):
    return leg.replace(springs=(AxialSpring(name="bracket", stiffness=1e8, loss=0.1),))


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (lossy, "bracket.loss"),
        (lambda leg: leg.replace(base_joint=Joint(bending=10.0)), "base_joint"),
        (lambda leg: leg.replace(base_joint=Joint(friction=PLAIN)), "base_joint.friction"),
        (lambda leg: leg.replace(base_joint=Joint(stiffness=np.diag([1e8, 2e8, 1e8, 0, 0, 0]))), "base_joint"),
        (lambda leg: leg.replace(piston=leg.piston.replace(bow=1e-4)), "bow, eccentricity"),
        (lambda leg: leg.replace(drive=HEXAPOD.legs[0].screw.replace(command="torque")), "drive"),
    ],
)
def test_parts_that_its_model_lacks_are_refused(change, key):
    robot = alone()
    robot = robot.replace(legs=(change(robot.legs[0]), *robot.legs[1:]))
    with pytest.raises(InputError) as refused:
        simulate_robot(robot, MOTION, Integration(duration=DURATION), elements=0)
    assert refused.value.key == f"leg 1: {key}"


def test_a_machine_as_built_is_not_the_one_of_its_model():
    robot = with_dampers(HEXAPOD).replace(heat=HEXAPOD.heat)
    with pytest.raises(InputError, match="as it is drawn"):
        simulate_robot(robot, MOTION, Integration(duration=DURATION), elements=0)
