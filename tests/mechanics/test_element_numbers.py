"""Numbers of elements are merged in their order: none says a number of one that stands after it, which would win."""

import numpy as np
import pytest
from tests.golden.net import STUDIES, text
from tests.helpers.machines import LAGGING, MOVED, RUBS, SCREW, SPRUNG, THICK, TUBE, machine, study
from tests.helpers.mechanisms import hexapod
from tests.helpers.runs import with_legs

import flexapod as fx
from flexapod import kinematics
from flexapod.mechanics.elements.registry import OURS
from flexapod.mechanics.leg.layout import LEG_PARAMETERS
from flexapod.model import Encoder, Joint
from flexapod.solve.parameters import standings
from flexapod.solve.shapes import robot_shapes

pytestmark = pytest.mark.contract

FLEXES = {"base_joint": Joint(stiffness=np.diag([2e7, 3e7, 5e7, 900.0, 800.0, 300.0]))}
UNKEYED = {"drive": SCREW, "piston": TUBE.replace(keyed=False)}


def real(at, rate):
    """A machine with all that an electric one may have; its loops are closed about a place."""
    drive = LAGGING.replace(encoder=Encoder(at=at, rate=rate))
    robot = machine(drive=drive, base_joint=RUBS, platform_joint=RUBS)
    return study(robot.replace(base_mount=SPRUNG, platform_mount=SPRUNG, base_motion=MOVED), play="gap")


LOOPS = [("rotor", "same"), *((at, rate) for at in ("stroke", "joint-to-joint") for rate in ("same", "rotor"))]
MACHINES = (
    {name: lambda name=name: fx.loads(text(name)) for name in STUDIES}
    | {f"loop about {at}, rate of {rate}": lambda at=at, rate=rate: real(at, rate) for at, rate in LOOPS}
    | {
        "flexures": lambda: study(with_legs(hexapod("FPF"), **FLEXES)),
        "thick": lambda: study(with_legs(hexapod("UPS"), piston=THICK), fidelity="lumped"),
        "nut that turns": lambda: study(with_legs(hexapod("UCU"), **UNKEYED)),
    }
)


def kernel_of(name, at_rest):
    """Layout of a machine's legs, and by leg what each element of it says."""
    given = MACHINES[name]()
    legs = kinematics.robot_limbs(given.robot)
    shapes = robot_shapes(given.robot, given.simulation, legs)
    stand = standings(given.robot, legs, 1e-3, at_rest=at_rest)
    return shapes, [
        [element.numbers(leg, one) for element in shapes.elements]
        for leg, one in zip(given.robot.legs, stand, strict=True)
    ]


@pytest.mark.parametrize("at_rest", [False, True], ids=["moving", "at rest"])
@pytest.mark.parametrize("name", MACHINES)
def test_no_element_says_a_number_of_one_that_stands_after_it(name, at_rest):
    shapes, said = kernel_of(name, at_rest)
    first = {key: -1 for key, _ in (*LEG_PARAMETERS, *shapes.chain.parameters)}
    owners = first | {key: i for i, element in enumerate(shapes.elements) for key, _ in element.parameters}
    for of_leg in said:
        late = {key for i, numbers in enumerate(of_leg) for key in numbers if owners[key] > i}
        assert not late


def test_these_machines_have_every_element_of_ours():
    found = {element.kind for name in MACHINES for element in kernel_of(name, False)[0].elements}
    assert {kind for kind in OURS if kind.parameters} <= found
