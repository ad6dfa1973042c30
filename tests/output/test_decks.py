"""Decks as text, the ties of rigid bodies, and what is refused."""

import re

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.runs import with_legs

from flexapod import InputError
from flexapod.kinematics import home_pose
from flexapod.model import ConstantWrench, Cylinder, ForceDrive, Joint, Load, ServoDrive, Study, preset
from flexapod.output.exchange.decks import Deck, Tie, cross_matrix, dependent_displacements
from flexapod.output.exchange.decks_legs import legs_at_pose
from flexapod.output.exchange.decks_robot import point_masses
from flexapod.output.exchange.pose_deck import abaqus_deck, deck_omissions

pytestmark = pytest.mark.unit

SHARED = {
    "HEADING", "NODE", "ELEMENT", "MASS", "MATERIAL", "ELASTIC", "DENSITY", "SOLID SECTION", "SPRING", "BOUNDARY",
    "EQUATION", "ELSET", "STEP", "STATIC", "DLOAD", "CLOAD", "NODE PRINT", "NODE FILE", "FREQUENCY", "END STEP",
}  # fmt: skip


@pytest.fixture(scope="module")
def robot():
    study = preset("paper-robot")
    assert isinstance(study, Study)
    return study.robot


@pytest.mark.parametrize(
    ("moments", "count"),
    [((3.0, 4.0, 5.0), 6), ((3.0, 4.0, 7.0), 5), ((4.0, 4.0, 0.0), 3), ((0.0, 0.0, 0.0), 1)],
    ids=["body", "flat", "line", "point"],
)
def test_point_masses_have_mass_centre_and_inertia(moments, count):
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    inertia = turn @ np.diag(moments) @ turn.T
    places, masses = point_masses(12.0, inertia)
    assert len(places) == len(masses) == count
    assert masses.sum() == pytest.approx(12.0, rel=1e-14)
    # lengths of 1 m, masses of 2 kg, six terms: rounding
    np.testing.assert_allclose(masses @ places, 0.0, atol=1e-13)
    found = sum(m * cross_matrix(r) @ cross_matrix(r).T for m, r in zip(masses, places, strict=True))
    np.testing.assert_allclose(found, inertia, atol=1e-12)


def test_solved_ties_hold_for_every_rigid_motion():
    random = np.random.default_rng(2)
    points = random.normal(size=(5, 3))
    motion = np.vstack([np.hstack([np.eye(3), cross_matrix(r)]) for r in points])
    terms = tuple((node, axis) for node in range(1, 6) for axis in (1, 2, 3))
    keep = [(2, 1), (5, 3)]
    found = dependent_displacements([Tie(terms=terms, rows=np.eye(15), motion=motion)], keep=keep)
    assert len(found) == 15 - 6
    assert not set(found) & set(keep)
    assert not set(found) & {other for others in found.values() for other in others}
    for q in random.normal(size=(4, 6)):
        u = dict(zip(terms, motion @ q, strict=True))
        for term, others in found.items():
            assert u[term] == pytest.approx(sum(factor * u[other] for other, factor in others.items()), abs=1e-12)


def test_cross_matrix():
    theta, r = np.array([1.0, 2.0, 3.0]), np.array([-2.0, 0.5, 4.0])
    np.testing.assert_array_equal(cross_matrix(r) @ theta, np.cross(theta, r))


def test_lines_of_a_deck():
    deck = Deck("title")
    nodes = deck.nodes(np.array([[0.1, -0.0, 1 / 3], [1e-20, 2.0, 3.0]]), "ALL")
    deck.equations({(1, 2): {(2, 3): -0.5, (2, 1): 1.0}})
    deck.springs([(1, 2)], 7e9, "S")
    assert nodes.tolist() == [1, 2]
    assert deck.text.splitlines() == [
        "*HEADING", "title", "*NODE, NSET=ALL", "1, 0.1, 0., 0.333333333333", "2, 1.E-20, 2., 3.",
        "*EQUATION", "3", "1, 2, -1., 2, 3, -0.5, 2, 1, 1.",
        "*ELEMENT, TYPE=SPRINGA, ELSET=S", "1, 1, 2", "*SPRING, ELSET=S", "", "7000000000.",
    ]  # fmt: skip


