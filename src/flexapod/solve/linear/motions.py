"""Motions of a robot by name, those that its commands impose, and its matrices on them, Eqs. (T20.4)-(T20.6)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.solve.batch import RestMatrices
from flexapod.solve.saddle_point import solve_each
from flexapod.solve.statics.elimination import leg_bases
from flexapod.solve.statics.reduction import border_rows, expand_motions, flat_columns, hub_motion
from flexapod.solve.system import System

COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")
PLATES = {"m": "platform plate", "f": "base plate"}


def coordinate_names(system: System) -> list[str]:
    """Names of the flat coordinates, and behind them of those that all legs share, as `flat_columns` counts them."""
    shapes = system.kernel.shapes
    of_leg = [name if size == 1 else f"{name}{k + 1}" for name, size in shapes.layout for k in range(size)]
    found = [f"leg {i + 1} {name}" for i in range(system.legs) for name in of_leg]
    found += [f"payload {name}" for name in COMPONENTS]
    return found + [f"{PLATES[x]} {name}" for x in ("m", "f") if shapes.has(x) for name in COMPONENTS]


def held_motions(system: System, m: RestMatrices, which: Sequence[tuple[int, int]]) -> Array:
    """Flat motions (P, size, c) by unit steps of held coordinates (leg, coordinate), all else held, Eq. (T20.5).

    What stands for held pivots moves with them; independent motions are zero.

    Raises
    ------
    InputError
        Legs that cannot give way hold the payload against each other, so that one command alone moves nothing.
    """
    bases, n = leg_bases(system, m), system.n
    P, count = len(m.K), len(which)
    own, G = np.zeros((P, system.size, count)), border_rows(bases)
    rows = [(int(leg), int(at)) for b in bases for leg in b.legs for at in b.border]
    target = np.zeros((P, len(rows), count))
    for k, (leg, at) in enumerate(which):
        if (leg, at) in rows:
            target[:, rows.index((leg, at)), k] = 1.0
            continue
        b = next(b for b in bases if leg in b.legs)
        i = int(np.flatnonzero(b.legs == leg)[0])
        own[:, leg * n + at, k] = 1.0
        own[:, leg * n + b.pivot, k] = -(b.inverse[:, i] @ m.J[:, leg, :, at, None])[..., 0]
    for r, (leg, at) in enumerate(rows):
        target[:, r] -= own[:, leg * n + at]
    if not rows or not count:
        return own
    by = np.array([system.substitutes[leg, at] for leg, at in rows])
    kept = by >= 0
    if np.abs(target[:, ~kept]).max(initial=0.0) > 0:
        raise InputError(
            "cannot follow one command alone: legs that cannot give way hold the payload against each other",
            key="inputs",
            value="command",
            next_step="Give legs that give way: a bending fidelity with axial shapes, or servo drives",
        )
    z = np.zeros((P, G.shape[2], count))
    place = (flat_columns(system, bases) == by[kept][:, None]).argmax(axis=1)
    z[:, place] = solve_each(G[:, kept][..., place], target[:, kept])
    return own + expand_motions(system, bases, z)


def flat_forces(system: System, of_legs: Array, of_payload: Array, flat: Array, X: Array | None = None) -> Array:
    """A matrix of the whole robot, given leg by leg and of the payload, times flat motions (P, size, any).

    ``of_legs`` (P, legs, n, n); ``of_payload`` (P, 6, 6) with shared coordinates behind; ``X``: as of `RestMatrices`.
    """
    P, k = len(flat), system.legs * system.n
    legs = flat[:, :k].reshape(P, system.legs, system.n, flat.shape[-1])
    found = np.zeros_like(flat)
    on_legs = of_legs @ legs
    if X is not None:
        on_legs = on_legs + X @ flat[:, None, k:]
        found[:, k:] += (X.swapaxes(-1, -2) @ legs).sum(axis=1)
    found[:, :k] += on_legs.reshape(P, k, flat.shape[-1])
    if of_payload.shape[-1]:
        on_hub = of_payload @ hub_motion(system, flat)
        found[:, k:] += on_hub[:, :6]
        found[:, system.shared_coordinates] += on_hub[:, 6:]
    return found


def project_on_motions(system: System, m: RestMatrices, flat: Array) -> tuple[Array, Array, Array]:
    """M, D, K times flat motions (P, size, any), Eq. (T20.6)."""
    no_damping = np.zeros((len(flat), 6 + system.shared_coordinates.size, 6 + system.shared_coordinates.size))
    return (
        flat_forces(system, m.M, m.payload_M, flat),
        flat_forces(system, m.D, no_damping, flat),
        flat_forces(system, m.K, m.payload_K, flat, m.X),
    )
