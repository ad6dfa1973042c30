"""A leg reduced from solid elements: lateral shapes of a clamped solid piston as a basis, Eqs. (T10.22)-(T10.24)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.mechanics.shapes.lateral import LateralBasis, integrate, proportional_damping
from flexapod.model import Rectangle, Tube
from flexapod.solve.fem.reduction import StationModel, reduced_beam

_INTERVALS = 24


def solid_leg_shapes(
    section: Tube | Rectangle,
    length: float,
    count: int,
    size: float | None = None,
    *,
    poisson: float = 0.0,
    moment: bool = False,
) -> LateralBasis:
    """Lateral basis of a solid piston held by a guide: static tip-load shape, then modes with the tip held.

    Shapes are section averages of deflection and rotation at 24 equal intervals, cubic between them; the stiffness is
    the solid's strain energy at ``length``, shear and mouth included. Material cancels but for Poisson's ratio.

    `length`: free length of the piston [m]; the basis is used at other lengths with the stiffness scaled as that of a
    beam. `count`: shapes, 1 to 12. `size`: wanted edge of the elements [m], default a sixth of the larger side of the
    section, at most an interval. `moment`: the tip takes a moment from a joint, the static shape under one takes the
    place of the last mode. InputError: sizes or counts that do not fit.
    """
    if not 1 <= count <= 12:
        raise InputError("is not a number of shapes", key="count", value=count, allowed="1 to 12")
    if not (np.isfinite(length) and length > 0):
        raise InputError("is not a length", key="length", value=length, allowed="above 0 m")
    spacing = length / _INTERVALS
    # Quadratic elements need no second one across the smaller side of a section.
    side = max(section.width, section.height) if isinstance(section, Rectangle) else section.diameter
    # Behind the mouth as much as the section's end effects need to fade.
    held = max(4, int(np.ceil(3 * section.depth / spacing)))
    model = reduced_beam(
        section,
        spacing * (_INTERVALS + held),
        min(side / 6, spacing) if size is None else size,
        E=1.0 / section.second_moment,
        density=1.0 / section.area,
        poisson=poisson,
        spacing=spacing,
    )
    shapes, stiffness = _shapes(model, length, count, moment)
    basis = integrate("solid-fem", shapes, pieces=_INTERVALS)
    damping = proportional_damping(basis.mass[:count, :count], stiffness)
    return replace(basis, stiffness=stiffness, damping=damping)


def _shapes(model: StationModel, length: float, count: int, moment: bool) -> tuple[list[Callable[..., Array]], Array]:
    """Shapes over zeta and their stiffness matrix K^ (count, count), of EI = rhoA = 1."""
    from scipy.linalg import eigh

    n = 2 * _INTERVALS
    K, M = model.stiffness[:n, :n], model.mass[:n, :n]
    unit = np.zeros(n)
    unit[0] = 1.0
    load = np.linalg.solve(K, unit)
    vectors = np.zeros((n, count))
    vectors[:, 0] = load / load[0]
    K_held, M_held = K[1:, 1:], M[1:, 1:]
    modes = eigh(K_held, M_held)[1][:, : count - 1]
    if moment and count > 1:
        span = np.column_stack([np.linalg.solve(K_held, unit[:-1]), modes[:, :-1]])
        modes = span @ eigh(span.T @ K_held @ span, span.T @ M_held @ span)[1]
    vectors[1:, 1:] = modes * np.sqrt(length)
    # The last free station is the one nearest to the mouth: positive there, as in the other bases.
    vectors *= np.sign(vectors[-2])
    stiffness = length**3 * vectors.T @ K @ vectors
    return [_shape(v, length) for v in vectors.T], 0.5 * (stiffness + stiffness.T)


def _shape(averages: Array, length: float) -> Callable[..., Array]:
    """Cubic between stations with the given (w, theta) from the tip to the mouth, where both vanish."""
    from scipy.interpolate import CubicHermiteSpline

    values = np.concatenate([[0.0], averages[0::2][::-1]])
    slopes = np.concatenate([[0.0], averages[1::2][::-1]]) * length
    spline = CubicHermiteSpline(np.linspace(0.0, 1.0, len(values)), values, slopes)

    def shape(zeta: Array, derivative: int = 0) -> Array:
        return spline(np.asarray(zeta, dtype=float), derivative)

    return shape
