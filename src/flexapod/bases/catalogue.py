"""The named lateral bases; each is one line, all pass the same contract test."""

from functools import lru_cache

from flexapod.bases.beam_functions import clamped_free, clamped_tip_mass
from flexapod.bases.hermite import hermite_shapes
from flexapod.bases.lateral import LateralBasis, integrate
from flexapod.bases.polynomials import tip_load_shapes
from flexapod.bases.segments import segment_shapes


@lru_cache(maxsize=64)
def lateral_basis(name: str, count: int, tip_mass_ratio: float = 0.0, tip_inertia_ratio: float = 0.0) -> LateralBasis:
    """Lateral basis ``name`` with ``count`` shapes.

    Parameters
    ----------
    name : {"clamped-free", "tip-load", "tip-mass", "segments", "hermite"}
    count : int
        Shapes per plane, 0 to 12; of ``segments`` one per segment, of ``hermite`` two per element.
    tip_mass_ratio, tip_inertia_ratio : float
        m/(rhoA s) and J/(rhoA s^3) of the ``tip-mass`` eigenfunctions, dimensionless; unused by the others.

    Raises
    ------
    ValueError
        Unknown name or an odd number of ``hermite`` shapes (the study file is checked before).
    """
    if name == "clamped-free":
        return integrate(name, clamped_free(count))
    if name == "tip-load":
        return integrate(name, tip_load_shapes(count))
    if name == "tip-mass":
        return integrate(name, clamped_tip_mass(count, tip_mass_ratio, tip_inertia_ratio))
    if name == "segments":
        return integrate(name, segment_shapes(count), pieces=2 * count)
    if name == "hermite":
        return integrate(name, hermite_shapes(count), pieces=count // 2)
    raise ValueError(f"unknown basis {name!r}: choose clamped-free, tip-load, tip-mass, segments or hermite")
