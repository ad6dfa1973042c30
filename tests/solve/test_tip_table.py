"""The paper's sliding beam (Table 2): tip deflection second by second, by the marched actuator."""

import numpy as np
import pytest
from tests.helpers.runs import run_actuator
from tests.oracles import sliding

import flexapod as fx
from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import override, preset
from flexapod.verification.cases.sliding import TIP_MM

pytestmark = pytest.mark.literature

LENGTH, FEED, TURN = 1.83, 0.1, 0.785
MOTION = sliding.uniform_motion(LENGTH, FEED, TURN)


def tip_mm(modes, step):
    """Tip each 10 ms from the first mode at 5 mm with q' = 0 of q = sqrt(rho L) a, that is a' = -L'/(2 L) a."""
    study = override(preset("paper-actuator"), modes=modes, step=step, output_step=1e-2)
    a = 2.5e-3 * np.eye(modes)[0]
    run = run_actuator(study, a, -FEED / (2 * LENGTH) * a)
    return 1e3 * run["q"][:, 0, 2:] @ lateral_basis("clamped-free", modes).tip


def test_six_shapes_reproduce_the_table():
    # The start excites modes up to 200 Hz by some 1e-3 mm: their phases after 10 s want 25 us.
    tip = tip_mm(6, 2.5e-5)
    np.testing.assert_allclose(tip[::100], TIP_MM, rtol=0, atol=2e-5)
    assert np.abs(tip).max() == pytest.approx(13.9986, abs=3e-4)  # sampled each 10 ms here


def test_three_shapes_are_converged_to_micrometres():
    np.testing.assert_allclose(tip_mm(3, 1e-4)[::100], TIP_MM, rtol=0, atol=4e-3)


def test_coarse_steps_give_the_motion_all_the_same():
    # 0.5 ms, 33 steps a period of the third mode: what is lost is the phase of modes that carry micrometres.
    np.testing.assert_allclose(tip_mm(3, 5e-4)[::100], TIP_MM, rtol=0, atol=5e-3)


@pytest.mark.parametrize(("tip_mass", "gravity", "angle"), [(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (0.3, 2.0, -0.9)])
def test_public_call_from_the_static_shape(tip_mass, gravity, angle):
    # fx.simulate_actuator against the closed equation: static shape at 5 mm, at rest in x / L: q' = L'/(2 L) q.
    study, k, t = preset("paper-actuator"), 3, np.arange(0, 2.01, 0.25)
    beam = study.actuator.replace(tip_mass=tip_mass, gravity=gravity, angle=angle)
    data = fx.simulate_actuator(study.replace(actuator=beam), modes=k, step=5e-5, duration=2.0, output_step=0.25)
    z = sliding.constants(k)
    shape = z.b / np.diag(z.E4)
    q0 = 5e-3 * shape / (z.b @ shape) * np.sqrt(beam.rhoA * LENGTH)

    def equation(time):
        length, feed, push, turned, rate, spin = MOTION(time)
        place = (length, feed, push, turned + angle, rate, spin)
        return sliding.q_equation(*place, g=gravity, m_e=tip_mass, rho=beam.rhoA, EI=beam.EI, k=k)

    q = sliding.march(equation, q0, FEED / (2 * LENGTH) * q0, t)
    exact = q @ z.b / np.sqrt(beam.rhoA * (LENGTH + FEED * t))
    np.testing.assert_allclose(data.time, t, atol=1e-12)
    np.testing.assert_allclose(data.length, LENGTH + FEED * t, rtol=1e-12)
    np.testing.assert_allclose(data.angle, angle + TURN * t, rtol=1e-12)
    # second mode 14 Hz: 2 s at 50 us shift its phase by 2e-4 rad
    np.testing.assert_allclose(data.tip_deflection, exact, rtol=0, atol=5e-4 * np.abs(exact).max())
