"""What mostly moves in a mode, in words: from its kinetic and strain energies."""

from __future__ import annotations

import numpy as np

from flexapod.solve.modes import RobotModes
from flexapod.typing import Array

__all__ = ["mode_kinds"]

MOSTLY = 0.5  # share of an energy from which a part names the mode


def mode_kinds(found: RobotModes) -> list[str]:
    """``payload``, ``leg n bending``, ``legs bending``, ``leg n axial``, ``legs axial`` for each mode.

    The kinetic energy says whether payload or legs; that of the legs, which leg; the strain energy of its shapes, how.

    Parameters
    ----------
    found : RobotModes
    """
    system, state = found.system, found.equilibrium.state
    matrices, n, axial = system.matrices(state, found.wrench), system.n, system.kernel.shapes.axial.count
    legs = found.shapes[:, :-6].reshape(len(found.shapes), -1, n)
    blocks = [slice(i * n, (i + 1) * n) for i in range(legs.shape[1])]
    kinetic = np.stack([_form(legs[:, i], matrices.M[at, at]) for i, at in enumerate(blocks)], axis=1)
    lateral = np.stack([_form(legs[:, i, 3 + axial :], matrices.K[at, at][3 + axial :, 3 + axial :])
                        for i, at in enumerate(blocks)], axis=1)  # fmt: skip
    along = np.stack([_form(legs[:, i, 2 : 3 + axial], matrices.K[at, at][2 : 3 + axial, 2 : 3 + axial])
                      for i, at in enumerate(blocks)], axis=1)  # fmt: skip
    return [_kind(*rows) for rows in zip(kinetic, lateral, along, strict=True)]


def _form(vectors: Array, matrix: Array) -> Array:
    return np.einsum("mi,ij,mj->m", vectors, matrix, vectors)


def _kind(kinetic: Array, lateral: Array, along: Array) -> str:
    whole = float(kinetic.sum())  # of a mass-normalised mode: 1 with the payload's
    if np.isnan(whole):
        return ""
    if whole < MOSTLY:
        return "payload"
    first = int(kinetic.argmax())
    name = f"leg {first + 1}" if kinetic[first] > MOSTLY * whole else "legs"
    return f"{name} {'axial' if along.sum() > lateral.sum() else 'bending'}"
