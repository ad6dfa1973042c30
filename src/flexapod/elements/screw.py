"""A rotor that drives a stroke through springs in series: screw, nut, bearing, brackets, Eqs. (T15.5), (T15.11)."""

from types import SimpleNamespace

from flexapod.elements.frame import Energies
from flexapod.elements.gap import past_gap, touching
from flexapod.elements.oil_column import oil_column
from flexapod.symbolic.vocabulary import SX


def softening(p: SimpleNamespace, stroke: SX) -> SX:
    """Compliance of the springs before a stroke over that at home, without oil."""
    away = stroke - p.series_home
    return 1 + away * (p.series_softening[0] + away * p.series_softening[1])


def twisting(p: SimpleNamespace, stroke: SX) -> SX:
    """Share kappa of a shaft's twist in it, Eq. (T19.12)."""
    return (p.drive_friction_twist[0] + p.drive_friction_twist[1] * (stroke - p.series_home)) / softening(p, stroke)


def screw(
    p: SimpleNamespace,
    qs: SimpleNamespace,
    vs: SimpleNamespace,
    *,
    oil: bool = False,
    turning: bool = False,
    gap: bool = False,
) -> Energies:
    """Energies of springs and dampers between the rotor's travel r and the stroke l, and of what turns with the rotor.

    The compliance of the springs is a polynomial of second degree in l, as that of the shaft depends on the nut's
    place; with `oil` that of a hydraulic cylinder comes to it. ``turning``: a piston that is not keyed takes the nut
    along as it turns. ``gap``: the springs touch past the play only.
    """
    softer = softening(p, qs.l)
    if oil:
        softer += oil_column(p, qs.l - p.series_home)
    stiffness = p.series_stiffness / softer  # (T15.5)
    nut, rate = qs.l, vs.l
    if turning:  # (T23.41)
        nut, rate = nut - p.series_turn * qs.spin, rate - p.series_turn * vs.spin
    x, rate = qs.r - nut, vs.r - rate
    if gap:
        x, rate = past_gap(x, p.half_play), touching(x, p.half_play) * rate  # (T16.26)-(T16.27)
    return Energies(
        kinetic=0.5 * p.rotor_mass * vs.r**2,  # (T15.12)
        strain=0.5 * stiffness * x**2,  # (T15.11)
        dissipation=0.5 * p.series_damping * rate**2,
    )
