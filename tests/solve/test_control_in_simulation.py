"""Controllers of `flexapod.control` in the nonlinear march, whatever kind they are."""

import numpy as np
import pytest

import flexapod as fx
import flexapod.control as fc

pytestmark = pytest.mark.consistency

T = 1e-4
LEGS = range(1, 7)
STROKES, DRIVES = [f"stroke:{i}" for i in LEGS], [f"drive:{i}" for i in LEGS]


def run(controller, **settings):
    return fx.simulate(fx.preset("nano-hexapod"), controller=controller, sample=T, step=T, duration=0.01, **settings)


def test_a_controller_and_its_state_spaces_are_the_same_law():
    law = fc.DVF(50.0)
    placed = law.on(STROKES, DRIVES)
    exact = run(law).control_input.values
    assert np.abs(exact).max() > 0
    for other in (placed, placed.sampled(T), fc.Parallel((law,))):
        np.testing.assert_array_equal(run(other).control_input.values, exact)


@pytest.mark.parametrize("sensor", ["geophone:tool:z", "accelerometer:com:z"])
def test_sensors_at_points_are_found_by_name(sensor):
    law = fc.Decentralised(fc.gain(0.5) * fc.low_pass(100.0), sensor=sensor, actuator="drive:1")
    found = run(law)
    assert found.sensor.values.tolist() == [sensor] and np.abs(found.control_input.values).max() > 0
    placed = run(law.on([sensor], ["drive:1"])).control_input.values
    np.testing.assert_array_equal(found.control_input.values, placed)


def test_gains_along_a_path_are_those_of_the_law_where_they_do_not_change():
    law = fc.PID(2000.0, 0.0, 20.0, low_pass="1 kHz")
    grid = fc.Scheduled(axes={"heave": [-1.0, 1.0]}, controllers=[law, law])
    found = run(grid.following(lambda t: {"heave": 0.0}, T, STROKES, DRIVES)).control_input.values
    # The same sums in another order: the march itself multiplies the difference by what its loop does in 100 steps.
    np.testing.assert_allclose(found, run(law).control_input.values, rtol=1e-6, atol=1e-12)


def test_damping_that_adapts_takes_part():
    data = run(fc.AdaptiveDamping(gain=20.0, tracker=fc.Tracker(frequency="240 Hz", lowest="100 Hz", highest="600 Hz")))
    assert np.isfinite(data.control_input.values).all() and np.abs(data.control_input.values).max() > 0


def test_what_adapts_has_no_linear_law():
    plant = fx.linearize(fx.preset("nano-hexapod"), inputs="drive", outputs="stroke")
    with pytest.raises(fx.InputError, match="no linear law"):
        plant.close(fc.AdaptiveDamping(gain=1.0, tracker=fc.Tracker(frequency=10.0)))
