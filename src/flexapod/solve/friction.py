"""Friction about rest: sliding directions, and terms of sliding or stuck joints and drives in the matrices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.solve.batch import RestMatrices, RestStates
from flexapod.solve.kernel import evaluate
from flexapod.solve.system import System


def sliding_jacobian(system: System, q: Array) -> Array:
    """Derivatives of the rates of sliding by those of coordinates (P, legs, n), (P, legs, bristles, n), Eq. (T19.7)."""
    n, b, (P, legs, _) = system.n, system.kernel.shapes.bristles, q.shape
    v = np.repeat(np.eye(n), P * legs, axis=0)
    arguments = [q, v, np.zeros(system.rows), np.zeros(2 * b), np.zeros(1), system.leg_p]
    outputs = [(n,), (2 * b,), (b,), (b,), (2,)]
    state = evaluate(system.kernel, "leg_friction", n * P * legs, arguments, outputs)[1]
    return np.moveaxis(state[:, b:].reshape(n, P, legs, b), 0, -1)


def bristle_parameters(system: System, lam: Array) -> tuple[Array, Array]:
    """Numbers of each bristle, (legs, bristles, 8), and sliding friction, (P, legs, bristles) [N, N m].

    ``lam`` (P, legs, rows): forces of the closures; the numbers are those of `elements.friction.bristle_friction`.
    """
    shapes = system.kernel.shapes
    layout = leg_parameters(shapes)
    found = [
        np.repeat(system.leg_p[:, None, columns(layout, name)], count, axis=1)
        for name, count in shapes.friction_parameters
    ]
    p = np.concatenate(found, axis=1)
    load = np.linalg.norm(lam[..., :3], axis=-1)
    return p, p[..., 0] + p[..., 1] * load[..., None]


def with_friction(system: System, x: RestStates, m: RestMatrices, *, stuck: bool) -> RestMatrices:
    """Matrices with the viscous friction of what slides, or, stuck, with bristles as springs too, Eq. (T19.16)."""
    if not system.kernel.shapes.bristles or not len(x):
        return m
    J, (p, force) = sliding_jacobian(system, x.q), bristle_parameters(system, x.lam)
    stiffness = force / p[..., 2] * stuck
    damping = p[..., 5] + stiffness * p[..., 6]
    K, D = (J.swapaxes(-1, -2) @ (part[..., None] * J) for part in (stiffness, damping))
    return replace(m, K=m.K + K, D=m.D + D)
