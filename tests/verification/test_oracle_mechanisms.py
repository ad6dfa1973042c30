"""Rigid forces of mechanisms by virtual power: published numbers, MuJoCo, energies, and counts of mobility."""

import numpy as np
import pytest
from tests.oracles import mechanism_cases as cases
from tests.oracles import virtual_power
from tests.oracles.mechanism_cases import orsino_motion
from tests.oracles.mechanisms import SURGE, SWAY, YAW, Mechanism, chain, platform

pytestmark = pytest.mark.literature

WRENCH = np.array([50.0, -30, 80, 5, -4, 6])
IN_PLANE = np.array([50.0, -30, 0, 0, 0, 6])


def loaded(name):
    return IN_PLANE if name == "3-PRR" else WRENCH


def moved(name, t=0.3):
    case = cases.CASES[name]()
    return case.mechanism, virtual_power.follow(case.mechanism, *case.motion(t))


def orsino(mixed):
    """Orsino, Hess-Coelho & Malvezzi (2021), example: 3-PRR, or with its first leg an RPR, in the upright plane."""
    home, normal = np.array([2.0, 0.3, 0.0]), [0, 0, 1]
    legs = []
    for rod, mass, along in ((1.0, 0.5, -0.5), (0.8, 0.4, 0.0), (1.0, 0.5, 0.5)):
        tip = home + np.array([along, 0, 0])
        base = [tip[0] - np.sqrt(rod**2 - tip[1] ** 2), 0, 0]
        legs.append(chain("PRR", base, tip, axis=normal, slider=[1, 0, 0], carriage=1.0, strut=(mass, rod, 0.0)))
    if mixed:
        legs[0] = chain("RPR", [0, 0, 0], home - [0.5, 0, 0], axis=normal, cylinder=(1.0, 0.0, 1 / 48, 0.0),
                        piston=(0.5, 1.0, 0.0))  # fmt: skip
    bar = np.diag([0.0, 1.0, 1.0]) * 2 * 0.25 / 3
    hub = platform(2.0, home, bar, pivot=home)
    return Mechanism(tuple(legs), hub, home, np.array([0, -9.8, 0]), (SURGE, SWAY, YAW))


@pytest.mark.parametrize(
    ("mixed", "printed"),
    [(False, [-221.31533, 443.30184, -357.50533]), (True, [-184.96848, 423.29547, -351.61880])],
)
def test_printed_forces_of_planar_robots(mixed, printed):
    robot = orsino(mixed)
    motion = virtual_power.follow(robot, *orsino_motion(0.05))
    np.testing.assert_allclose(virtual_power.forces(robot, motion).drive, printed, rtol=0, atol=5.1e-6)  # five decimals


# joint freedoms, Gruebler's number, mobility by rank, redundant closures, with drives locked, self-stress
MOBILITY = {
    "6-UPS": (cases.ups, 36, 6, 6, 0, 0, 0),
    "6-PUS": (cases.six_pus, 36, 6, 6, 0, 0, 0),
    "6-RUS": (cases.six_rus, 36, 6, 6, 0, 0, 0),
    "6-UCU": (cases.six_ucu, 36, 6, 6, 0, 0, 0),
    "6-SPS": (lambda: cases.ups(letters="SPS"), 42, 12, 12, 0, 6, 0),
    "8-UPS": (cases.eight_ups, 48, 6, 6, 0, 0, 2),
    "3-RPS": (cases.three_rps, 15, 3, 3, 0, 0, 0),
    "3-PRS": (cases.three_prs, 15, 3, 3, 0, 0, 0),
    "3-SPR": (cases.three_spr, 15, 3, 3, 0, 0, 0),
    "3-UPU": (cases.three_upu, 15, 3, 3, 0, 0, 0),
    "3-PUU": (cases.delta, 15, 3, 3, 0, 0, 0),
    "3-UPS+UP": (cases.tricept, 21, 3, 3, 0, 0, 0),
    "3-UPU radial": (lambda: cases.three_upu(cases.radial), 15, 3, 5, 2, 2, 2),
    "2-UPR+SPR": (cases.exechon, 13, 1, 3, 2, 0, 2),
    "3-RPR in space": (cases.planar_rpr, 9, -3, 3, 6, 0, 6),
    "3-PRR in space": (cases.planar_prr, 9, -3, 3, 6, 0, 6),
    "similar hexagons": (cases.similar_hexagons, 36, 6, 6, 0, 3, 3),
}


@pytest.mark.parametrize("name", MOBILITY)
def test_mobility(name):
    build, joints, gruebler, *expected = MOBILITY[name]
    robot = build()
    found = virtual_power.mobility(robot)
    assert found["joints"] == joints
    assert joints + 6 - 6 * len(robot.legs) == gruebler
    assert [found[key] for key in ("mobility", "redundant", "locked", "self_stress")] == expected


