"""Errors of sensors in continuous loops, rates unfiltered too: closed forms, loops by hand, samples without end."""

import json

import numpy as np
import pytest
import xarray as xr
from numpy.linalg import inv, solve

import flexapod.control as fc
from flexapod.common.errors import InputError

pytestmark = pytest.mark.analytic

HZ = np.geomspace(0.3, 60, 25)
S = 2j * np.pi * HZ


def mass(m=1.0):
    """A mass under a force, its place measured."""
    return fc.StateSpace(
        A=[[0, 1], [0, 0]], B=[[0, 0], [1 / m, 1 / m]], C=[[1, 0]], D=[[0, 0]], inputs=("drive:1", "wrench:fz"),
        outputs=("stroke:1",), states=("z", "v"), units={"drive:1": "N", "wrench:fz": "N", "stroke:1": "m"},
    )  # fmt: skip


M, C, K = np.diag([2.0, 0.7]), np.array([[6.0, -2], [-2, 3]]), np.array([[9e3, -4e3], [-4e3, 7e3]])


def pair():
    """Two masses between three springs, a drive on each against the ground; strokes, forces through drives, tool."""
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-solve(M, K), -solve(M, C)]])
    B = np.vstack([np.zeros((2, 3)), np.hstack([inv(M), inv(M)[:, :1]])])
    rows = np.vstack([np.eye(4)[:2], [[-3e3, 0, 0, 0], [0, -2e3, 0, 0]], [[0.5, 0.5, 0, 0]]])
    D = np.zeros((5, 3))
    D[2, 0], D[3, 1] = 1.0, 1.0
    outputs = ("stroke:1", "stroke:2", "force-sensor:drive:1", "force-sensor:drive:2", "tool:z")
    return fc.StateSpace(
        A=A, B=B, C=rows, D=D, inputs=("drive:1", "drive:2", "wrench:fz"), outputs=outputs, states=tuple("abcd"),
        units={},
    )  # fmt: skip


def by_hand(law, tau=0.0):
    """Closed responses (f, outputs, inputs), u = r + late K (y + w): inputs r, w of all outputs; asked u behind y."""
    x = inv(S[:, None, None] ** 2 * M + S[:, None, None] * C + K)[:, :, [0, 1, 0]]
    on = np.broadcast_to(np.eye(2, 3), x.shape)
    springs = np.array([3e3, 2e3])[:, None] * x
    G = np.concatenate([x, on - springs, 0.5 * x.sum(axis=1, keepdims=True)], axis=1)
    L = np.zeros((len(S), 2, 5), dtype=complex)
    for (i, j), value in law.items():
        L[:, i, j] = value
    late = np.exp(-S * tau)[:, None, None]
    P = np.eye(3, 2)
    r, w = np.broadcast_to(np.eye(3, 8), (len(S), 3, 8)), np.broadcast_to(np.eye(5, 8, 3), (len(S), 5, 8))
    u = solve(np.eye(3) - late * (P @ L @ G), r + late * (P @ L @ w))
    return np.concatenate([G @ u, L @ (G @ u + w)], axis=1)


