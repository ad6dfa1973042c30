"""Forces and lengths of the symmetric robot in closed form."""

import numpy as np
import pytest
from tests.oracles.stewart_cases import base_circle, platform_circle

from flexapod.kinematics.dynamics import LegBodies, PayloadBody, inverse_dynamics
from flexapod.kinematics.inverse import leg_frames, leg_lengths, leg_state
from flexapod.kinematics.jacobian import length_jacobian
from flexapod.kinematics.laws import Law
from flexapod.kinematics.trajectory import Poses, poses_from_coordinates, rotation_matrix

pytestmark = pytest.mark.analytic

BASE, PLATFORM, HOME, G = base_circle(0.25, 10), platform_circle(0.15, 10), 0.9, 9.81
FRAMES = leg_frames(BASE, PLATFORM + np.array([0, 0, HOME]))
GRAVITY = np.array([0, 0, -G])
CENTRED = PayloadBody(mass=100.0, inertia=17.88 * np.eye(3), com=np.zeros(3), tool=np.array([0, 0, 0.2]))


def bodies(cylinder_mass, piston_mass):
    return LegBodies(
        cylinder_mass=np.full(6, cylinder_mass),
        cylinder_com=np.full(6, 0.1575),
        cylinder_inertia=np.full(6, 0.0248 if cylinder_mass else 0.0),
        cylinder_axial=np.zeros(6),
        piston_mass=np.full(6, piston_mass),
        piston_length=np.full(6, 0.75),
        piston_axial=np.zeros(6),
    )


def forces(poses, leg_bodies, payload=CENTRED, gravity=GRAVITY, wrench=None):
    state = leg_state(BASE, PLATFORM, FRAMES, poses)
    return inverse_dynamics(FRAMES, PLATFORM, leg_bodies, payload, gravity, poses, state, wrench)


@pytest.mark.parametrize("acceleration", [0.0, 3.0, -12.0])
def test_heave_on_massless_legs(acceleration):
    """Six equal legs, each m (g + a) / (6 cos): z / l is the cosine."""
    zero = np.zeros((1, 6))
    law = Law(zero, zero, np.array([[0, 0, acceleration, 0, 0, 0.0]]))
    found = forces(poses_from_coordinates(Poses.at_rest([0.0, 0.0, HOME], np.eye(3)), law), bodies(0.0, 0.0))
    length = np.linalg.norm(PLATFORM[0] + np.array([0, 0, HOME]) - BASE[0])
    np.testing.assert_allclose(found.actuator_force, 100 * (G + acceleration) / 6 * length / HOME, rtol=1e-13)
    np.testing.assert_allclose(np.linalg.norm(found.joint_force, axis=-1), np.abs(found.actuator_force), rtol=1e-13)


@pytest.mark.parametrize("z", [0.7, 0.9, 1.1])
def test_static_heave_with_heavy_legs(z):
    """Virtual work of one sixth: f dl/dz = dV/dz with V = g [m z / 6 + (mc c + mp (l - Lp / 2)) z / l]."""
    found = forces(Poses.at_rest([0, 0, z], np.eye(3)), bodies(3.0, 3.35))
    length = np.linalg.norm(PLATFORM[0] + np.array([0, 0, z]) - BASE[0])
    static = 3.0 * 0.1575 + 3.35 * (length - 0.375)
    slope = 100 / 6 + 3.35 * z**2 / length**2 + static * (1 / length - z**2 / length**3)
    np.testing.assert_allclose(found.actuator_force, G * slope * length / z, rtol=1e-13)
    np.testing.assert_allclose(found.base_force.sum(axis=1), [[0, 0, G * (100 + 6 * 6.35)]], atol=1e-10)


def test_wrench_at_the_tool_on_massless_legs():
    """Static duality: J^T f carries the wrench, J about the tool."""
    poses = Poses.at_rest([0.02, -0.03, 0.95], rotation_matrix([0.2, -0.1, 0.3]))
    wrench = np.array([10, -20, 30, 4, 5, -6.0])
    found = forces(poses, bodies(0.0, 0.0), gravity=np.zeros(3), wrench=wrench)
    jacobian = length_jacobian(BASE, PLATFORM, poses.position[0], poses.rotation[0], CENTRED.tool)
    np.testing.assert_allclose(jacobian.T @ found.actuator_force[0], -wrench, atol=1e-12)


# Longest change of a leg when the paper's robot rolls about the platform's centre, home height 0.9 m: both readings of
# its circles, 0.5 m and 0.3 m as diameters or as radii; millimetres are printed without decimals.
@pytest.mark.parametrize(
    ("base_radius", "platform_radius", "roll_deg", "largest_mm"),
    [(0.25, 0.15, 27, 65), (0.25, 0.15, 60, 129), (0.25, 0.15, 90, 161), (0.5, 0.3, 27, 127), (0.5, 0.3, 60, 262)],
)
def test_leg_strokes_of_the_two_readings(base_radius, platform_radius, roll_deg, largest_mm):
    base, platform = base_circle(base_radius, 10), platform_circle(platform_radius, 10)
    turns = rotation_matrix(np.deg2rad([[0, 0, 0], [roll_deg, 0, 0]]))
    home, rolled = leg_lengths(base, platform, np.array([0, 0, HOME]), turns)
    assert 1e3 * np.max(np.abs(rolled - home)) == pytest.approx(largest_mm, abs=0.5)


def test_radii_at_30_degrees_spread_the_legs_by_the_printed_piston_travel():
    rolled = leg_lengths(
        base_circle(0.5, 10), platform_circle(0.3, 10), [0, 0, HOME], rotation_matrix([np.pi / 6, 0, 0])
    )
    assert 1e3 * np.ptp(rolled) == pytest.approx(262, abs=0.5)


@pytest.mark.parametrize(("base_radius", "platform_radius", "mouth"), [(0.25, 0.15, 0.31518), (0.5, 0.3, 0.35926)])
def test_free_length_of_the_presets_is_600_mm_at_home(base_radius, platform_radius, mouth):
    lengths = leg_lengths(base_circle(base_radius, 10), platform_circle(platform_radius, 10), [0, 0, HOME], np.eye(3))
    np.testing.assert_allclose(lengths - mouth, 0.6, atol=5e-6)  # the mouth is printed with five decimals
