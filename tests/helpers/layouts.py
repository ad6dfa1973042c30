"""Layouts of legs from the bases of their beam, and what else they have by name."""

from dataclasses import fields

from flexapod.mechanics.elements.flexure import Flexures
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.tip_body import PlanarTipBody, TipBody
from flexapod.mechanics.elements.torsion import Torsion
from flexapod.mechanics.leg.layout import Shapes
from flexapod.mechanics.leg.leg_beam import LegBeam
from flexapod.mechanics.leg.leg_chain import LegChain

CHAIN = {field.name for field in fields(LegChain)}


def layout(a, b, axial, *, elements=(), torsion=False, tip_body=False, flexure=False, **given):
    """Shapes of a leg; ``given``: what `LegChain` has, and the rest of `LegBeam`."""
    chain = LegChain(**{name: value for name, value in given.items() if name in CHAIN})
    beam = LegBeam(a=a, b=b, axial=axial, **{name: value for name, value in given.items() if name not in CHAIN})
    body = PlanarTipBody if chain.planar else TipBody
    own = (*(Slot(Torsion),) * torsion, *(Slot(body),) * tip_body, *(Slot(Flexures),) * flexure)
    return Shapes(beam=beam, chain=chain, elements=(*own, *elements))