INTO = np.array([[0.6, 0.4], [0.5, -0.5]])
LAWS = {
    "rates": (fc.DVF(25.0), {(0, 0): -25.0 * S, (1, 1): -25.0 * S}),
    "filtered rates": (fc.DVF(25.0, low_pass=90.0), {(i, i): -25.0 * S / (1 + S / (180 * np.pi)) for i in (0, 1)}),
    "pid": (fc.PID(800.0, 4e3, 20.0), {(i, i): -(800.0 + 4e3 / S + 20.0 * S) for i in (0, 1)}),
    "forces": (fc.IFF(9.0, high_pass=0.4), {(i, i + 2): -9.0 / (S + 0.8 * np.pi) for i in (0, 1)}),
    "forces and strokes": (
        fc.IFF(9.0, parallel_stiffness=500.0),
        {(i, i + 2): -9.0 / S for i in (0, 1)} | {(i, i): -4500.0 / S for i in (0, 1)},
    ),
    "one rate of two": (
        fc.Decoupled([fc.pid(700.0, 0.0, 15.0), fc.gain(300.0)], into=INTO, out=INTO.T),
        {(i, j): -(INTO[0, i] * (700 + 15 * S) * INTO[0, j] + INTO[1, i] * 300 * INTO[1, j])
         for i in (0, 1) for j in (0, 1)},
    ),
    "two sensors": (
        fc.SensorFusion(fc.rate(18.0), low="tool", high="stroke:1", corner=7.0, actuator="drive:1"),
        {(0, 4): -18.0 * S * 14 * np.pi / (S + 14 * np.pi), (0, 0): -18.0 * S * S / (S + 14 * np.pi)},
    ),
    "two loops": (
        fc.Parallel((fc.DVF(12.0), fc.PID(900.0, 0.0, 9.0, sensor="tool", actuator="drive:1"))),
        {(0, 0): -12.0 * S, (1, 1): -12.0 * S, (0, 4): -(900.0 + 9.0 * S)},
    ),
    "a rate by its name": (
        fc.StateSpace(
            A=[[-50.0]], B=[[1.0]], C=[[-200.0]], D=[[-6.0]], inputs=("rate:stroke:2",), outputs=("drive:1",),
            states=("x",), units={},
        ),
        {(0, 1): -(200.0 / (S + 50) + 6.0) * S},
    ),
}  # fmt: skip
ALL = ("stroke:1", "stroke:2", "force-sensor:drive:1", "force-sensor:drive:2", "tool:z")


def near(found, known, part=1e-10):
    """The same but for a part of the largest number of a channel over frequency."""
    assert (np.abs(found - known) <= part * np.abs(known).max(axis=0)).all()


def columns(loop):
    """Places of the inputs of a loop among those of `by_hand`, and of its outputs."""
    into = ["drive:1", "drive:2", "wrench:fz", *(f"noise:{name}" for name in ALL)]
    out = [*ALL, "control:drive:1", "control:drive:2"]
    return [into.index(name) for name in loop.inputs], [out.index(name) for name in loop.outputs]


@pytest.mark.parametrize("name", LAWS)
def test_all_inputs_of_a_loop_as_by_hand(name):
    law, known = LAWS[name]
    loop = pair().close(law)
    into, out = columns(loop)
    near(np.moveaxis(loop.at(HZ), 2, 0), by_hand(known)[:, out][:, :, into])  # both solve with conditions below 1e4


@pytest.mark.parametrize("name", LAWS)
def test_continuous_loops_are_those_of_short_samples(name):
    """Between samples a loop is late by a half of them and more: errors of first order, which halves take away."""
    system, law = pair(), LAWS[name][0]
    loop = system.close(law)
    two, one = (np.moveaxis(system.close(law, sample=step).select(loop.inputs, loop.outputs).at(HZ), 2, 0)
                for step in (2e-5, 1e-5))  # fmt: skip
    exact = np.moveaxis(loop.at(HZ), 2, 0)
    near(one, exact, 0.02)
    near(2 * one - two, exact, 2e-4)  # of second order: (w T)^2 is 1.4e-5 at 60 Hz and of the fastest pole; some ten


@pytest.mark.parametrize("name", LAWS)
def test_delayed_loops_as_by_hand(name):
    law, known = LAWS[name]
    loop = pair().close(law, delay=7e-4)
    into, out = columns(loop)
    near(np.moveaxis(loop.at(HZ), 2, 0), by_hand(known, 7e-4)[:, out][:, :, into])


def test_a_mass_held_by_place_and_rate():
    """White noise of the one-sided density 1e-18 m^2/Hz: rms of (2 z w s + w^2) / (s^2 + 2 z w s + w^2)."""
    w, z, density = 2 * np.pi * 30, 0.6, 1e-18
    loop = mass().close(fc.PID(w**2, 0.0, 2 * z * w))
    # half of the two-sided integral of James, Nichols and Phillips
    exact = np.sqrt(density * w * (1 + 4 * z**2) / (8 * z))
    assert loop.h2("noise", "stroke").h2_norm.item() * np.sqrt(density / 2) == pytest.approx(exact, rel=1e-12)
    # Of the band to 1e6 Hz 2 z w / (pi 1e6) of the integral is missing: 5e-5 of its square
    wide = {"noise:stroke:1": (np.array([1e-3, 1e6]), np.full(2, density))}
    assert loop.psd(wide, "stroke").rms.item() == pytest.approx(exact, rel=1e-4)
    assert loop.by_source(wide, "stroke").rms_by_source.item() == pytest.approx(exact, rel=1e-4)