def lines(text, keyword):
    """Data lines under every card of a keyword, one list a card."""
    cards = re.findall(rf"^\*{keyword}(?:,[^\n]*)?\n((?:[^*\n][^\n]*\n|\n)*)", text, flags=re.MULTILINE)
    return [card.splitlines() for card in cards]


def test_deck_of_a_robot_uses_what_both_programs_share(robot):
    text = abaqus_deck(robot, {"roll": 0.1}, elements=4)
    cards = {line[1:].split(",")[0] for line in text.splitlines() if re.match(r"\*[A-Z]", line)}
    assert cards <= SHARED
    assert {line.split("TYPE=")[1].split(",")[0] for line in text.splitlines() if "TYPE=" in line} == {
        "C3D20", "MASS", "SPRINGA",
    }  # fmt: skip
    assert max(map(len, text.splitlines())) <= 256
    numbers = [line for line in text.splitlines() if re.match(r"\d", line)]
    assert max(line.count(",") for line in numbers) < 16
    stiff = [card[1] for card in lines(text, "SPRING")]
    assert all("." in value for value in stiff)  # CalculiX took 20000000 for a direction: "one degree of freedom"
    assert max(len(entry.strip()) for line in numbers for entry in line.split(",")) <= 20


@pytest.mark.parametrize("turned", [0.0, 0.4])
def test_a_deck_says_its_pose(robot, turned):
    """As it was given, from home, however that is turned."""
    given = {"surge": 0.01, "sway": -0.02, "heave": 0.03, "roll": 0.1, "pitch": -0.2, "yaw": 0.3}
    robot = robot.replace(home=robot.home.replace(rotation=[0.0, 0.0, turned]))
    text = abaqus_deck(robot, given, elements=2).replace("\n** ", " ")
    told = dict(re.findall(r"(\w+) (-?[\d.]+) (?:mm|deg)", text.partition("Pose from home: ")[2].partition(" Run ")[0]))
    for name, value in given.items():
        exact = np.rad2deg(value) if name in ("roll", "pitch", "yaw") else 1e3 * value
        assert float(told[name]) == pytest.approx(exact, rel=1e-5)  # six figures are written


def test_no_displacement_is_followed_twice_or_follows_a_follower(robot):
    first, rest = [], set()
    for card in lines(abaqus_deck(robot, elements=2), "EQUATION"):
        entries = ", ".join(card[1:]).split(", ")
        terms = [(int(n), int(i)) for n, i in zip(entries[::3], entries[1::3], strict=True)]
        assert len(terms) == int(card[0])
        first.append(terms[0])
        rest |= set(terms[1:])
    assert len(first) == len(set(first))
    assert not set(first) & rest


def mass_of(text):
    """Sum of point masses and of solid bars."""
    points = 0.0
    for name, value in re.findall(r"^\*MASS, ELSET=(\S+)\n(\S+)", text, flags=re.MULTILINE):
        block = re.search(rf"^\*ELEMENT, TYPE=MASS, ELSET={name}\n((?:\d[^\n]*\n)+)", text, flags=re.MULTILINE)
        assert block is not None
        points += float(value) * len(block[1].splitlines())
    return points


def test_masses_add_up(robot):
    text = abaqus_deck(robot, elements=2)
    leg, free = robot.legs[0], robot.home_lengths - robot.legs[0].cylinder.mouth
    inside = leg.piston.rhoA * (leg.piston.length - free)
    expected = robot.payload.mass + 6 * leg.cylinder.mass + inside.sum()
    assert mass_of(text) == pytest.approx(expected, rel=1e-10)  # twelve digits are written
    density = float(lines(text, "DENSITY")[0][0])
    assert density * 12 * leg.piston.EI / leg.piston.EA == pytest.approx(leg.piston.rhoA, rel=1e-10)


def test_steps(robot):
    weightless = robot.replace(gravity=[0, 0, 0])
    assert abaqus_deck(weightless, elements=2, modes=7).count("*STEP") == 1
    loaded = abaqus_deck(weightless, load=[1.0, 2.0, 3.0, 0.0, 0.0, 0.0], elements=2)
    assert loaded.count("*STEP") == 2
    assert "GRAV" not in loaded and len(lines(loaded, "CLOAD")) == 1
    assert lines(abaqus_deck(robot, elements=2), "DLOAD") == [["HEAVY, GRAV, 9.81, 0., 0., -1."]]


