"""Newton-Euler forces against Lagrange's equations, differentiated by CasADi from positions alone."""

import casadi as ca
import numpy as np
import pytest

from flexapod.kinematics.dynamics import LegBodies, PayloadBody, energies, inverse_dynamics
from flexapod.kinematics.inverse import leg_frames, leg_state
from flexapod.kinematics.laws import Law
from flexapod.kinematics.trajectory import Poses, poses_from_coordinates

pytestmark = pytest.mark.consistency

HOME = 0.9
PIVOT = np.array([0.03, -0.05, 0.2])
GRAVITY = np.array([0.7, -0.4, -9.81])
RNG = np.random.default_rng(20240611)
ANGLES = np.deg2rad([-10, 10, 110, 130, 230, 250]), np.deg2rad([-50, 50, 70, 170, 190, 290])
BASE = np.stack([0.25 * np.cos(ANGLES[0]), 0.25 * np.sin(ANGLES[0]), np.zeros(6)], axis=1) + RNG.normal(0, 0.02, (6, 3))
PLATFORM = np.stack([0.15 * np.cos(ANGLES[1]), 0.15 * np.sin(ANGLES[1]), np.zeros(6)], axis=1)
PLATFORM = PLATFORM + RNG.normal(0, 0.02, (6, 3))
FRAMES = leg_frames(BASE, PLATFORM + np.array([0, 0, HOME]), [None, None, [1, 0.3, 0.2], None, None, [0, 1, 0]])
BODIES = LegBodies(
    cylinder_mass=RNG.uniform(2, 4, 6),
    cylinder_com=RNG.uniform(0.1, 0.2, 6),
    cylinder_inertia=RNG.uniform(0.02, 0.03, 6),
    cylinder_axial=RNG.uniform(0.05, 0.2, 6),  # far too large for a real leg, so that its terms count
    piston_mass=RNG.uniform(2, 4, 6),
    piston_length=RNG.uniform(0.7, 0.8, 6),
    piston_axial=RNG.uniform(0.05, 0.2, 6),
)
_A = RNG.normal(size=(3, 3))
PAYLOAD = PayloadBody(
    mass=100.0, inertia=10 * np.eye(3) + _A @ _A.T, com=np.array([0.05, 0.37, 0.1]), tool=np.array([0.1, 0.2, 0.4])
)
AMPLITUDE = np.array([0.05, 0.04, 0.06, 0.25, 0.2, 0.3])
FREQUENCY = np.array([3.0, 5.0, 4.0, 6.0, 7.0, 4.5])
PHASE = np.array([0.3, 1.0, 2.0, 0.5, 1.5, 2.5])


def coordinates(t):
    angle = np.multiply.outer(t, FREQUENCY) + PHASE
    return Law(
        AMPLITUDE * np.sin(angle), AMPLITUDE * FREQUENCY * np.cos(angle), -AMPLITUDE * FREQUENCY**2 * np.sin(angle)
    )


def wrench_at(t):
    return np.sin(np.multiply.outer(t, [2, 3, 4, 5, 6, 7])) * [300, 200, 400, 20, 30, 40]


def path(t):
    poses = poses_from_coordinates(Poses.at_rest([0.0, 0.0, HOME], np.eye(3)), coordinates(t), PIVOT)
    return poses, leg_state(BASE, PLATFORM, FRAMES, poses)


def solve(t, wrench):
    poses, legs = path(t)
    return inverse_dynamics(FRAMES, PLATFORM, BODIES, PAYLOAD, GRAVITY, poses, legs, wrench)


def rotation(axis, angle):
    c, s = ca.cos(angle), ca.sin(angle)
    i, j = [k for k in range(3) if k != axis]
    sign = -1 if axis == 1 else 1
    r = ca.SX.eye(3)
    r[i, i] = r[j, j] = c
    r[i, j], r[j, i] = -sign * s, sign * s
    return r


def vee(m):
    return ca.vertcat(m[2, 1], m[0, 2], m[1, 0])


def rate(expression, q, q_dot):
    return ca.jtimes(expression, q, q_dot)


def leg_energies(i, alpha, beta, length, q, q_dot):
    """Kinetic and potential energy of leg i whose angles and length are expressions of q."""
    turn = ca.DM(FRAMES[i]) @ rotation(0, alpha) @ rotation(1, beta)
    turn_dot = ca.reshape(rate(ca.vec(turn), q, q_dot), 3, 3)
    w = vee(turn.T @ turn_dot)
    kinetic = potential = 0
    half = BODIES.piston_length[i] / 2
    slender = BODIES.piston_mass[i] * BODIES.piston_length[i] ** 2 / 12
    for mass, station, across, along in (
        (BODIES.cylinder_mass[i], BODIES.cylinder_com[i], BODIES.cylinder_inertia[i], BODIES.cylinder_axial[i]),
        (BODIES.piston_mass[i], length - half, slender, BODIES.piston_axial[i]),
    ):
        centre = ca.DM(BASE[i]) + station * turn[:, 2]
        v = rate(centre, q, q_dot)
        kinetic += (mass * ca.sumsqr(v) + across * (w[0] ** 2 + w[1] ** 2) + along * w[2] ** 2) / 2
        potential -= mass * ca.dot(ca.DM(GRAVITY), centre)
    return kinetic, potential