@pytest.mark.parametrize("name", cases.CASES)
def test_forces_are_those_of_mujocos_trees(name):
    pytest.importorskip("mujoco")
    from tests.oracles.mujoco_trees import Tree

    case, wrench = cases.CASES[name](), loaded(name)
    tree, guess, positions = Tree(case.mechanism), None, None
    for t in (0.3, 0.7):
        guess = virtual_power.follow(case.mechanism, *case.motion(t), guess=guess)
        forces = virtual_power.forces(case.mechanism, guess, wrench)
        positions = tree.move(*case.motion(t), guess=positions)
        left, tips = tree.forces(wrench, forces.drive)
        # Rounding times the condition of the closures; a least mass of 1e-12 kg in MuJoCo's bodies without mass.
        scale = np.nanmax(np.abs(forces.drive))
        assert left < 1e-11 * max(scale, np.abs(forces.tip_force).max())
        if forces.open == 0:
            drive, tips = tree.forces(wrench)
            np.testing.assert_allclose(drive, forces.drive, rtol=0, atol=1e-11 * scale)
        if virtual_power.mobility(case.mechanism)["redundant"] == 0:  # else forces across the plane are open
            np.testing.assert_allclose(tips, forces.tip_force, rtol=0, atol=1e-11 * np.abs(forces.tip_force).max())


def energy(mechanism, motion):
    """Kinetic and potential energy."""
    total = 0.0
    chains = [*zip(mechanism.legs, motion.legs, strict=True), (mechanism.platform, motion.platform)]
    for part, (q, rates, _) in chains:
        places, now = virtual_power.placed(part, q)
        V, _ = virtual_power.motions(now, rates)
        for body in part.bodies:
            T, (w, v) = places[body.after], np.split(V[body.after], 2)
            c = T[:3, :3] @ body.com + T[:3, 3]
            local, speed = T[:3, :3].T @ w, v + np.cross(w, c)
            total += body.mass * (speed @ speed / 2 - mechanism.gravity @ c) + local @ body.inertia @ local / 2
    return total


@pytest.mark.parametrize("name", cases.CASES)
def test_the_drives_power_is_the_rate_of_energy(name):
    case, t, h = cases.CASES[name](), 0.3, 2e-3
    at = virtual_power.follow(case.mechanism, *case.motion(t))
    motions = {
        k: virtual_power.follow(case.mechanism, *case.motion(t + k * h), guess=at, steps=1) for k in (-2, -1, 0, 1, 2)
    }
    E = {k: energy(case.mechanism, motion) for k, motion in motions.items()}
    rate = (8 * (E[1] - E[-1]) - (E[2] - E[-2])) / (12 * h)
    forces = virtual_power.forces(case.mechanism, motions[0])
    power = sum(
        force * rates[leg.drive]
        for leg, force, (_, rates, _) in zip(case.mechanism.legs, forces.drive, motions[0].legs, strict=True)
        if leg.drive is not None
    )
    # h^4 / 30 of the fifth derivative, frequencies up to 8 rad/s and their products: (16 h)^4 / 30 = 4e-8
    assert power == pytest.approx(rate, rel=0, abs=2e-7 * np.nansum(np.abs(forces.drive)))


def test_a_passive_leg_carries_no_axial_force_of_a_massless_load_path():
    """The middle leg of a Tricept can lengthen freely: along itself it passes what its own piston needs, no more."""
    robot, motion = moved("3-UPS+UP")
    light = robot.legs[-1].__class__(**{**vars(robot.legs[-1]), "bodies": ()})
    robot = Mechanism((*robot.legs[:-1], light), robot.platform, robot.tool, robot.gravity, robot.independent)
    forces = virtual_power.forces(robot, motion, WRENCH)
    place = virtual_power.placed(robot.platform, motion.platform[0])[0][-1]
    along = place[:3, :3] @ robot.legs[-1].tip + place[:3, 3] - robot.legs[-1].base
    along /= np.linalg.norm(along)
    assert abs(forces.tip_force[-1] @ along) < 1e-12 * np.nanmax(np.abs(forces.drive))


def test_hinges_hold_a_tripod_as_its_geometry_says():
    """x = h/2 (R11 - R22), y = -h R21, no twist: the platform of a 3-RPS with radius h (Lee & Shah 1988)."""
    robot, motion = moved("3-RPS")
    T = virtual_power.placed(robot.platform, motion.platform[0])[0][-1]
    R, centre = T[:3, :3], T[:3, :3] @ [0, 0, 0.7] + T[:3, 3]
    np.testing.assert_allclose(
        [R[0, 1] - R[1, 0], *centre[:2]], [0, 0.1 * (R[0, 0] - R[1, 1]), -0.2 * R[1, 0]], atol=1e-13
    )
