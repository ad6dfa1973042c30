"""Legs of every kind against brute-force quadrature and integration of their exact kinematics."""

import numpy as np
import pytest
from tests.helpers import legs_of_all_kinds as legs
from tests.oracles import chains

from flexapod.kinematics.rotations import quaternion

pytestmark = pytest.mark.consistency

MOVING = ["slider", "crank", "pose with spin and twist", "pose on a slider", "pose on a crank", "flexures on a crank"]
SLIDER = ("carriage_mass", "carriage_axis")
CRANK = (*SLIDER, "carriage_inertia", "carriage_com", "carriage_arm")
ORACLE = {"slider": SLIDER, "crank": CRANK}


def complex_shapes(basis):
    """Shapes at complex places, as far as a complex step sees them: f(x) + i h f'(x)."""

    def phi(zeta, order):
        z = np.asarray(zeta)
        return basis.values(z.real, order) + 1j * z.imag * basis.values(z.real, order + 1)

    return lambda zeta, order: phi(zeta, order) if np.iscomplexobj(zeta) else basis.values(zeta, order)


def oracle_numbers(ours, given):
    bare = {
        name: given[name]
        for name in legs.PHYSICS
        if not name.startswith(("carriage", "GJ", "base_", "gamma_", "platform_"))
    }
    bare |= {"R0": given["R0"]} | {name: given[name] for name in ORACLE.get(ours.chain.carriage, ())}
    return bare | ({"GJ": given["GJ"]} if ours.has("t") else {})


@pytest.mark.parametrize(("kind", "spins"), [*((kind, 1.0) for kind in MOVING), ("pose on a slider", 0.0)])
def test_energies_are_right_to_second_order(kind, spins):
    # T keeps terms to second order in the amplitudes, so that a tenth of them leaves a thousandth of the gap. Gravity
    # and strain are exact in these kinematics.
    ours, gaps = legs.shapes(kind), []
    free = (
        dict.fromkeys(("base_flexure", "platform_flexure"), np.zeros((6, 6)))
        | dict.fromkeys(("base_stiffness", "gamma_stiffness"), np.zeros(3))
        | {
            "drive_stiffness": 0.0,
            "carriage_stiffness": 0.0,
        }
    )
    given = legs.numbers(3, **free)
    for amplitude in (3e-4, 3e-5):
        x = legs.state(ours, 3, amplitude, given)
        T, Vg, Vs = chains.energies(
            legs.pieces(ours, x["q"]),
            legs.pieces(ours, x["v"]),
            oracle_numbers(ours, given),
            complex_shapes(ours.beam.a),
        )
        found = legs.call(ours, "leg_energies", x)["energies"]
        gaps.append(abs(found[0] - T))
        np.testing.assert_allclose(found[1:], [Vg, Vs], rtol=1e-11, atol=1e-12)
    assert gaps[0] / gaps[1] == pytest.approx(1000, rel=0.2)


@pytest.mark.parametrize("kind", ["pose", "pose with spin and twist", "flexures on a crank"])
@pytest.mark.parametrize("basis", ["tip-load", "hermite"])
def test_the_tip_turns_as_a_frame_carried_along_the_line(kind, basis):
    # A payload that sits in the exact axes of the tip leaves a gap of third order: the sign and the factor of every
    # second-order term count, and a tenth of the amplitudes leaves a thousandth of the gap. The place is exact.
    ours, gaps = legs.shapes(kind, modes=4 if basis == "hermite" else 3, basis=basis), []
    for amplitude in (5e-3, 5e-4):
        given = legs.numbers(5, platform_frame=np.eye(3), leg_frame=np.eye(3), joint=np.zeros(3))
        x = legs.state(ours, 5, amplitude, given)
        q = legs.pieces(ours, x["q"]) | {"gamma1": 0.0, "gamma2": 0.0, "gamma3": 0.0}
        if ours.has("t"):
            x["q"][ours.index("t")] = q["t"] = 8 * amplitude
        for name in ("gamma1", "gamma2", "gamma3", "e1", "e2", "e3"):
            if ours.has(name):
                x["q"][ours.index(name)] = 0.0
        numbers = oracle_numbers(ours, given)
        axes = chains.cylinder_frame(q, numbers)[1] @ chains.tip_axes(q, numbers, ours.beam.a.values)
        tip = np.real(chains.place(q, 0.0, numbers, complex_shapes(ours.beam.a)))
        x["pose"] = np.concatenate([tip, quaternion(axes)])
        gap = legs.call(ours, "leg_residual", x)["gap"]
        if basis == "tip-load":  # the quadrature of the place knows smooth shapes only
            np.testing.assert_allclose(gap[:3], 0.0, atol=1e-14)
        gaps.append(np.linalg.norm(gap[3:]))
    assert gaps[0] / gaps[1] == pytest.approx(1000, rel=0.2)