def test_velocity_feedback_passes_noise_of_the_place():
    """A mass under -g x': noise of the place moves it by g / (s + g), at the corner g by 1 / sqrt 2."""
    g = 2 * np.pi * 30
    loop = mass().close(fc.DVF(g))
    np.testing.assert_allclose(loop.at([30.0])[:, :, 0][0, 2], -g / (1j * g + g), rtol=1e-12)
    # step of the error: the mass goes after it, 1 - exp(-g t)
    answer = loop.select("noise", "stroke").step(duration=0.05, step=1e-3)
    exact = -(1 - np.exp(-g * answer.time.values))
    np.testing.assert_allclose(answer.step_response.values[0, 0], exact, rtol=0, atol=1e-12)


def test_what_follows_a_rate_of_noise_is_infinite_and_said():
    loop = mass().close(fc.DVF(100.0))
    data = loop.h2()
    assert np.isinf(data.h2_norm.sel(output="control:drive:1", input="noise:stroke:1"))
    assert "control:drive:1 by noise:stroke:1 is infinite: it follows the rate" in data.attrs["warnings"]
    assert np.isfinite(data.h2_norm.sel(output="stroke:1", input="noise:stroke:1"))
    peak = loop.hinf("noise", "control")
    assert np.isinf(peak.hinf_norm) and np.isinf(peak.frequency)
    assert loop.hinf("noise", "stroke").hinf_norm.item() == pytest.approx(1.0, rel=1e-9)
    with pytest.raises(InputError, match="follow rates"):
        loop.to_control()
    assert loop.select(outputs="stroke").to_control().nstates == 2


def test_files_keep_what_follows_rates(tmp_path):
    from scipy.io import loadmat

    loop = mass(2.0).close(fc.DVF(100.0))
    paths = [loop.save(tmp_path / f"loop{kind}") for kind in (".json", ".npz", ".mat", ".nc")]
    read = [json.loads(paths[0].read_text()), np.load(paths[1]), loadmat(paths[2]), xr.load_dataset(paths[3])]
    for one in read:
        np.testing.assert_array_equal(one["D_rate"], [[0, 0, 0], [0, 0, -100.0]])
    plain = mass().save(tmp_path / "plain.json")
    assert "D_rate" not in json.loads(plain.read_text())


def test_a_loop_within_a_loop_keeps_the_noise_of_both():
    """Velocity feedback inside, continuous; place outside, of the same sensor, continuous, late or sampled."""
    inner, outer = fc.DVF(25.0), fc.PID(800.0, 3e3)
    law = {(i, i): -(25.0 * S + 800.0 + 3e3 / S) for i in (0, 1)}
    known = by_hand(law)
    loop = pair().close(inner).close(outer)
    into, out = columns(loop)
    found = np.moveaxis(loop.at(HZ), 2, 0)
    near(found, known[:, out][:, :, into])
    late = pair().close(inner).close(outer, delay=1e-9)
    assert columns(late) == (into, out)
    near(np.moveaxis(late.at(HZ), 2, 0), found, 5e-6)  # a delay of 1e-9 s turns what is asked by 4e-7
    sampled = [pair().close(inner).close(outer, sample=step) for step in (2e-5, 1e-5)]
    two, one = (np.moveaxis(x.select(loop.inputs, loop.outputs).at(HZ), 2, 0) for x in sampled)
    near(2 * one - two, found, 2e-4)


def test_a_law_that_answers_rates_of_its_inputs_is_refused():
    law = fc.StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, 1)), C=np.zeros((1, 0)), D=[[0.0]], D_rate=[[1.0]], inputs=("stroke:1",),
        outputs=("drive:1",), states=(), units={},
    )  # fmt: skip
    with pytest.raises(InputError, match="answers the rate"):
        mass().close(law)
    with pytest.raises(InputError, match="continuous"):
        fc.StateSpace(**vars(law) | {"sample": 1e-3})