def platform_model():
    """Lagrange's equations of the whole robot in surge ... yaw: functions of (x, x_dot, x_ddot, wrench)."""
    x, v, a, wrench = (ca.SX.sym(name, 6) for name in ("x", "v", "a", "w"))
    turn = rotation(2, x[5]) @ rotation(1, x[4]) @ rotation(0, x[3])
    origin = ca.DM([0, 0, HOME]) + ca.DM(PIVOT) + x[:3] - turn @ ca.DM(PIVOT)
    turn_dot = ca.reshape(rate(ca.vec(turn), x, v), 3, 3)
    omega, local = vee(turn_dot @ turn.T), vee(turn.T @ turn_dot)
    com, tool = (origin + turn @ ca.DM(point) for point in (PAYLOAD.com, PAYLOAD.tool))
    kinetic = PAYLOAD.mass * ca.sumsqr(rate(com, x, v)) / 2 + ca.dot(local, ca.DM(PAYLOAD.inertia) @ local) / 2
    potential = -PAYLOAD.mass * ca.dot(ca.DM(GRAVITY), com)
    lengths = []
    for i in range(6):
        s = origin + turn @ ca.DM(PLATFORM[i]) - ca.DM(BASE[i])
        length = ca.norm_2(s)
        d = ca.DM(FRAMES[i]).T @ s / length
        t, u = leg_energies(i, ca.atan2(-d[1], d[2]), ca.asin(d[0]), length, x, v)
        kinetic, potential = kinetic + t, potential + u
        lengths.append(length)
    p = ca.gradient(kinetic, v)
    inertial = rate(p, x, v) + rate(p, v, a) - ca.gradient(kinetic - potential, x)
    external = ca.jacobian(tool, x).T @ wrench[:3] + ca.jacobian(omega, v).T @ wrench[3:]
    force = ca.solve(ca.jacobian(ca.vertcat(*lengths), x).T, inertial - external)
    return ca.Function("f", [x, v, a, wrench], [force, kinetic, potential])


@pytest.fixture(scope="module")
def instants():
    return np.linspace(0.0, 2.0, 41)


def test_drive_forces_equal_lagrange(instants):
    """Both are exact in exact arithmetic: what remains is round-off times the Jacobian's condition (below 1e3)."""
    wrench = wrench_at(instants)
    law = coordinates(instants)
    expected, _, _ = platform_model().map(len(instants))(*(part.T for part in law), wrench.T)
    force = solve(instants, wrench).actuator_force
    assert np.max(np.abs(force - np.array(expected).T)) < 1e-10 * np.max(np.abs(force))


def test_energies_equal_lagrange(instants):
    law = coordinates(instants)
    _, kinetic, potential = platform_model().map(len(instants))(*(part.T for part in law), np.zeros((6, len(instants))))
    poses, legs = path(instants)
    t, v = energies(FRAMES, BASE, BODIES, PAYLOAD, GRAVITY, poses, legs)
    np.testing.assert_allclose(t, np.array(kinetic)[0], rtol=1e-12)
    np.testing.assert_allclose(v, np.array(potential)[0], rtol=1e-12)


@pytest.mark.parametrize("i", range(6))
def test_joint_forces_equal_lagrange_of_each_leg(instants, i):
    """A leg alone, driven by its drive and by the platform at its tip, in its own coordinates."""
    q, v, a, tip_force = ca.SX.sym("q", 3), ca.SX.sym("v", 3), ca.SX.sym("a", 3), ca.SX.sym("f", 3)
    kinetic, potential = leg_energies(i, q[0], q[1], q[2], q, v)
    p = ca.gradient(kinetic, v)
    tip = q[2] * (ca.DM(FRAMES[i]) @ rotation(0, q[0]) @ rotation(1, q[1]))[:, 2]
    needed = rate(p, q, v) + rate(p, v, a) - ca.gradient(kinetic - potential, q) - ca.jacobian(tip, q).T @ tip_force
    model = ca.Function("leg", [q, v, a, tip_force], [needed]).map(len(instants))
    _, legs = path(instants)
    found = solve(instants, wrench_at(instants))
    needed = np.array(
        model(
            np.stack([legs.alpha[:, i], legs.beta[:, i], legs.length[:, i]]),
            np.stack([legs.alpha_dot[:, i], legs.beta_dot[:, i], legs.rate[:, i]]),
            np.stack([legs.alpha_ddot[:, i], legs.beta_ddot[:, i], legs.accel[:, i]]),
            -found.joint_force[:, i].T,
        )
    )
    scale = np.max(np.abs(found.actuator_force))
    assert np.max(np.abs(needed[:2])) < 1e-12 * scale  # no moment about the universal joint's own axes
    np.testing.assert_allclose(needed[2], found.actuator_force[:, i], atol=1e-12 * scale)


