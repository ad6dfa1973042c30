"""One leg of a robot with its stroke locked: frequencies by its kernel."""

import numpy as np
from scipy.linalg import eigh, null_space
from tests.helpers.runs import leg_vector, uncompiled
from tests.oracles import beams

PISTON = beams.round_section(0.027, 200e9, 7800.0)
# cylinder (uniform, up to its mouth) and its mass, free length, frequencies [Hz] of the table
LEGS = [
    (0.3, 3.0, 0.6, [67.976401, 321.006353, 844.644953]),
    (0.4, 5.0, 0.6, [54.579565, 291.10741, 810.989844]),
    (0.5, 8.0, 0.6, [43.768985, 271.284004, 790.6379]),
    (0.4, 5.0, 0.34, [113.893634, 823.028156]),
    (0.4, 5.0, 0.47, [75.104984, 452.327661]),
]


def squared_frequencies(modes, *, mouth=0.0, mass=0.0, free=0.6, thrust=0.0, axial=0, basis="tip-load", tip="pinned"):
    """omega^2 of one leg with its stroke locked; its tip pinned in the closure, or free with the universal joint held.

    A positive thrust is the force of the leg on what it carries.
    """
    k = uncompiled(basis, modes, axial)
    p = leg_vector(
        **PISTON,
        Lp=free,
        mouth=mouth,
        cylinder_mass=mass,
        cylinder_com=mouth / 2,
        cylinder_inertia=mass * mouth**2 / 12,
    )
    unit = np.eye(k.shapes.size)
    M, _, K, J = k.leg_matrices((mouth + free) * unit[2], np.array([0.0, 0.0, thrust]), p)
    N = null_space(np.vstack([unit[2], J if tip == "pinned" else unit[:2]]))
    return eigh(N.T @ K @ N, N.T @ M @ N, eigvals_only=True)


def hertz(squared):
    return np.sqrt(squared) / (2 * np.pi)
