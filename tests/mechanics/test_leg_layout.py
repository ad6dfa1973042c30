"""Order of coordinates and parameters in the kernels of a leg."""

import pytest
from tests.helpers.layouts import layout

from flexapod.mechanics.leg.layout import LEG_PARAMETERS, leg_parameters
from flexapod.mechanics.shapes import axial_basis, lateral_basis

pytestmark = pytest.mark.unit


def shapes(**switches):
    lateral = lateral_basis("tip-load", 2)
    return layout(a=lateral, b=lateral, axial=axial_basis(1), **switches)


FLEXURES = ["u1", "u2", "u3", "e1", "e2", "e3"]
EVERYTHING = {"closure": "pose", "carriage": "crank", "spin": True, "torsion": True, "flexure": True}


def test_what_a_leg_has_beside_stands_after_todays_coordinates():
    ours, bare = shapes(**EVERYTHING), shapes()
    assert ours.layout[: len(bare.layout)] == bare.layout
    assert [name for name, _ in ours.layout[len(bare.layout) :]] == [
        "chi",
        "spin",
        "t",
        "gamma1",
        "gamma2",
        "gamma3",
        *FLEXURES,
    ]
    assert leg_parameters(ours)[: len(LEG_PARAMETERS)] == LEG_PARAMETERS == leg_parameters(bare)


@pytest.mark.parametrize(("switches", "rows", "names"), [
    ({"closure": "none"}, 0, []),
    ({}, 3, ["alpha", "beta", "l"]),
    ({"closure": "pose"}, 6, ["alpha", "beta", "l", "gamma1", "gamma2", "gamma3"]),
    (EVERYTHING | {"pivot_spin": True}, 6, ["alpha", "beta", "l", "gamma1", "gamma2", "spin"]),
])  # fmt: skip
def test_a_closure_has_as_many_pivots_as_rows(switches, rows, names):
    ours = shapes(**switches)
    assert ours.rows == rows
    assert ours.pivots == tuple(ours.index(name) for name in names)
