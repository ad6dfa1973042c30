"""The actuator driven by a torque and an axial force: angle and length are unknowns, k + 2 degrees of freedom."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.helpers.runs import balance, run_actuator
from tests.oracles import sliding

from flexapod.model import (
    Actuator,
    ActuatorLoad,
    ActuatorMotion,
    ActuatorStudy,
    ConstantLaw,
    RateLaw,
    Simulation,
    SineLaw,
)
from flexapod.solve.time.actuator_march import actuator_system

pytestmark = pytest.mark.consistency

RHO, EI, LT, HUB, START = 4.02, 756.65, 3.66, 3.0, 1.83
TORQUE, FORCE = {"amplitude": 14.0, "frequency": 0.4, "phase": 0.4}, {"amplitude": 9.0, "frequency": 0.7, "phase": -0.5}


def driven(modes, *, torque=None, force=None, step=1e-3, duration=1.0, basis="clamped-free", **beam):
    zero = ConstantLaw(value=0.0)
    return ActuatorStudy(
        actuator=Actuator(length=LT, rhoA=RHO, EI=EI, free_length=START, hub_inertia=HUB, **beam),
        motion=ActuatorMotion(rotation=None, extension=None),
        load=ActuatorLoad(torque=torque or zero, force=force or zero),
        simulation=Simulation(basis=basis, modes=modes, duration=duration, step=step, output_step=0.1),
    )


def sine(t, amplitude, frequency, phase):
    return amplitude * np.sin(2 * np.pi * frequency * t + phase)


def lagrange_solution(t, k, q0, *, m_e, g, angle):
    """Angle, length and tip (3, T) of the published Lagrangian under the two sines, by an eighth-order method."""
    lagrangian = sliding.Lagrangian(k=k, rho=RHO, EI=EI, Lt=LT, m_e=m_e, J_h=HUB, g=g)
    unit, n = np.eye(k + 2), k + 2

    def slope(time, y):
        x, v = y[:n], y[n:]
        rest = lagrangian.residual(x, v, np.zeros(n))
        M = np.array([lagrangian.momenta(x, d) for d in unit])  # momenta are linear in the rates
        Q = np.concatenate([np.zeros(k), [sine(time, **TORQUE), sine(time, **FORCE)]])
        return np.concatenate([v, np.linalg.solve(M, Q - rest)])

    y0 = np.concatenate([q0, [angle, START], np.zeros(n)])
    y = solve_ivp(slope, (0, t[-1]), y0, "DOP853", t_eval=t, rtol=1e-9, atol=1e-11).y
    tip = sliding.constants(k).b @ y[:k] / np.sqrt(RHO * y[k + 1])
    return np.stack([y[k], y[k + 1], tip])


@pytest.mark.parametrize(("m_e", "g", "angle"), [(0.0, 0.0, 0.0), (0.4, 1.5, 0.3)])
def test_against_the_published_lagrangian(m_e, g, angle):
    k, a0 = 2, np.array([2.5e-3, -2e-4])
    loads = {"torque": SineLaw(**TORQUE), "force": SineLaw(**FORCE)}
    ours = []
    for step in (1e-3, 5e-4):
        study = driven(k, **loads, step=step, duration=0.7, tip_mass=m_e, gravity=g, angle=angle)
        run = run_actuator(study, a0)
        ours.append(np.stack([*run["q"][:, 0, :2].T, run["q"][:, 0, 2:] @ sliding.constants(k).b]))
    # a' = 0 at L' = 0 is q' = 0 as well.
    exact = lagrange_solution(run["time"], k, a0 * np.sqrt(RHO * START), m_e=m_e, g=g, angle=angle)
    assert (np.ptp(exact, axis=1) > [0.1, 0.05, 5e-3]).all()  # it does turn, slide and bend
    error = [np.abs(x - exact).max(axis=1) for x in ours]
    np.testing.assert_allclose(np.log2(error[0] / error[1]), 2.0, atol=0.15)  # order 2, nothing left over
    limit = (4 * ours[1] - ours[0]) / 3  # extrapolated: order 3 or better
    np.testing.assert_allclose(limit - exact, 0, atol=2e-6 * np.ptp(exact, axis=1).max())


@pytest.mark.parametrize("basis", ["clamped-free", "tip-load"])
def test_free_flight_keeps_momentum_and_energy(basis):
    # No load, no gravity: angular momentum dT/d(theta') and energy stay. Turning and bent, it slides out by itself.
    k, drift = 3, []
    for step in (2e-3, 1e-3, 5e-4):
        study = driven(k, step=step, duration=0.6, basis=basis, tip_mass=0.2, tip_inertia=0.01)
        system = actuator_system(study.actuator, study.simulation, rotation=False, extension=False)
        run = run_actuator(study, np.array([4e-3, 3e-4, 0.0]), np.array([0.6, 0.0, 0.0]))
        M = [system.kernel.leg_matrices(q[0], np.zeros(0), system.leg_p[0])[0] for q in run["q"]]
        momentum = np.array([(m @ v)[0] for m, v in zip(M, run["v"], strict=True)])
        drift.append([np.ptp(momentum) / abs(momentum[0]), np.ptp(run["energy"].sum(axis=1)) / run["energy"][0].sum()])
    assert (np.array(drift[-1]) < 1e-4).all()
    np.testing.assert_allclose(np.log2(np.array(drift[:-1]) / drift[1:]), 2.0, atol=0.3)


def test_free_flight_of_a_rigid_beam_is_a_central_motion():
    # One rigid bar through a ring: l'' = theta'^2 (l - Lt/2), I theta' constant. Its energy fixes l'(l).
    study = driven(1, duration=1.0, step=2e-4)
    study = study.replace(
        motion=ActuatorMotion(rotation=RateLaw(rate=0.9), extension=None),
        load=ActuatorLoad(force=ConstantLaw(value=0.0)),
        simulation=study.simulation.replace(fidelity="rigid"),
    )
    run = run_actuator(study)
    length = START + (START - LT / 2) * (np.cosh(0.9 * run["time"]) - 1)
    np.testing.assert_allclose(run["q"][:, 0, 1], length, rtol=1e-9)  # at its middle the bar stays where it is
    offset = study.replace(actuator=study.actuator.replace(free_length=2.0))
    run = run_actuator(offset)
    length = LT / 2 + (2.0 - LT / 2) * np.cosh(0.9 * run["time"])
    np.testing.assert_allclose(run["q"][:, 0, 1], length, rtol=1e-8)  # order 2: (0.9 h)^2 / 12 a radian


def test_work_of_torque_and_force_closes_the_balance():
    # Every load constant: its work is load times travel, whatever the motion between.
    torque, force = ConstantLaw(value=4.0), ConstantLaw(value=-6.0)
    run = run_actuator(driven(3, torque=torque, force=force, step=2e-4, duration=0.5, gravity=1.0, damping=0.01))
    travel = run["q"][:, 0, :2] - run["q"][0, 0, :2]
    np.testing.assert_allclose(run["sums"][:, 1], travel @ [4.0, -6.0], atol=1e-6 * np.abs(travel).max())
    assert np.ptp(balance(run)) < 1e-5 * np.abs(run["sums"][:, 1]).max()
