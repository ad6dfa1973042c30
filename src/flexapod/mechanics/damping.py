"""Equal damping ratio for every mode of the bare piston, Eqs. (T5.1)-(T5.3)."""

from types import SimpleNamespace

from flexapod.mechanics.layout import Shapes
from flexapod.symbolic.vocabulary import SX, quadratic, sqrt


def dissipation(shapes: Shapes, p: SimpleNamespace, s: SX, vs: SimpleNamespace) -> SX:
    """Rayleigh function on the amplitude rates at fixed zeta; dissipated power is twice this, Eq. (T5.1)."""
    lateral = 2 * p.zeta * sqrt(p.EI * p.rhoA) / s  # (T5.3)
    axial = 2 * p.zeta * sqrt(p.EA * p.rhoA)  # (T5.3)
    bending = quadratic(vs.a, shapes.a.damping) + quadratic(vs.b, shapes.b.damping)
    return 0.5 * lateral * bending + 0.5 * axial * quadratic(vs.c, shapes.axial.damping)