def momenta(t):
    """Linear momentum and angular momentum about the world's origin of everything that moves."""
    poses, legs = path(t)
    com, v, _ = poses.point(PAYLOAD.com)
    spin = np.einsum("tij,jk,tlk,tl->ti", poses.rotation, PAYLOAD.inertia, poses.rotation, poses.omega)
    linear, angular = PAYLOAD.mass * v, PAYLOAD.mass * np.cross(com, v) + spin
    weight = PAYLOAD.mass * np.cross(com, GRAVITY)
    cb, sb = np.cos(legs.beta), np.sin(legs.beta)
    tip, tip_dot, _ = poses.point(PLATFORM)
    axis = (tip - BASE) / legs.length[..., None]
    axis_dot = (tip_dot - legs.rate[..., None] * axis) / legs.length[..., None]
    twist = (legs.alpha_dot * sb)[..., None] * axis
    swing = np.cross(axis, axis_dot)
    assert np.allclose(np.sum(swing**2, axis=-1), (legs.alpha_dot * cb) ** 2 + legs.beta_dot**2)
    for mass, station, station_dot, across, along in (
        (BODIES.cylinder_mass, BODIES.cylinder_com, 0 * legs.rate, BODIES.cylinder_inertia, BODIES.cylinder_axial),
        (
            BODIES.piston_mass,
            BODIES.piston_com(legs.length),
            legs.rate,
            BODIES.piston_mass * BODIES.piston_length**2 / 12,
            BODIES.piston_axial,
        ),
    ):
        station = np.broadcast_to(station, legs.length.shape)[..., None]
        centre, velocity = BASE + station * axis, station * axis_dot + station_dot[..., None] * axis
        linear = linear + np.sum(mass[:, None] * velocity, axis=1)
        angular = angular + np.sum(
            mass[:, None] * np.cross(centre, velocity) + across[:, None] * swing + along[:, None] * twist, axis=1
        )
        weight = weight + np.sum(mass[:, None] * np.cross(centre, GRAVITY), axis=1)
    return linear, angular, weight


def central(f, t, h=2e-3):
    """Eighth-order central difference: truncation below 1e-10 for rates up to 30 rad/s, round-off about 1e-12."""
    weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    return sum(w * (f(t + k * h) - f(t - k * h)) for k, w in enumerate(weights, start=1)) / h


def test_base_reactions_balance_momentum(instants):
    wrench = wrench_at(instants)
    found = solve(instants, wrench)
    poses, _ = path(instants)
    tool, _, _ = poses.point(PAYLOAD.tool)
    mass = PAYLOAD.mass + BODIES.cylinder_mass.sum() + BODIES.piston_mass.sum()
    force = found.base_force.sum(axis=1) + wrench[:, :3] + mass * GRAVITY
    moment = np.sum(found.base_moment + np.cross(BASE, found.base_force), axis=1)
    moment = moment + wrench[:, 3:] + np.cross(tool, wrench[:, :3]) + momenta(instants)[2]
    np.testing.assert_allclose(force, central(lambda t: momenta(t)[0], instants), atol=1e-8 * np.max(np.abs(force)))
    np.testing.assert_allclose(moment, central(lambda t: momenta(t)[1], instants), atol=1e-8 * np.max(np.abs(moment)))


def test_power_balance_closes(instants):
    """Drive and wrench power equal the change of energy, to 1e-8 of the largest power."""
    wrench = wrench_at(instants)
    found = solve(instants, wrench)
    poses, legs = path(instants)
    _, tool_dot, _ = poses.point(PAYLOAD.tool)
    power = np.sum(found.actuator_force * legs.rate, axis=1)
    power = power + np.sum(wrench * np.concatenate([tool_dot, poses.omega], axis=1), axis=1)

    def energy(t):
        return sum(energies(FRAMES, BASE, BODIES, PAYLOAD, GRAVITY, *path(t)))

    assert np.max(np.abs(power - central(energy, instants))) < 1e-8 * np.max(np.abs(power))


def test_universal_joint_spin_matters(instants):
    """Without the axial inertias the forces change by far more than the 1e-10 to which Lagrange confirms them."""
    without = LegBodies(**{**BODIES.__dict__, "cylinder_axial": np.zeros(6), "piston_axial": np.zeros(6)})
    poses, legs = path(instants)
    plain = inverse_dynamics(FRAMES, PLATFORM, without, PAYLOAD, GRAVITY, poses, legs)
    full = solve(instants, None)
    assert np.max(np.abs(plain.actuator_force - full.actuator_force)) > 1e-5 * np.max(np.abs(full.actuator_force))
    assert np.all(plain.base_moment == 0)
