"""What follows from other fields: numbers by hand, contradictions in words, what is taken away, copies and texts."""

import pickle
from math import pi

import numpy as np
import pytest
from tests.helpers.machines import machine, study
from tests.helpers.samples import sample_study

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.model import (
    MATERIALS,
    Actuator,
    Cylinder,
    Material,
    Payload,
    Piston,
    RollingLaw,
    Simulation,
    Strut,
    Tube,
)  # fmt: skip
from flexapod.model.leg.cylinder import Mounted
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.sections import PistonSection
from flexapod.model.study.disturbance import Disturbance, Floor

pytestmark = pytest.mark.unit

STEEL = MATERIALS["steel"]
BY_HAND = Piston(length=0.6, EA=3e8, EI=1e5, rhoA=12.0, diameter=0.06)
ROUND = Piston.round(length=0.6, section=Tube(diameter=0.06, inner_diameter=0.04), material=STEEL)
PIECES = [PistonSection(length=x, diameter=d, E=2e11, density=7800.0) for x, d in ((0.2, 0.06), (0.4, 0.05))]
STEPPED = Piston.stepped(PIECES)
TUBE = Cylinder.tube(mouth=0.6, section=Tube(diameter=0.09, inner_diameter=0.07), material=STEEL)
BEAM = Actuator.from_section(section=Tube(diameter=0.03), material=STEEL, length=1.0, free_length=0.5)
LAW = RollingLaw(series="NA49", bore=0.02, load=300.0, loss=0.02)
BODY = {"mass": 10.0, "inertia": [1.0, 1.0, 1.0], "com": [0.0, 0.0, 0.1]}


def by_hand(E, density, outer, inner, length=0.6):
    """EA, EI, rhoA of a tube, and its stiffness [N/um]: formulas of a textbook."""
    area, second = pi / 4 * (outer**2 - inner**2), pi / 64 * (outer**4 - inner**4)
    return (E * area, E * second, density * area), E * area / length / 1e6


@pytest.mark.parametrize(
    ("changes", "made_of", "stiffness", "frequency"),
    [
        # Stiffness to the digits that are given here, computed by hand; the frequency is that of the study whose
        # text has the other number, with step control and modes of no part in it: to its last digit as well.
        ({"diameter": 0.07}, (200e9, 7800.0, 0.07, 0.04), 863.9, 56.031),
        ({"E": 70e9}, (70e9, 7800.0, 0.06, 0.04), 183.3, 51.067),
        ({"density": 2700.0, "inner_diameter": None}, (200e9, 2700.0, 0.06, 0.0), 942.5, None),
    ],
)
def test_a_piston_of_another_section_or_material(changes, made_of, stiffness, frequency):
    given = fx.preset("machine-hexapod")
    legs = tuple(leg.replace(piston=leg.piston.replace(**changes)) for leg in given.robot.legs)
    found = given.replace(robot=given.robot.replace(legs=legs))
    piston, (expected, along) = found.robot.legs[0].piston, by_hand(*made_of)
    np.testing.assert_allclose((piston.EA, piston.EI, piston.rhoA), expected, rtol=1e-14)  # rounding
    assert along == pytest.approx(stiffness, abs=0.05)
    again = fx.loads(found.source_text)
    assert again.robot == found.robot
    assert (again.robot.legs[0].piston.E, again.robot.legs[0].piston.density) == made_of[:2]
    if frequency:
        assert float(fx.modes(found).frequency[0]) == pytest.approx(frequency, abs=5e-4)


@pytest.mark.parametrize(
    ("make", "key", "words"),
    [
        (lambda: BY_HAND.replace(E=70e9), "EA", "what follows from section and material"),
        (lambda: BY_HAND.replace(diameter=None).replace(E=70e9), "E", "together with EI, EA, rhoA"),
        (lambda: BY_HAND.replace(E=70e9, density=2700.0), "EA", "what follows from section and material"),
        (lambda: ROUND.replace(E=70e9, EA=1e9), "EA", "what follows from section and material"),
        (lambda: Piston(length=0.6, EA=3e8, EI=1e5, rhoA=12.0, E=2e11), "E", "together with EI, EA, rhoA"),
        (lambda: ROUND.replace(sections=PIECES), "diameter", "together with sections"),
        (lambda: STEPPED.replace(EA=1e9), "EA", "what follows"),
        (lambda: STEPPED.replace(length=0.7), "length", "what follows"),
        (lambda: STEPPED.replace(diameter=0.05), "diameter", "together with sections"),
        (lambda: TUBE.replace(mass=1.0), "mass", "the section, with what is mounted on it"),
        (lambda: BEAM.replace(EI=1.0, material=MATERIALS["aluminium"]), "EI", "what follows from section and material"),
        (lambda: Actuator(length=1.0, free_length=0.5, rhoA=1.0, EI=1.0, material=STEEL), "section", "is missing"),
        (lambda: ROUND.replace(rhoA=1.0, density=2700.0), "rhoA", "what follows"),
        (lambda: Joint(rolling=LAW, stiffness=np.diag([1e8, 1e8, 1e8, 0, 0, 0])), "stiffness", "the law"),
        (lambda: Floor.by_curve("VC-A").replace(density=np.ones((3, 3))), "density", "the curve"),
        (lambda: Simulation(tolerance=1e-5).replace(step=1e-3), "step", "together with tolerance"),
    ],
)  # fmt: skip
def test_contradictions_are_refused_in_words(make, key, words):
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.key == key and words in str(caught.value), str(caught.value)


