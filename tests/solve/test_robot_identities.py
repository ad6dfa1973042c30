"""Robots that must be others: legs without anything, a platform that is fixed."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.layouts import layout
from tests.helpers.systems import CYLINDER, PISTON, frequencies, hexapod, packed, robot, solved
from tests.oracles import beams

from flexapod.mechanics.leg.layout import leg_parameters
from flexapod.mechanics.shapes import axial_basis, lateral_basis
from flexapod.solve.batch import RestStates, matrices_at_rest
from flexapod.solve.kernel import interpreted_kernel
from flexapod.solve.statics.equilibrium import equilibria
from flexapod.solve.system import System

pytestmark = pytest.mark.consistency

NOTHING = 1e-14  # share of a leg's mass and stiffness


def test_eight_legs_of_which_two_are_nothing_are_six():
    six, x = hexapod()
    found, m, _, _ = solved(six, x)
    base, joints = [[0.5, 0.1, 0.0], [-0.1, 0.5, 0.0]], [[0.2, 0.1, 0.0], [0.0, 0.2, 0.0]]
    weak = {name: NOTHING * (PISTON | CYLINDER)[name] for name in ("rhoA", "EI", "EA", *CYLINDER)}
    two, y = robot(base, joints, [[0, 1, 0]] * 2, legs=[weak | {"cylinder_com": 0.2}] * 2)
    eight = replace(
        six,
        leg_p=np.vstack([six.leg_p, two.leg_p]),
        joint_p=np.vstack([six.joint_p, two.joint_p]),
        held=np.vstack([six.held, two.held]),
    )
    parts = {name: np.concatenate([getattr(x, name), getattr(y, name)], axis=1) for name in ("q", "lam", "drive")}
    z = replace(x, **parts)
    again, other, _, _ = solved(eight, z)
    # Two legs of 1e-14 of the stiffness, whose forces are 1e-14 of the others' for the same displacements.
    np.testing.assert_allclose(again.pose, found.pose, atol=1e-12)
    np.testing.assert_allclose(again.lam[:, :6], found.lam, atol=1e-8 * np.abs(found.lam).max())
    # Frequencies of the weak legs alone (same mass to stiffness) lie among those of the six.
    known, all_of_them = frequencies(six, x, m), frequencies(eight, z, other)
    nearest = np.abs(all_of_them - known[:, None]).min(axis=1)
    np.testing.assert_allclose(nearest / known, 0.0, atol=1e-8)
    assert len(all_of_them) == len(known) * 8 // 6 - 2  # six coordinates of the payload are not those of legs


def test_one_leg_between_two_fixed_points_is_a_beam():
    """Pinned at both ends, guided by its cylinder; the stretch of its piston is a bar, held at both ends."""
    leg = {"cylinder_mass": 0.0, "cylinder_inertia": 0.0, "cylinder_axial_inertia": 0.0, "mouth": 0.0, "Lp": 0.9}
    system, x = robot([[0, 0, 0]], [[0, 0, 0]], [[1, 0, 0]], modes=5, axial=3, gravity=0.0, com=(0, 0, 0), legs=[leg])
    fixed = replace(system, hub_held=np.ones(6, dtype=bool))
    command = x.q[..., fixed.ports]
    found = equilibria(fixed, x, command, np.zeros_like(command), np.zeros(6))
    assert found.code == 0
    m = matrices_at_rest(fixed, found.states, np.zeros(6))
    seen = frequencies(fixed, x, m) / (2 * np.pi)
    # The universal joint is free and the tip a ball: with no cylinder the beam is pinned at both ends, in two planes.
    exact = beams.frequency(np.pi * np.arange(1, 3), 0.9, PISTON["EI"], PISTON["rhoA"])
    bar = np.arange(1, 3) / (2 * 0.9) * np.sqrt(PISTON["EA"] / PISTON["rhoA"])
    # Ritz values of five shapes: first bending within 2e-7, second within 3e-5, as for the leg of a robot (T7).
    np.testing.assert_allclose(seen[:2], exact[0], rtol=1e-6)
    np.testing.assert_allclose(seen[2:4], exact[1], rtol=1e-4)
    for frequency in bar:
        assert np.abs(seen / frequency - 1).min() < 1e-3
    assert len(seen) == 2 * 5 + 3 - 1


def test_a_leg_without_payload_is_a_cantilever():
    """Its joint and stroke held, a force at its tip: F s^3 / 3EI across, F Lp / EA along."""
    lateral, s, force = lateral_basis("tip-load", 3), 0.5, 20.0
    shapes = layout(a=lateral, b=lateral, axial=axial_basis(1), closure="none")
    values = PISTON | {"R0": np.eye(3).ravel()}
    system = System(
        kernel=interpreted_kernel(shapes), leg_p=packed(leg_parameters(shapes), values)[None], joint_p=np.zeros((1, 0)),
        payload_p=np.zeros(0), held=np.array([[True] * 3 + [False] * 7]),
    )  # fmt: skip
    q = np.zeros((1, 1, 10))
    q[..., 2] = PISTON["mouth"] + s
    still = RestStates(q=q, pose=np.zeros((1, 7)), lam=np.zeros((1, 1, 0)), drive=np.zeros((1, 1, 3)))
    command = q[..., system.ports]
    found = equilibria(system, still, command, np.zeros_like(command), np.append(force, np.zeros(11)))
    assert found.code == 0
    across = found.states.q[0, 0, 4:7] @ lateral.tip
    assert across == pytest.approx(force * s**3 / (3 * PISTON["EI"]), rel=1e-5)  # 0.4 mm: stretched by nothing
    beta = list(system.ports).index(1)
    assert found.states.drive[0, 0, beta] == pytest.approx(-force * (PISTON["mouth"] + s), rel=1e-5)
    seen = frequencies(system, still, found.m)[:2] / (2 * np.pi)
    exact = beams.frequency(beams.beam_roots("clamped", "free", 1), s, PISTON["EI"], PISTON["rhoA"])
    np.testing.assert_allclose(seen, exact[0], rtol=1e-5)
