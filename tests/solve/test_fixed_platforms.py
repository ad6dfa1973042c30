"""A strut between two fixed points, whose platform does not move: the tolerance is that of its own vibration."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.helpers.runs import collect

from flexapod import simulate
from flexapod.model import ServoDrive, load, override
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.convergence

STRUT = Path(__file__).parents[2] / "examples/mechanisms/strut.toml"
TOLERANCES = tuple(10.0**-k for k in range(2, 9))


def strut(**simulation):
    return override(load(STRUT), duration=0.05, output_step=1e-3, modes=2, **simulation)


@cache
def reference(axial_modes):
    """Coordinates (T, n) at the outputs by SciPy: the strut's equations, their closure differentiated twice."""
    march = prepare(strut(axial_modes=axial_modes, tolerance=1e-3))
    system, x = march.system, march.start
    free, table = np.flatnonzero(~system.fixed_mask), np.zeros((1, system.ports.size, 4))
    held = {int(k): j for j, k in enumerate(system.ports)}
    for k in np.flatnonzero(system.held[0]):
        table[0, held[int(k)], 0] = x.q[0, k]
    zero, m = np.zeros(6), len(free)

    def at(y):
        v, q = np.zeros(system.size), x.q.copy()
        q[0, free], v[free] = y[:m], y[m:]
        return replace(x, q=q, v=v, v_dot=np.zeros(system.size), lam=np.zeros_like(x.lam), drive=np.zeros_like(x.drive))

    def rates(_, y):
        now = at(y)
        found = system.matrices(now, zero)
        r = system.residual(now, table, zero)[0][free]
        M, G, tau = found.M[np.ix_(free, free)], found.G[:, free], 1e-4
        behind, before = (system.matrices(system.displace(now, s * tau * now.v), zero).G[:, free] for s in (1, -1))
        bend = (behind - before) @ y[m:] / (2 * tau)
        whole = np.block([[M, G.T], [G, np.zeros((len(G), len(G)))]])
        return np.concatenate([y[m:], np.linalg.solve(whole, -np.concatenate([r, bend]))[:m]])

    start = np.concatenate([x.q[0, free], np.zeros(m)])
    instants = np.linspace(0.0, 0.05, 51)
    found = solve_ivp(rates, (0.0, 0.05), start, "DOP853", instants, rtol=1e-12, atol=1e-16)
    q = np.repeat(x.q, len(instants), axis=0)
    q[:, free] = found.y[:m].T
    return system.kernel.shapes, q


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_strut_vibrates_within_the_tolerance(tolerance):
    """Amplitudes over their peaks, across it and along it. Errors stayed at 9e-5 for tolerances below 1e-4."""
    shapes, true = reference(1)
    found = collect(prepare(strut(axial_modes=1, tolerance=tolerance)).chunks)["q"][:, 0]
    across = slice(shapes.index("a"), None)
    error = np.abs(found[:, across] - true[:, across]).max() / np.abs(true[:, across]).max()
    assert tolerance / 100 < error < tolerance
    # The stretch makes the forces; what is below 1e-12 m over the tolerance does not count.
    along, true = found[:, shapes.index("c")], true[:, shapes.index("c")]
    assert np.abs(along - true).max() < tolerance * max(np.abs(true).max(), 1e-12 / tolerance)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_a_strut_that_only_stretches_vibrates_within_it_too(tolerance):
    """Let go upright, on a servo drive: one mass between two springs, in closed form. Steps were as long as outputs."""
    stiffness, damping, length, g = 2e7, 1e3, 0.75, 9.81
    study = override(load(STRUT), fidelity="lumped", duration=0.05, output_step=1e-3, tolerance=tolerance)
    legs = tuple(leg.replace(drive=ServoDrive(stiffness=stiffness, damping=damping), damping=0.0)
                 for leg in study.robot.legs)  # fmt: skip
    study = study.replace(robot=study.robot.replace(legs=legs, gravity=[-g, 0.0, 0.0]))
    # The piston's points move by 1 - x / length of its driven end: a third of its mass, half of its weight.
    mass = legs[0].piston.rhoA * length
    k, rate = stiffness + legs[0].piston.EA / length, damping / (2 * mass / 3)
    frequency, t = np.sqrt(k / (mass / 3) - rate**2), np.linspace(0.0, 0.05, 51)
    decay, fast = np.exp(-rate * t), (rate**2 + frequency**2) / frequency
    x = -mass * g / 2 / k * (1 - decay * (np.cos(frequency * t) + rate / frequency * np.sin(frequency * t)))
    x_dot = -mass * g / 2 / k * decay * fast * np.sin(frequency * t)
    force = -stiffness * x - damping * x_dot
    found = simulate(study).drive_force.values[:, 0]
    # The spring's force is as exact as its stretch, the damper's as rates are.
    assert np.abs(found - force).max() < 10 * tolerance * np.abs(force).max()
