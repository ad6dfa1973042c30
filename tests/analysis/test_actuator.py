"""Results of the single actuator against closed forms: place of the tip, torque and force of a rigid beam."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.mechanics.shapes import lateral_basis

pytestmark = pytest.mark.unit

STUDY = fx.preset("paper-actuator")


def test_tip_of_the_bent_beam_draws_back_by_its_foreshortening():
    study = STUDY.replace(actuator=STUDY.actuator.replace(hub_radius=0.2, angle=0.4))
    data = fx.simulate_actuator(study, initial={"tip_displacement": 0.05}, duration=0.5, step=1e-3, modes=3)
    basis, (x, w) = lateral_basis("clamped-free", 3), np.polynomial.legendre.leggauss(40)
    # An inextensible line: its projection is shorter by half the integral of the slope squared.
    slope = data.mode_amplitude.values @ basis.values((x + 1) / 2, 1)
    along = 0.2 + data.length.values - 0.5 * (slope**2) @ (w / 2) / data.length.values
    c, s, v = np.cos(data.angle.values), np.sin(data.angle.values), data.tip_deflection.values
    expected = np.stack([along * c - v * s, along * s + v * c], axis=1)
    np.testing.assert_allclose(data.tip_position, expected, atol=1e-13)
    # 0.6 v^2 / L of the static shape at the start: 0.8 mm of 50 mm; three shapes of four carry it to 1 %.
    drawn = 0.2 + data.length.values[0] - along[0]
    assert drawn == pytest.approx(0.6 * 0.05**2 / 1.83, rel=0.01)


def test_torque_and_force_of_a_rigid_beam():
    # Steady rates of angle and length: Coriolis torque and centrifugal force of a rod that reaches behind the pivot.
    study = STUDY.replace(actuator=STUDY.actuator.replace(gravity=9.81, tip_mass=2.0, hub_inertia=5.0))
    data = fx.simulate_actuator(study, fidelity="rigid", duration=2.0, step=1e-2, output_step=1e-2)
    rho, whole, m, g = 4.02, 3.66, 2.0, 9.81
    L, theta = 1.83 + 0.1 * data.time.values, 0.785 * data.time.values
    np.testing.assert_allclose(data.length, L, rtol=1e-13)
    np.testing.assert_allclose(data.angle, theta, atol=1e-13)
    moment = rho * (L**2 - (L - whole) ** 2) / 2 + m * L
    torque = 2 * 0.1 * 0.785 * moment + g * np.cos(theta) * moment
    force = -(0.785**2) * moment + g * np.sin(theta) * (rho * whole + m)
    np.testing.assert_allclose(data.torque, torque, rtol=1e-11)
    np.testing.assert_allclose(data.force, force, rtol=1e-11, atol=1e-11)


def test_a_given_force_moves_the_rigid_beam():
    # Without rotation: F = m a, from rest.
    study = STUDY.replace(
        motion={"rotation": {"law": "rate", "rate": 0.0}, "extension": None},
        load={"force": {"law": "constant", "value": 10.0}},
    )
    data = fx.simulate_actuator(study, fidelity="rigid", duration=1.0, step=1e-2, output_step=1e-2)
    accel = 10.0 / (4.02 * 3.66)
    np.testing.assert_allclose(data.length, 1.83 + 0.5 * accel * data.time.values**2, rtol=1e-10)
    np.testing.assert_allclose(data.length_rate, accel * data.time.values, atol=1e-10)
    np.testing.assert_array_equal(data.force, 10.0)


def test_what_is_neither_actuator_nor_study_is_refused():
    with pytest.raises(fx.InputError, match="neither an actuator"):
        fx.simulate_actuator(fx.preset("paper-robot"))
    with pytest.raises(fx.InputError, match="fidelity"):
        fx.simulate_actuator(STUDY, fidelity="lumped")
    with pytest.raises(fx.InputError, match="duration"):
        fx.simulate_actuator(STUDY.actuator, STUDY.motion)


def test_a_beam_wholly_outside_its_hub_is_no_loss():
    beam = fx.preset("paper-actuator").actuator.replace(length=1.83, free_length=1.83, hub_radius=0.2)
    still = fx.model.ActuatorMotion(rotation={"law": "rate", "rate": 0.785}, extension={"law": "rate", "rate": 0.0})
    data = fx.simulate_actuator(beam, still, step=1e-3, duration=0.01)
    assert data.attrs["partial"] == 0


def test_modes_of_the_beam_are_those_of_a_cantilever():
    study = fx.preset("paper-actuator")
    actuator = study.actuator
    found = fx.modes(study)
    assert found.mode.values.tolist() == list(range(1, found.sizes["mode"] + 1))
    roots = np.array([1.87510407, 4.69409113, 7.85475744])
    expected = roots**2 / actuator.free_length**2 * np.sqrt(actuator.EI / actuator.rhoA) / (2 * np.pi)
    np.testing.assert_allclose(found.frequency[:3], expected, rtol=1e-6)  # shapes are those of the modes
