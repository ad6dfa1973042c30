"""Loops, random vibration and fewer states of small plants beside scipy, python-control and matrices by hand."""

import numpy as np
import pytest
from scipy.linalg import expm, solve_continuous_lyapunov

import flexapod.control as fc

pytestmark = pytest.mark.analytic

M, K, C = np.diag([2.0, 1.0, 3.0]), 4e3, 3.0
LINKS = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]])  # springs between masses, none to the ground


def chain(ground=0.0):
    """Three masses in a row on springs and dampers, a force on each; `ground`: spring of the first one [N/m]."""
    stiff = LINKS.T @ (K * LINKS)
    stiff[0, 0] += ground
    damp = C / K * stiff
    inv = np.linalg.inv(M)
    return fc.StateSpace(
        A=np.block([[np.zeros((3, 3)), np.eye(3)], [-inv @ stiff, -inv @ damp]]),
        B=np.vstack([np.zeros((3, 3)), inv]), C=np.eye(6)[[0, 1, 2, 5]], D=np.zeros((4, 3)),
        inputs=("drive:1", "drive:2", "wrench:fz"), outputs=("stroke:1", "stroke:2", "tool:z", "speed:z"),
        states=("a", "b", "c", "a rate", "b rate", "c rate"), units={},
    ), stiff, damp  # fmt: skip


def test_a_loop_adds_what_the_controller_asks_for():
    """u = r + K y as python-control closes it with sign=1, of two sensors and two actuators crosswise."""
    control = pytest.importorskip("control")
    plant, *_ = chain(1e3)
    law = fc.StateSpace(
        A=[[-30.0, 4.0], [0.0, -50.0]], B=[[1.0, 2.0], [-3.0, 0.5]], C=[[-200.0, 50.0], [10.0, -300.0]],
        D=[[-20.0, 5.0], [3.0, -40.0]], inputs=("stroke:2", "stroke:1"), outputs=("drive:1", "drive:2"),
        states=("p", "q"), units={},
    )  # fmt: skip
    loop = plant.close(law)
    G = control.ss(plant.A, plant.B[:, :2], plant.C[[1, 0]], np.zeros((2, 2)))
    theirs = control.feedback(G, control.ss(law.A, law.B, law.C, law.D), sign=1)
    w = np.geomspace(1.0, 300.0, 15)
    ours = loop.select(["drive:1", "drive:2"], ["stroke:2", "stroke:1"]).at(w / (2 * np.pi))
    np.testing.assert_allclose(ours, theirs(1j * w), rtol=1e-8)


def test_force_feedback_late_by_half_a_sample():
    """Held outputs that change in the middle between samples: Phi, the two parts of Gamma, and the sum by hand."""
    m, k, c, g, T = 3.0, 1200.0, 0.9, 60.0, 4e-3
    plant = fc.StateSpace(
        A=[[0, 1], [-k / m, -c / m]], B=[[0], [1 / m]], C=[[-k, -c]], D=[[1.0]], inputs=("drive:1",),
        outputs=("force-sensor:drive:1",), states=("z", "v"), units={},
    )  # fmt: skip
    loop = plant.close(fc.IFF(g), sample=T, delay=T / 2)
    whole = expm(np.block([[plant.A, plant.B], [np.zeros((1, 3))]]) * T / 2)
    half, push = whole[:2, :2], whole[:2, 2]
    # what was asked for before acts in the first half, what is asked for now in the second; it is read with the first
    A = np.zeros((4, 4))  # z, v, what was asked for before, sum of readings
    A[:2, :2], A[:2, 2], A[:2, 3] = half @ half, half @ push, -g * push
    A[2, 3] = -g
    A[3, :2], A[3, 2], A[3, 3] = T * plant.C[0], T, 1.0
    exact = np.linalg.eigvals(A)
    for pole in exact[np.abs(exact) > 1e-6]:
        assert np.abs(loop.poles() - pole).min() < 1e-9
    assert len(loop.A) == 4