def test_load_at_the_tool_has_the_force_and_moment_that_the_study_says(robot):
    tool = robot.replace(payload=robot.payload.replace(tool=[0.1, 0.2, 0.3]))
    wrench = np.array([10.0, -20.0, 30.0, 4.0, 5.0, -6.0])
    text = abaqus_deck(tool, load=wrench, elements=2)
    places = np.array([[float(x) for x in row.split(",")[1:]] for row in lines(text, "NODE")[0]])
    forces = np.zeros_like(places)
    for row in lines(text, "CLOAD")[0]:
        node, axis, value = row.split(",")
        forces[int(node) - 1, int(axis) - 1] += float(value)
    # the forces act on displacements that the others follow, so that rigid motions are all there are
    np.testing.assert_allclose(forces.sum(axis=0), wrench[:3], rtol=1e-9)
    at = [0.1, 0.2, robot.home_height + 0.3]
    np.testing.assert_allclose(np.cross(places - at, forces).sum(axis=0), wrench[3:], rtol=1e-8)


def test_servo_stiffness_is_written(robot):
    text = abaqus_deck(with_legs(robot, drive=ServoDrive(stiffness=12345678.0, damping=0.0)), elements=2)
    assert len(re.findall(r"DRIVE\n\n12345678\.\n", text)) == 6


def test_what_is_left_out_is_said(robot):
    assert deck_omissions(robot) == ["damping"]
    piston = robot.legs[0].piston.replace(axial_inertia=0.1)
    assert "axial_inertia" in deck_omissions(with_legs(robot, piston=piston))[1]
    assert deck_omissions(with_legs(robot, piston=piston.replace(axial_inertia=0.01))) == ["damping"]


@pytest.mark.parametrize(
    ("change", "arguments", "key"),
    [
        ({}, {"elements": 1}, "elements"),
        ({}, {"elements": True}, "elements"),
        ({}, {"modes": 0}, "modes"),
        ({}, {"pose": {"heave": 1.0}}, "pose"),
        ({"drive": ForceDrive()}, {}, "leg.drive"),
        ({"base_joint": Joint(stiffness=np.diag([1e8, 2e8, 3e8, 0, 0, 0]))}, {}, "leg.base_joint.stiffness"),
        ({"cylinder": Cylinder(mass=0.0, com=0.0, inertia=0.1, mouth=0.3)}, {}, "leg.cylinder.inertia"),
    ],
)
def test_refusals(robot, change, arguments, key):
    with pytest.raises(InputError) as caught:
        abaqus_deck(with_legs(robot, **change) if change else robot, **arguments)
    assert caught.value.key == key
    study = preset("paper-robot").replace(robot=with_legs(robot, **change) if change else robot, path="mine.toml")
    with pytest.raises(InputError) as caught:
        abaqus_deck(study, **arguments)
    assert caught.value.file == ("mine.toml" if key.startswith("leg") else None)


def test_a_piston_that_does_not_reach_the_mouth_is_refused(robot):
    leg = robot.legs[0]
    bare = leg.cylinder.replace(mouth=0.0, mass=0.0, com=0.0, inertia=0.0)
    with pytest.raises(InputError, match="does not reach back"):
        abaqus_deck(with_legs(robot, cylinder=bare, piston=leg.piston.replace(length=0.5)))


def test_load_of_a_study_is_taken(robot):
    study = preset("paper-robot")
    assert isinstance(study, Study)
    pushed = study.replace(load=Load(wrench=ConstantWrench(value=[0, 0, -100.0, 0, 0, 0])))
    assert "*CLOAD" in abaqus_deck(pushed, elements=2)
    assert "*CLOAD" not in abaqus_deck(study, elements=2)


@pytest.mark.parametrize(
    ("kind", "turns", "rod", "ends"),
    [("6-UPS", 2, False, None), ("3-RPS", 1, False, None), ("3-UPU", 2, False, 2), ("6-UCU", 2, True, 2)],
)
def test_each_freedom_of_a_leg_stands_once_in_its_deck(kind, turns, rod, ends):
    # Counted by hand: a cross 2, a hinge 1; the turn in a cylindrical joint is the piston's in its cylinder.
    # Ends in balls meet the platform at a point and need none.
    robot = ROBOTS[kind]()
    for leg in legs_at_pose(robot, home_pose(robot), np.zeros(robot.count)):
        assert (len(leg.turns), leg.piston_turns) == (turns, rod)
        assert (None if leg.ends is None else len(leg.ends)) == ends
