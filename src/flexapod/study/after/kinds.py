"""What mostly moves in a mode, in words: from its kinetic and strain energies."""

from __future__ import annotations

import numpy as np

from flexapod.mechanics.layout import Shapes
from flexapod.solve.modes import RobotModes
from flexapod.typing import Array

MOSTLY = 0.5  # share of an energy from which a part names the mode


def mode_kinds(found: RobotModes) -> list[str]:
    """``payload``, ``leg n bending``, ``legs bending``, ``leg n axial``, ``legs axial`` ... for each mode.

    The kinetic energy says whether payload or legs; that of the legs, which leg; the strain energy of its coordinates,
    how: bending, axial, twisting (of the leg about its axis), carriage (on the spring of its drive), turning (on
    springs of joints).

    Parameters
    ----------
    found : RobotModes
    """
    system, state = found.system, found.equilibrium.state
    matrices, n = system.matrices(state, found.wrench), system.n
    legs = found.shapes[:, :-6].reshape(len(found.shapes), -1, n)
    blocks = [slice(i * n, (i + 1) * n) for i in range(legs.shape[1])]
    kinetic = np.stack([_form(legs[:, i], matrices.M[at, at]) for i, at in enumerate(blocks)], axis=1)
    energies = {}
    for name, chosen in _groups(system.kernel.shapes).items():
        parts = [_form(legs[:, i, chosen], matrices.K[at, at][np.ix_(chosen, chosen)]) for i, at in enumerate(blocks)]
        energies[name] = np.sum(parts, axis=0)
    return [_kind(row, {name: of[k] for name, of in energies.items()}) for k, row in enumerate(kinetic)]


def _groups(shapes: Shapes) -> dict[str, list[int]]:
    """Coordinates of a leg by what their strain energy is called."""
    names = {
        "bending": ("a", "b"),
        "axial": ("l", "c"),
        "twisting": ("spin", "t"),
        "carriage": ("chi",),
        "turning": ("alpha", "beta", "gamma1", "gamma2", "gamma3"),
    }
    sizes = dict(shapes.layout)
    found = {
        kind: [shapes.index(name) + k for name in group if name in sizes for k in range(sizes[name])]
        for kind, group in names.items()
    }
    if shapes.closure != "pose":
        del found["turning"]  # no springs
    return {kind: chosen for kind, chosen in found.items() if chosen}


def _form(vectors: Array, matrix: Array) -> Array:
    return np.einsum("mi,ij,mj->m", vectors, matrix, vectors)


def _kind(kinetic: Array, energies: dict[str, float]) -> str:
    whole = float(kinetic.sum())  # of a mass-normalised mode: 1 with the payload's
    if np.isnan(whole):
        return ""
    if whole < MOSTLY:
        return "payload"
    first = int(kinetic.argmax())
    name = f"leg {first + 1}" if kinetic[first] > MOSTLY * whole else "legs"
    return f"{name} {max(energies, key=energies.__getitem__)}"
