"""Friction with presliding after LuGre: a bristle for each direction in which things slide, Eqs. (T19.1)-(T19.6)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexapod.symbolic.vocabulary import cos, dot, exp, sin, sqrt, vertcat

if TYPE_CHECKING:
    from flexapod.symbolic.vocabulary import SX

__all__ = ["Rubbing", "forgetting", "rubbing", "turning"]

STILL = 1e-60  # added to squares: a root has no slope at zero


@dataclass(frozen=True, kw_only=True)
class Rubbing:
    """What rubs at a place, direction by direction.

    ``force`` against the sliding [N m, of drives N]; ``bristles`` bent by now, and their ``rate``; ``stored``: energy.
    """

    force: SX
    bristles: SX
    rate: SX
    stored: SX


def rubbing(p: SX, load: SX, v: SX, before: SX, z: SX, h: SX, *, falling: bool = True) -> Rubbing:
    """Friction at the end of a step.

    Parameters
    ----------
    p : SX
        Force that is there without load, force per ``load``, presliding, static force over sliding force less one,
        one over the Stribeck rate, viscous friction, damping time of the bristles, and 1 where directions slide
        together (a ball), 0 where each slides by itself.
    load : SX
        Force that presses [N].
    v, before : SX
        Rates of sliding at the end of the step and at its begin.
    z, h : SX
        Bristles at its begin, and its length; with a step of 0 they are what they are.
    falling : bool
        The damping of the bristles falls with the rate, so that they never give energy, Eq. (T19.4).
    """
    sliding, reach, damping_time = p[0] + p[1] * load, p[2], p[6]
    way, mean = 0.5 * h * (before + v), 0.5 * (before + v)
    x = _size(way, p[7]) / _limit(p, mean)  # (T19.5)
    bent = (z + way * (1 + x / 2 + x**2 / 6)) / (1 + x + x**2 / 2 + x**3 / 6)
    fast = _size(v, p[7])
    rate = v - fast * bent / _limit(p, v)  # (T19.1)
    if falling:
        damping_time = damping_time / (1 + 0.25 * damping_time * fast / reach)  # (T19.4)
    return Rubbing(
        force=sliding / reach * (bent + damping_time * rate) + p[5] * v,  # (T19.3)
        bristles=bent,
        rate=rate,
        stored=0.5 * sliding / reach * dot(bent, bent),
    )


def forgetting(p: SX, v: SX) -> SX:
    """Share of their bending that bristles lose in a second at a rate of sliding, Eq. (T19.1) [1/s]."""
    return _size(v, p[7]) / _limit(p, v)


def _limit(p: SX, v: SX) -> SX:
    """How far bristles bend at a rate of sliding, Eq. (T19.2)."""
    return p[2] * (1 + p[3] * exp(-((_size(v, p[7]) * p[4]) ** 2)))


def _size(v: SX, together: SX) -> SX:
    """Of each direction, or, where they slide together, of all."""
    square = v**2
    return sqrt(square + together * (dot(v, v) - square) + STILL)


def turning(angles: SX, rates: SX, together: SX) -> SX:
    """How fast a joint slides: the rates of its successive angles, or its angular velocity where it is a ball."""
    first, second = angles[0], angles[1]
    of_ball = vertcat(  # (T19.6)
        rates[0] + sin(second) * rates[2],
        cos(first) * rates[1] - sin(first) * cos(second) * rates[2],
        sin(first) * rates[1] + cos(first) * cos(second) * rates[2],
    )
    return rates + together * (of_ball - rates)
