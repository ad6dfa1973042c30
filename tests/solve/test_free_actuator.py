"""A beam set free on its hub: energy and angular momentum stay, whatever bends; the ends of the guide are named."""

import numpy as np
import pytest
from tests.helpers.free_actuator import STUDY, free, inertia

import flexapod as fx
from flexapod import model
from flexapod.solve.time.actuator_march import prepare_actuator

pytestmark = pytest.mark.conservation


def test_rigid_beam_keeps_energy_and_angular_momentum():
    data = fx.simulate_actuator(free(tip=0.0, fidelity="rigid", step=1e-3))
    L, turn, feed = data.length.values, data.angle_rate.values, data.length_rate.values
    assert turn[0] == pytest.approx(0.785) and feed[0] == pytest.approx(0.1)
    # Second order in 1 ms over rates of 1 / s: 1e-6, times the 3 s.
    np.testing.assert_allclose(inertia(L) * turn, inertia(1.83) * 0.785, rtol=5e-6)
    energy = 0.5 * inertia(L) * turn**2 + 0.5 * 4.02 * 3.66 * feed**2
    np.testing.assert_allclose(energy, energy[0], rtol=5e-6)


def test_bent_beam_keeps_energy_and_angular_momentum_to_second_order():
    drifts = []
    for step in (2e-3, 1e-3, 5e-4):
        study = free(step=step, output_step=2e-2, rho_inf=1.0)
        march = prepare_actuator(study)
        parts = [chunk.recording for chunk in march.chunks]
        q, v = (np.concatenate([getattr(r, name) for r in parts]) for name in ("q", "v"))
        p, kernel = march.system.leg_p[0], march.system.kernel
        spin = np.array([(kernel.leg_matrices(x[0], np.zeros(0), p)[0] @ y)[0] for x, y in zip(q, v, strict=True)])
        energy = np.concatenate([r.energy for r in parts]).sum(axis=1)
        drifts.append([np.ptp(spin) / spin[0], np.ptp(energy) / energy[0]])
    order = np.log2(np.array(drifts[:-1]) / np.array(drifts[1:]))
    np.testing.assert_allclose(order, 2.0, atol=0.2)
    assert max(drifts[-1]) < 1e-4


def test_rates_of_prescribed_coordinates_are_refused():
    for name, load in (("angle_rate", "torque"), ("length_rate", "force")):
        with pytest.raises(fx.InputError, match="prescribed") as caught:
            STUDY.replace(initial={name: 0.1})
        assert caught.value.key == f"initial.{name}" and f"{load} = 0" in caught.value.next_step


def test_file_takes_and_gives_back_the_rates():
    text = (
        '[actuator]\nlength = "3.66 m"\nrhoA = 4.02\nEI = 756.65\nfree_length = 1.83\n[load]\ntorque = 0\nforce = 0\n'
        '[initial]\nangle_rate = "45 deg/s"\nlength_rate = "10 cm/s"\n[simulation]\nduration = 1\n'
    )
    study = model.loads(text)
    assert study.initial.angle_rate == pytest.approx(np.pi / 4) and study.initial.length_rate == pytest.approx(0.1)
    assert model.loads(model.to_toml(study)).initial == study.initial


@pytest.mark.parametrize("settings", [{"step": 1e-3}, {"fidelity": "rigid"}])
def test_a_beam_that_slides_into_its_hub_is_told_so(settings):
    data = fx.simulate_actuator(free(tip=0.0 if "fidelity" in settings else 5e-3, force=-50.0, **settings))
    assert data.attrs["partial"] and "into" in data.attrs["failure"] and "hub" in data.attrs["failure"]
    # From rest under 50 N on 14.7 kg: 1.038 s to the last millimetre, 50 mm before that 15 ms earlier.
    assert 1.0 < data.time[-1] < 1.04


def test_a_beam_that_vibrates_is_thrown_back_before_it_has_slid_into_its_hub():
    """Its frequency rises with 1 / free^2 and its energy with it: at 11 mm they are the 85 J that 50 N have put in."""
    march = prepare_actuator(free(force=-50.0, duration=1.1))
    parts = [chunk.recording for chunk in march.chunks]
    length, energy, sums = (
        np.concatenate(x) for x in zip(*[(r.q[:, 0, 1], r.energy, r.sums) for r in parts], strict=True)
    )
    assert length[-1] > 0.1 > 0.05 > length.min() > 0
    np.testing.assert_allclose(energy.sum(axis=1) - energy[0].sum(), sums[:, 1], atol=1e-3 * np.ptp(sums[:, 1]))
