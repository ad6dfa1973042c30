"""The named lateral bases; each is one line, all pass the same contract test."""

from functools import lru_cache

from flexapod.mechanics.shapes.beam_functions import clamped_free, clamped_tip_mass
from flexapod.mechanics.shapes.lateral import LateralBasis, integrate
from flexapod.mechanics.shapes.load_shapes import load_shapes
from flexapod.mechanics.shapes.piecewise import hermite_shapes
from flexapod.mechanics.shapes.polynomials import tip_load_shapes
from flexapod.mechanics.shapes.segments import segment_shapes


@lru_cache(maxsize=64)
def lateral_basis(
    name: str,
    count: int,
    tip_mass_ratio: float = 0.0,
    tip_inertia_ratio: float = 0.0,
    speed: float = 0.0,
    hub_ratio: float = 0.0,
    moment: bool = False,
) -> LateralBasis:
    """Lateral basis ``name`` with ``count`` shapes.

    Parameters
    ----------
    name : {"clamped-free", "tip-load", "tip-mass", "segments", "hermite"}
    count : int
        Shapes per plane, 0 to 12 (``hermite`` 24); of ``segments`` one per segment, of ``hermite`` two per element.
    tip_mass_ratio, tip_inertia_ratio : float
        m/(rhoA s) and J/(rhoA s^3) of the tip body, dimensionless, in the ``tip-mass`` eigenfunctions; ``tip-load``
        asks whether J is positive (the tip takes a moment) and, where the beam turns, for the tension by m.
    speed, hub_ratio : float
        theta_dot sqrt(rhoA s^4 / EI) and R_h/s of a beam in steady rotation, in ``tip-load`` shapes only.

    moment : bool
        The tip takes a moment from a joint: ``tip-load`` then spans the static shape under a tip moment too.

    Raises
    ------
    ValueError
        Unknown name or an odd number of ``hermite`` shapes (the study file is checked before).
    """
    if name == "clamped-free":
        return integrate(name, clamped_free(count))
    if name == "tip-load" and (speed or tip_inertia_ratio):
        turning = load_shapes(
            count, speed=speed, hub_ratio=hub_ratio, mass_ratio=tip_mass_ratio, moment=tip_inertia_ratio > 0
        )
        return integrate(name, turning)
    if name == "tip-load":
        return integrate(name, tip_load_shapes(count, moment=moment))
    if name == "tip-mass":
        return integrate(name, clamped_tip_mass(count, tip_mass_ratio, tip_inertia_ratio))
    if name == "segments":
        return integrate(name, segment_shapes(count), pieces=2 * count)
    if name == "hermite":
        return integrate(name, hermite_shapes(count), pieces=count // 2)
    raise ValueError(f"unknown basis {name!r}: choose clamped-free, tip-load, tip-mass, segments or hermite")
