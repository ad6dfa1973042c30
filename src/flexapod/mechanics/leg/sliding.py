"""Sliding with friction in a leg, and the named functions of it, Eqs. (T19.7)-(T19.8)."""

from flexapod.mechanics.elements.friction import BristleFriction, bristle_decay, bristle_friction
from flexapod.mechanics.leg.layout import Shapes, leg_parameters
from flexapod.mechanics.symbolic.functions import NamedFunction
from flexapod.mechanics.symbolic.vocabulary import SX, dot, jacobian, split, sqrt, symbol, symbols, vertcat, zeros

FORCELESS = 1e-12  # N^2, added to the square of a joint's force: a root has no slope at zero


def friction_functions(shapes: Shapes) -> list[NamedFunction]:
    """Friction of a leg at the end of a step of length h, how it grows with the rates, what slides; none without."""
    if not shapes.friction_parameters:
        return []
    p_vector, p = symbols(leg_parameters(shapes), "p")
    q, qs = symbols(shapes.layout, "q")
    v, vs = symbols(shapes.layout, "v")
    lam, h, begin = symbol("lam", shapes.rows), symbol("h"), symbol("begin", 2 * shapes.bristles)
    z, before = (
        split(part, shapes.friction_parameters) for part in (begin[: shapes.bristles], begin[shapes.bristles :])
    )
    rates = {slot.parameters[0][0]: slot.sliding_speed(p, qs, vs) for slot, _ in shapes.friction_elements}
    load = sqrt(dot(lam[:3], lam[:3]) + FORCELESS) if shapes.rows else zeros(1)
    found = {
        name: bristle_friction(getattr(p, name), load, rate, getattr(before, name), getattr(z, name), h)
        for name, rate in rates.items()
    }
    sliding, force = vertcat(*rates.values()), _all(found, "force")
    on_leg = jacobian(sliding, v).T @ force  # (T19.7)
    inputs = [("q", q), ("v", v), ("lam", lam), ("begin", begin), ("h", h), ("p", p_vector)]
    outputs = [
        ("r", on_leg),
        ("state", vertcat(_all(found, "bristles"), sliding)),
        ("force", force),
        ("rate", _all(found, "rate")),
        ("energies", vertcat(dot(sliding, force), sum((x.stored for x in found.values()), zeros(1)))),  # (T19.8)
    ]
    lost = vertcat(*(bristle_decay(getattr(p, name), rate) for name, rate in rates.items()))
    return [
        NamedFunction("leg_friction", inputs, outputs),
        NamedFunction("leg_friction_matrix", inputs, [("D", jacobian(on_leg, v))]),
        NamedFunction("leg_sliding", [("q", q), ("v", v), ("p", p_vector)], [("rates", sliding), ("forgetting", lost)]),
    ]


def _all(found: dict[str, BristleFriction], name: str) -> SX:
    return vertcat(*(getattr(x, name) for x in found.values()))