def test_numbers_by_hand_stay():
    assert BY_HAND.replace(diameter=0.07).EA == 3e8  # the section of remarks on stresses
    stiff = ROUND.replace(EA=1e12)
    assert (stiff.EA, stiff.EI, stiff.rhoA) == (1e12, ROUND.EI, ROUND.rhoA)
    assert (stiff.E, stiff.density, stiff.diameter) == (None, 7800.0, 0.06)
    light = ROUND.replace(rhoA=1e-3)
    assert (light.EA, light.E, light.density) == (ROUND.EA, 2e11, None) and light.replace(E=1e11).EA == ROUND.EA / 2
    bare = ROUND.replace(diameter=None, inner_diameter=None)
    assert (bare.EA, bare.EI, bare.rhoA, bare.E) == (ROUND.EA, ROUND.EI, ROUND.rhoA, None)
    for piston in (BY_HAND, stiff, light, bare, ROUND.replace(GJ=1e5), STEPPED.replace(sections=())):
        found = study(machine(piston=piston))
        assert fx.loads(found.source_text).robot == found.robot
        assert piston.replace(E=2e11, density=7800.0, EA=None, EI=None, rhoA=None, GJ=None, diameter=0.05).EI == (
            pytest.approx(by_hand(2e11, 7800.0, 0.05, piston.inner_diameter or 0.0)[0][1], rel=1e-14)
        )
    assert Piston(**{name: getattr(ROUND, name) for name in Piston.model_fields}).replace(E=1e11).EA == ROUND.EA / 2
    assert BEAM.replace(EI=3.0).rhoA == BEAM.rhoA and BEAM.replace(EI=3.0).material is None
    flat = fx.preset("paper-actuator").actuator.replace(section=Tube(diameter=0.03))
    for beam in (flat, BEAM, BEAM.replace(EI=3.0), BEAM.replace(section=None)):
        found = fx.preset("paper-actuator").replace(actuator=beam)
        assert fx.loads(found.source_text).actuator == found.actuator
    rigid = TUBE.replace(diameter=None, inner_diameter=None, material=None)
    assert (rigid.mass, rigid.com, rigid.section) == (TUBE.mass, TUBE.com, None)


def test_what_follows_follows_in_a_copy():
    longer = STEPPED.replace(sections=[*PIECES, PIECES[0].replace(length=0.1)])
    assert longer.length == pytest.approx(0.7, rel=1e-15)
    assert longer.mass == pytest.approx(STEPPED.mass + 0.1 * PIECES[0].density * pi / 4 * 0.06**2, rel=1e-14)
    light = STEPPED.replace(sections=[piece.replace(E=1e11) for piece in PIECES])
    assert (light.EA, light.E) == (pytest.approx(STEPPED.EA / 2, rel=1e-14), 1e11)
    motor = TUBE.replace(body=Mounted(mass=5.0, com=0.1))
    assert motor.mass == pytest.approx(TUBE.mass + 5.0, rel=1e-15)
    assert motor.com == pytest.approx((TUBE.mass * 0.3 + 0.5) / (TUBE.mass + 5.0), rel=1e-14)
    soft = BEAM.replace(material=STEEL.replace(E=1e11))
    assert (soft.EI, soft.rhoA) == (pytest.approx(BEAM.EI / 2, rel=1e-15), BEAM.rhoA)
    assert BEAM.replace(section=Tube(diameter=0.06)).EI == pytest.approx(16 * BEAM.EI, rel=1e-14)
    # Half the velocity is a quarter of its spectrum (Amick et al. 2005: VC-D is half of VC-C).
    c, d = Floor.by_curve("VC-C"), Floor.by_curve("VC-C").replace(curve="VC-D")
    np.testing.assert_allclose(d.density, c.density / 4, rtol=1e-14)
    assert (Disturbance(floor=d), Simulation().replace(step=1e-3).tolerance) == (
        Disturbance(floor=Floor.by_curve("VC-D")), None,
    )  # fmt: skip