def test_random_vibration_by_the_equation_of_lyapunov():
    """White noise in two inputs, of different size: covariances of all outputs, and the share of each source."""
    plant, *_ = chain(1e3)
    S = {"drive:1": 2e-3, "wrench:fz": 5e-4}
    wide = np.array([1e-4, 1e6])
    sources = {name: (wide, np.full(2, size)) for name, size in S.items()}
    data, parts = plant.psd(sources), plant.by_source(sources)
    exact = []
    for name, size in S.items():
        b = plant.B[:, [plant.inputs.index(name)]]
        exact.append(plant.C @ solve_continuous_lyapunov(plant.A, -size / 2 * b @ b.T) @ plant.C.T)
    # beyond 1 MHz and below 0.1 mHz speeds have 1e-6 of theirs
    scale = np.sqrt(np.diag(sum(exact)))
    np.testing.assert_allclose(data.covariance / np.outer(scale, scale), sum(exact) / np.outer(scale, scale), atol=1e-5)
    for name, one in zip(S, exact, strict=True):
        shares = parts.rms_by_source.sel(source=name)
        np.testing.assert_allclose(shares, np.sqrt(np.diag(one)), rtol=1e-5)
    np.testing.assert_allclose((parts.rms_by_source**2).sum("source"), data.rms**2, rtol=1e-12)
    # what is at each frequency and above: all of it at the lowest, nothing at the highest
    np.testing.assert_allclose(data.cumulative_rms[0], data.rms, rtol=1e-9)
    assert (np.diff(data.cumulative_rms, axis=0) <= 1e-12).all()
    f, psd = data.spectrum_frequency.values, data.psd.values
    tail = f > 20.0
    assert data.cumulative_rms.values[np.argmax(tail)] == pytest.approx(
        np.sqrt([np.trapezoid(psd[tail, i], f[tail]) for i in range(4)]), rel=0.05
    )


def test_fewer_states_of_a_body_that_moves_freely():
    """What stays moves as all masses together; what is left out gives way as at rest, seen from them."""
    plant, stiff, _ = chain()
    less = plant.reduce(below=1.0)
    assert len(less.A) == 2
    total = np.trace(M)
    rigid = np.ones(3) / total
    # y = rigid + static: K u = f - M r (1 . f) with r the rigid acceleration, and no share of the rigid motion
    H = less.at([0.5])[:3, :, 0]
    s = 2j * np.pi * 0.5
    force = np.eye(3) - M @ np.outer(rigid, np.ones(3))
    bent = np.linalg.pinv(stiff) @ force
    bent -= np.outer(np.ones(3), rigid @ M @ bent)
    exact = np.outer(np.ones(3), rigid) / s**2 + bent
    # a double pole at 0 splits by the root of rounding over all else, which s^2 at 0.5 Hz hides but for 1e-6
    np.testing.assert_allclose(H, exact, rtol=1e-5)
    whole = plant.at([0.5])[:3, :, 0]
    # modes at 9 Hz and above add (0.5 / 9)^2 of what bends
    assert np.abs(whole - H).max() < 0.01 * np.abs(bent).max()


def test_a_root_locus_between_samples_says_frequencies_of_what_is_behind():
    """Poles z of the loop stand for log(z) / T."""
    T = 2e-3
    plant = chain(1e3)[0].sampled(T)
    data = fc.root_locus(plant, fc.DVF(1.0, sensor=["stroke:1", "stroke:2"]), [0.5, 2.0])
    for row in range(2):
        z = data.pole.values[row, :, 0] + 1j * data.pole.values[row, :, 1]
        fast = np.abs(z) > 1e-9
        s = np.log(z[fast]) / T
        np.testing.assert_allclose(data.frequency.values[row][fast], np.abs(s) / (2 * np.pi), rtol=1e-9)
        np.testing.assert_allclose(data.damping_ratio.values[row][fast], -s.real / np.abs(s), rtol=1e-6, atol=1e-9)
    # the slowest mode of 1.9 Hz is hardly later than without samples
    first = chain(1e3)[0].damp().frequency.values[0]
    assert np.sort(data.frequency.values[0])[:2] == pytest.approx([first, first], rel=1e-2)
