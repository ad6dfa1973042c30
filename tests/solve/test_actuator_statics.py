"""Static deflections of the single actuator: gravity, tip weight, Coriolis force, tip displacement."""

import numpy as np
import pytest

from flexapod.model import Simulation, preset
from flexapod.solve.modal.actuator_modes import turning_matrices
from flexapod.solve.time.actuator_march import actuator_system, static_shape

pytestmark = pytest.mark.analytic

BEAM = preset("paper-actuator").actuator


def tip_under_inertia_forces(beam, rates, *, basis="tip-load", modes=3):
    """Tip [m] where bending alone balances the loads on the straight beam that moves with rates (theta', L')."""
    simulation = Simulation(basis=basis, modes=modes)
    system = actuator_system(beam, simulation)
    q, v = np.zeros((2, system.n))
    q[:2], v[:2] = (beam.angle, beam.hub_radius + beam.free_length), rates
    r = system.kernel.leg_residual(q, v, np.zeros(system.n), np.zeros(0), np.zeros(2), system.leg_p[0])[0]
    stiffness = turning_matrices(beam.replace(gravity=0.0), simulation, 0.0)[2]
    return -system.kernel.shapes.beam.a.tip @ np.linalg.solve(stiffness, r[2:])


@pytest.mark.parametrize("modes", [2, 6])
def test_sag_of_the_table_2_beam(modes):
    # Uniform load bends to a quartic without tip moment: tip-load holds it exactly from two shapes on.
    beam = BEAM.replace(free_length=BEAM.length, gravity=9.81)
    sag = BEAM.rhoA * 9.81 * BEAM.length**4 / (8 * BEAM.EI)
    assert sag == pytest.approx(1.169, abs=5e-4)
    assert tip_under_inertia_forces(beam, (0.0, 0.0), modes=modes) == pytest.approx(-sag, rel=1e-11)


def test_sag_in_eigenfunctions_converges():
    beam = BEAM.replace(free_length=BEAM.length, gravity=9.81)
    sag = BEAM.rhoA * 9.81 * BEAM.length**4 / (8 * BEAM.EI)
    errors = [abs(tip_under_inertia_forces(beam, (0, 0), basis="clamped-free", modes=k) / -sag - 1) for k in (1, 3, 6)]
    # terms fall as eps^-5: the load's mean on shape i as 1/eps, its compliance as eps^-4
    assert errors[0] < 2e-2
    assert (np.array(errors[:-1]) / errors[1:] > 10).all()


@pytest.mark.parametrize("angle", [0.0, 0.4, -1.2])
def test_tip_weight_bends_as_a_cantilever(angle):
    heavy, light = (BEAM.replace(gravity=9.81, tip_mass=m, angle=angle) for m in (0.2, 0.0))
    added = tip_under_inertia_forces(heavy, (0, 0), modes=1) - tip_under_inertia_forces(light, (0, 0), modes=1)
    exact = -0.2 * 9.81 * np.cos(angle) * BEAM.free_length**3 / (3 * BEAM.EI)
    assert added == pytest.approx(exact, rel=1e-11)


@pytest.mark.parametrize(("length", "table"), [(1.83, 1.169e-3), (2.83, 6.69e-3)])
def test_coriolis_sag(length, table):
    turn, feed = 0.785, 0.1
    sag = 2 * BEAM.rhoA * turn * feed * length**4 / (8 * BEAM.EI)
    assert sag == pytest.approx(table, rel=1e-3)
    assert tip_under_inertia_forces(BEAM.replace(free_length=length), (turn, feed)) == pytest.approx(-sag, rel=1e-11)


@pytest.mark.parametrize("basis", ["clamped-free", "tip-load"])
@pytest.mark.parametrize("modes", [1, 3, 6])
def test_start_is_the_static_shape_with_the_given_tip(basis, modes):
    system = actuator_system(BEAM, Simulation(basis=basis, modes=modes))
    b, z = system.kernel.shapes.beam.a, np.linspace(0, 1, 21)
    a = static_shape(system, 5e-3)
    assert b.tip @ a == pytest.approx(5e-3, rel=1e-14)
    exact = 5e-3 * (3 * z**2 - z**3) / 2
    # coefficients fall as 12 / eps^4 of the tip: the tail beyond k is below 0.05 / k^3, twice that once scaled
    np.testing.assert_allclose(a @ b.values(z), exact, atol=1e-14 if basis == "tip-load" else 5e-3 * 0.1 / modes**3)