def test_the_tool_is_the_centre_of_mass_unless_one_is_given():
    moved, given = Payload(**BODY).replace(com=[0, 0, 0.3]), Payload(**BODY, tool=[0, 0, 0.1]).replace(com=[0, 0, 0.3])
    assert moved.tool[2] == 0.3 and given.tool[2] == 0.1
    again = pickle.loads(pickle.dumps(Payload(**BODY))).replace(mass=12.0).replace(com=[0, 0, 0.3])
    assert again.tool[2] == 0.3
    for payload in (moved, given):
        found = study(machine()).robot.replace(payload=payload)
        assert ("tool" in fx.loads(study(found).source_text).robot.payload.model_fields_set) is (payload is given)
        assert fx.loads(study(found).source_text).robot.payload == payload


def test_a_law_of_bearings_stays_one():
    joint = Joint(rolling=LAW)
    less, wider = joint.replace(stiffness_loss=0.01), joint.replace(rolling=LAW.replace(radial=1e8))
    assert less.rolling == LAW.replace(loss=0.01) and less.stiffness_loss == 0.01
    assert wider.across_and_along == (1e8, LAW.k)
    by_matrix = joint.replace(stiffness=2 * joint.stiffness)
    assert by_matrix.rolling is None and (by_matrix.stiffness_loss, by_matrix.leg_axes) == (0.02, True)
    for given in (joint, less, wider, by_matrix):
        assert fx.loads(study(machine(base_joint=given)).source_text).robot.legs[0].base_joint == given


@pytest.mark.parametrize("more", [{}, {"stiffness_damping": 2e3}, {"stiffness_loss": 0.02}])
def test_springs_along_the_leg_are_written_whole(more):
    """What was not the same across the leg once lost a number in the text, six rows all but two."""
    flat = np.diag([2e7, 3e7, 5e7, 0, 0, 0])
    turning = np.diag([2e7, 2e7, 5e7, 900.0, 800.0, 300.0])
    turning[0, 4] = turning[4, 0] = 1e4
    for stiffness in (flat, turning):
        joint = Joint(stiffness=stiffness, leg_axes=True, **more)
        given = fx.preset("nano-hexapod")
        legs = tuple(leg.replace(base_joint=joint) for leg in given.robot.legs)
        found = given.replace(robot=given.robot.replace(legs=legs))
        assert fx.loads(found.source_text).robot == found.robot


def test_the_piston_of_a_leg_with_a_strut_is_its_strut():
    given = sample_study("delta")
    leg = given.robot.legs[0]
    thick = Strut.round(length=leg.strut.length, section=Tube(diameter=0.03), material=STEEL)
    for changed in (leg.replace(strut=thick), leg.replace(piston=thick)):
        assert changed.strut == changed.piston == thick


def test_materials_of_the_same_numbers_are_the_same():
    bronze = Material(name="bronze", E=1.1e11, density=8800.0)
    assert bronze == Material(name="given", E=1.1e11, density=8800.0) and hash(bronze) == hash(bronze.replace(E=1.1e11))
    found = study(machine(cylinder=TUBE.replace(material=bronze)))
    assert fx.loads(found.source_text).robot == found.robot


def test_directions_in_words_follow_their_joints():
    tripod = fx.preset("tripod")
    turn = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    robot = tripod.robot.replace(
        base_joints=tripod.robot.base_joints @ turn.T, platform_joints=tripod.robot.platform_joints @ turn.T
    )
    for leg, before in zip(robot.legs, tripod.robot.legs, strict=True):
        np.testing.assert_allclose(leg.base_joint.axis, turn @ before.base_joint.axis, atol=1e-15)
    again = robot.replace(base_joints=tripod.robot.base_joints, platform_joints=tripod.robot.platform_joints)
    assert again == tripod.robot
    fixed = tripod.robot.legs[0].base_joint.replace(axis=[0.2, 1.0, 0.0])
    leg = tripod.robot.legs[0].replace(base_joint=fixed)
    by_vector = tripod.robot.replace(legs=(leg, *tripod.robot.legs[1:]), base_joints=robot.base_joints)
    np.testing.assert_array_equal(by_vector.legs[0].base_joint.axis, [0.2, 1.0, 0.0])
