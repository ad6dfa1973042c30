"""Robots with balls at the platform as systems of equations, leg by leg, for tests of the solvers alone."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
from scipy.linalg import block_diag, eigh
from tests.helpers.runs import uncompiled, uncompiled_kernel

from flexapod.mechanics.leg.layout import LEG_PARAMETERS, PAYLOAD_PARAMETERS
from flexapod.model import Simulation
from flexapod.solve.batch import RestStates, matrices_at_rest
from flexapod.solve.modal.structural_damping import per_loss
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.equilibrium import equilibria
from flexapod.solve.statics.ideal_robot import with_substitutes
from flexapod.solve.statics.reduction import independent_motions
from flexapod.solve.system import System

PISTON = {"rhoA": 2.0, "EI": 2e3, "EA": 4e7, "Lp": 0.7, "mouth": 0.4, "piston_axial_inertia": 1e-4, "zeta": 0.01}
CYLINDER = {"cylinder_mass": 3.0, "cylinder_com": 0.2, "cylinder_inertia": 0.05, "cylinder_axial_inertia": 2e-3}


def packed(layout, values):
    return np.concatenate([np.ravel(values.get(name, np.zeros(size))).astype(float) for name, size in layout])


def frame(x, z):
    """Axes as columns, z along a vector, x as near to another one as can be."""
    z = z / np.linalg.norm(z)
    x = x - (x @ z) * z
    x = x / np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def robot(base, joints, axes, *, height=0.9, modes=2, axial=1, gravity=9.81, com=(0.0, 0.0, 0.1), mass=20.0, legs=None):
    """System at home and its undeformed state: bases (n, 3), platform joints (n, 3), first axes (n, 3) of the legs."""
    base, joints = np.array(base, dtype=float), np.array(joints, dtype=float)
    tips, down, rows, q = joints + np.array([0, 0, height]), np.array([0, 0, -gravity]), [], []
    f = uncompiled("tip-load" if modes else "clamped-free", modes, axial)
    for k, (b, tip, axis) in enumerate(zip(base, tips, axes, strict=True)):
        R0 = frame(np.array(axis, dtype=float), tip - b)
        own = PISTON | CYLINDER | (legs[k] if legs else {})
        rows.append(packed(LEG_PARAMETERS, own | {"gravity": down, "base": b, "R0": R0.T}))
        q.append(np.zeros(f.shapes.size))
        q[-1][2] = np.linalg.norm(tip - b)
    held = np.zeros((len(base), f.shapes.size), dtype=bool)
    held[:, 2] = True
    payload = {"mass": mass, "inertia": np.diag([1.0, 1.2, 1.5]), "gravity": down, "tool": [0.05, 0.02, 0.1]}
    system = System(
        kernel=f, leg_p=np.array(rows), joint_p=joints - com, payload_p=packed(PAYLOAD_PARAMETERS, payload), held=held
    )
    return system, at_rest(system, np.array(q), np.append(np.add(com, [0, 0, height]), [1.0, 0, 0, 0]))


def at_rest(system, q, pose):
    n = (1, system.legs)
    return RestStates(
        q=q[None], pose=np.asarray(pose)[None], lam=np.zeros((*n, system.rows)), drive=np.zeros((*n, system.ports.size))
    )


def ring(radius, degrees):
    angle = np.deg2rad(np.asarray(degrees, dtype=float))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)


def tangents(degrees):
    return ring(1.0, np.asarray(degrees) + 90.0)


def of_robot(robot, **simulation):
    """System of a robot of the model, its kernel interpreted: for a few calls nothing need be compiled."""
    settings = Simulation(**simulation)
    with patch("flexapod.solve.robot_system.kernel", uncompiled_kernel):
        return robot_system(robot, settings, per_loss(robot, settings))


THIRDS, EIGHT = [0.0, 120.0, 240.0], np.array([20.0, 70, 110, 160, 200, 250, 290, 340])


def hold(system, x, name, legs=slice(None)):
    held = system.held.copy()
    held[legs, system.kernel.shapes.index(name)] = True
    new = replace(system, held=held)
    return new, replace(x, drive=np.zeros((len(x), new.legs, new.ports.size)))


def tripod(**more):
    """3-RPS: hinges along the tangents, so that beta is held at zero."""
    return hold(*robot(ring(0.35, THIRDS), ring(0.2, THIRDS), tangents(THIRDS), **more), "beta")


def hexapod(**more):
    at = np.array([15.0, 105.0, 135.0, 225.0, 255.0, 345.0])
    return robot(ring(0.4, at), ring(0.25, np.roll(at, 1) - 60.0), tangents(at), **more)


def octopod(**more):
    crossed = EIGHT + np.tile([25.0, -25.0], 4)
    return robot(ring(0.45, EIGHT), ring(0.3, crossed), tangents(EIGHT), **more)


def solved(system, x, **more):
    command = x.q[..., system.ports] + more.get("gap", 0.0)
    wrench = more.get("wrench", np.array([50.0, -30, -100, 3, -2, 4.0]))
    found = equilibria(system, x, command, np.zeros_like(command), wrench)
    assert (found.code == 0).all()
    return found.states, matrices_at_rest(system, found.states, wrench), command, wrench


def frequencies(system, x, m):
    found = independent_motions(with_substitutes(system, x), m)
    motions = found.flat(system, np.eye(found.columns.size)[None])[0]
    M = motions.T @ dense_mass(system, m) @ motions
    return np.sqrt(eigh(found.stiffness(system, m)[0], M, eigvals_only=True))


def dense_mass(system, m):
    return block_diag(*m.M[0], m.payload_M[0])
