"""The closed forms of the leg's energies against brute-force quadrature of its exact kinematics."""

import numpy as np
import pytest
from tests.helpers.layouts import layout
from tests.oracles import nonlinear

from flexapod.mechanics.leg.layout import LEG_PARAMETERS, Shapes
from flexapod.mechanics.shapes import axial_basis, lateral_basis
from flexapod.solve.kernel import kernel
from flexapod.solve.shapes import space_shapes

pytestmark = pytest.mark.consistency

PHYSICS = {
    "rhoA": 4.466, "EI": 5217.4, "EA": 1.1451e8, "Lp": 0.75, "mouth": 0.315, "piston_axial_inertia": 4e-4,
    "cylinder_mass": 3.0, "cylinder_com": 0.157, "cylinder_inertia": 0.0248, "cylinder_axial_inertia": 0.002,
    "zeta": 0.005, "damping_time": 0.0,
    "drive_stiffness": 0.0, "drive_damping": 0.0, "gravity": [1.0, 2.0, -9.0], "base": [0.0, 0.0, 0.0],
    "R0": np.eye(3).ravel(), "tip_mass": 0.0, "tip_inertia": 0.0,
}  # fmt: skip
ORACLE = {
    "rhoA": 4.466, "EI": 5217.4, "EA": 1.1451e8, "Lp": 0.75, "mouth": 0.315, "cyl_mass": 3.0, "cyl_com": 0.157,
    "cyl_inertia": 0.0248, "cyl_axial": 0.002, "piston_axial": 4e-4, "gravity": np.array([1.0, 2.0, -9.0]),
}  # fmt: skip


def parameters():
    return np.concatenate([np.atleast_1d(np.asarray(PHYSICS[name], dtype=float)).ravel() for name, _ in LEG_PARAMETERS])


def state(shapes: Shapes, amplitude: float, seed: int):
    rng = np.random.default_rng(seed)
    q, v = rng.uniform(-1, 1, shapes.size), rng.uniform(-1, 1, shapes.size)
    q[:3], v[:3] = [0.3, -0.2, 0.91], [0.7, -1.1, 0.4]
    q[3:] *= amplitude
    v[3:] *= 30 * amplitude
    return q, v


@pytest.mark.parametrize(("basis", "modes", "axial_modes"), [
    *[(basis, 3, m) for basis in ("clamped-free", "tip-load") for m in (0, 1, 2, 4)], ("hermite", 2, 2),
])  # fmt: skip
def test_kinetic_energy_is_right_to_second_order(basis, modes, axial_modes):
    # Closed forms keep terms up to second order in the amplitudes: the gap must fall as their cube.
    k = kernel(space_shapes(lateral_basis(basis, modes), axial_modes))
    gaps = []
    for amplitude in (3e-4, 3e-5):  # above, fourth order mixes in; below, rounding of 1e-15 J
        q, v = state(k.shapes, amplitude, seed=axial_modes)
        T, V_g, V_s = nonlinear.energies(q, v, ORACLE, lambda z, order: k.shapes.beam.a.values(z, order))
        ours = k.leg_energies(q, v, np.zeros(2), parameters())[0]
        gaps.append(abs(ours[0] - T))
        # Gravity and strain energies are exact in these kinematics: rounding only.
        np.testing.assert_allclose(ours[1:], [V_g, V_s], rtol=1e-12, atol=1e-12)
    assert gaps[0] / gaps[1] == pytest.approx(1000, rel=0.2)


def test_the_axial_sine_coupling_is_exact():
    # psi_n as a polynomial in sigma (1 - zeta) must equal the sine to the digits claimed in bases.axial.
    axial, eta = axial_basis(4), np.linspace(0, 1, 101)
    polynomial = np.array([np.polynomial.polynomial.polyval(1 - eta, c) for c in axial.series])
    np.testing.assert_allclose(polynomial, axial.values(eta), atol=1e-9)


def test_bases_share_the_kernel_layout():
    lateral, axial = lateral_basis("tip-load", 2), axial_basis(2)
    assert layout(a=lateral, b=lateral, axial=axial).size == 9
