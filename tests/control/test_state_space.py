"""State spaces with named channels: closed forms, and NumPy's solutions at each frequency."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.common.errors import ComputationError, InputError
from flexapod.control import StateSpace, frequency_response

pytestmark = pytest.mark.unit

M, K, C = 2.0, 800.0, 1.2  # one mode: kg, N/m, N s/m


def one_mode(m=M, k=K, c=C):
    return StateSpace(
        A=np.array([[0, 1], [-k / m, -c / m]]),
        B=np.array([[0], [1 / m]]),
        C=np.array([[1.0, 0], [0, 1], [-k, -c]]),
        D=np.array([[0.0], [0], [1]]),
        inputs=("drive:1",),
        outputs=("tool:z", "rate:z", "force-sensor:drive:1"),
        states=("z", "z rate"),
        units={"drive:1": "N", "tool:z": "m", "rate:z": "m s-1", "force-sensor:drive:1": "N"},
    )


def masses(m, k, c, ground=0.0):
    """A chain of masses with springs and dampers, force and position at each; `ground`: the first spring to earth."""
    n = len(m)
    step = np.diff(np.eye(n), axis=0)
    K = step.T @ np.diag(k) @ step + ground * np.diag([1.0] + [0] * (n - 1))
    D = step.T @ np.diag(c) @ step
    inv = np.diag(1 / np.asarray(m, float))
    names = [f"{i + 1}" for i in range(n)]
    return StateSpace(
        A=np.block([[np.zeros((n, n)), np.eye(n)], [-inv @ K, -inv @ D]]),
        B=np.vstack([np.zeros((n, n)), inv]),
        C=np.hstack([np.eye(n), np.zeros((n, n))]),
        D=np.zeros((n, n)),
        inputs=tuple(f"force:{i}" for i in names),
        outputs=tuple(f"x:{i}" for i in names),
        states=tuple([f"x{i}" for i in names] + [f"v{i}" for i in names]),
        units={f"force:{i}": "N" for i in names} | {f"x:{i}": "m" for i in names},
    )


def solved(system, hz):
    s = 2j * np.pi * np.asarray(hz)
    s = s if system.sample is None else np.exp(s * system.sample)
    n = len(system.A)
    return np.stack([system.C @ np.linalg.solve(p * np.eye(n) - system.A, system.B) + system.D for p in s], axis=-1)


def close(found, exact):
    """To 1e-9 of each number; numbers that are rounding of larger terms to 1e-9 of a millionth of the largest."""
    floor = 1e-6 * np.abs(exact).max(axis=-1, keepdims=True)
    return (np.abs(found - exact) <= 1e-9 * np.maximum(np.abs(exact), floor)).all()


def test_one_mode_is_its_closed_form():
    hz = np.geomspace(0.01, 1e4, 200)
    s = 2j * np.pi * hz
    z = 1 / (M * s**2 + C * s + K)
    exact = np.stack([z, s * z, M * s**2 * z])[:, None]
    # Eigenvalues and one sum of two terms: rounding, and its growth by (s / omega)^2 = 1e7 where mass alone counts.
    assert np.abs(one_mode().at(hz) / exact - 1).max() < 1e-9
    data = one_mode().frequency_response(hz)
    assert data.frequency_response.dims == ("output", "input", "frequency", "part")
    picked = data.frequency_response.sel(output="tool:z", input="drive:1")
    assert np.allclose(picked.sel(part="real") + 1j * picked.sel(part="imaginary"), z, rtol=1e-9)
    assert data.output_units.sel(output="force-sensor:drive:1") == "N" and data.frequency.attrs["units"] == "Hz"


def test_poles_zeros_and_damping_of_one_mode():
    system, w = one_mode(), np.sqrt(K / M)
    zeta = C / (2 * np.sqrt(K * M))
    exact = w * (-zeta - 1j * np.sqrt(1 - zeta**2))
    np.testing.assert_allclose(system.poles(), [exact, np.conj(exact)], rtol=1e-13)
    data = system.damp()
    np.testing.assert_allclose(data.frequency, [w / (2 * np.pi)], rtol=1e-13)
    np.testing.assert_allclose(data.damping_ratio, [zeta], rtol=1e-11)
    assert system.zeros("drive", "tool").size == 0
    np.testing.assert_allclose(system.zeros("drive", "rate"), [0], atol=1e-12)
    np.testing.assert_allclose(system.zeros("drive", "force-sensor"), [0, 0], atol=1e-6)  # double: sqrt of rounding


def test_zeros_of_collocated_masses_are_what_the_others_do_alone():
    system = masses([1.0, 2.0, 0.5], [3e4, 5e4], [4.0, 2.0])
    rest = masses([2.0, 0.5], [5e4], [2.0], ground=3e4)  # the first mass held
    A = np.array(rest.A)
    A[2, 2] -= 4.0 / 2.0  # with its damper
    exact = np.linalg.eigvals(A)
    found = system.zeros("force:1", "x:1")
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(exact), rtol=1e-9)
    # From the first mass to the last: s^0 times both spring-dampers in a row, zeros at -k/c.
    found = system.zeros("force:1", "x:3")
    np.testing.assert_allclose(np.sort(found.real), [-5e4 / 2.0, -3e4 / 4.0], rtol=1e-7)


def test_zeros_leave_out_what_cancels():
    pair = masses([1.0, 1.0], [100.0], [0.1])  # the difference of equal masses does not see their sum
    seen = StateSpace(
        A=pair.A, B=pair.B @ [[1.0], [-1.0]], C=pair.C[:1] - pair.C[1:],
        D=np.zeros((1, 1)), inputs=("u",), outputs=("y",), states=pair.states, units={},
    )  # fmt: skip
    assert seen.zeros().size == 0


def random_robot(rng, legs=6, modes=20):
    """Modes from 10 Hz to 100 kHz, damping 1e-4 to overdamped, 12 inputs, 24 outputs."""
    w = 2 * np.pi * np.geomspace(10, 1e5, modes)
    zeta = 10 ** rng.uniform(-4, 0.5, modes)
    psi = rng.standard_normal((modes, 12))
    out = rng.standard_normal((24, modes))
    n = modes
    return StateSpace(
        A=np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(w**2), -np.diag(2 * zeta * w)]]),
        B=np.vstack([np.zeros((n, 12)), psi]),
        C=np.hstack([out, np.zeros((24, n))]),
        D=np.zeros((24, 12)),
        inputs=tuple(f"u:{i}" for i in range(12)),
        outputs=tuple(f"y:{i}" for i in range(24)),
        states=tuple(f"x{i}" for i in range(2 * n)),
        units={},
    )


def with_integrators(system):
    """All inputs through two integrators in a row, as commands of held coordinates come in."""
    n, m = system.B.shape
    zero = np.zeros
    return StateSpace(
        A=np.block(
            [
                [system.A, system.B, zero((n, m))],
                [zero((m, n + m)), np.eye(m)],
                [zero((m, n + 2 * m))],
            ]
        ),
        B=np.vstack([zero((n + m, m)), np.eye(m)]),
        C=np.hstack([system.C, system.D, zero((len(system.C), m))]),
        D=zero(system.D.shape),
        inputs=system.inputs,
        outputs=system.outputs,
        states=tuple(f"x{i}" for i in range(n + 2 * m)),
        units={},
    )


@pytest.mark.parametrize("seed", range(3))
def test_poles_and_residues_equal_solving_at_each_frequency(seed):
    system = random_robot(np.random.default_rng(seed))
    hz = np.geomspace(1, 1e4, 300)
    assert close(system.at(hz), solved(system, hz))


def test_integrators_in_a_row_and_critical_damping_equal_solving():
    system = with_integrators(random_robot(np.random.default_rng(5)))
    hz = np.geomspace(1, 1e4, 100)
    assert close(system.at(hz), solved(system, hz))
    critical = one_mode(c=2 * np.sqrt(K * M))
    assert close(critical.at(hz), solved(critical, hz))


@pytest.mark.parametrize("n", [2, 3, 4, 5])
@pytest.mark.parametrize("rate", [0.3, 20.0, 4e3])
@pytest.mark.parametrize("count", [7, 200])
def test_equal_filters_in_a_row_are_a_power_of_one(n, rate, count):
    # (a / (s + a))^n. Its matrix is triangular, its poles equal to the last bit and their shapes all the same: 1e-12
    # is some thousand roundings of a product of n factors. Half of the cases with states in units far apart.
    hz = np.geomspace(1e-3, 1e3, count) * rate
    expected = (rate / (2j * np.pi * hz + rate)) ** n
    for units in (np.ones(n), 10.0 ** (3 * (-1.0) ** np.arange(n))):
        g = fx.control.StateSpace(
            A=(rate * (np.diag(np.ones(n - 1), 1) - np.eye(n))) * units[:, None] / units,
            B=rate * units[:, None] * np.eye(n)[:, [-1]],
            C=np.eye(n)[[0]] / units,
            D=np.zeros((1, 1)),
            inputs=("u",),
            outputs=("y",),
            states=tuple(f"x{k}" for k in range(n)),
            units={},
        )
        np.testing.assert_allclose(g.at(hz)[0, 0], expected, rtol=1e-12)


def test_a_sampled_system_is_evaluated_on_the_circle():
    system = StateSpace(
        A=np.array([[0.9]]), B=np.array([[0.1]]), C=np.eye(1), D=np.zeros((1, 1)), inputs=("u",), outputs=("y",),
        states=("x",), units={}, sample=1e-3,
    )  # fmt: skip
    hz = np.array([1.0, 50.0, 499.0])
    z = np.exp(2j * np.pi * hz * 1e-3)
    np.testing.assert_allclose(system.at(hz)[0, 0], 0.1 / (z - 0.9), rtol=1e-12)
    np.testing.assert_allclose(system.damp().frequency, [-np.log(0.9) / 1e-3 / (2 * np.pi)], rtol=1e-12)
    assert system.damp().damping_ratio == 1.0


def test_of_many_frequencies_few_are_solved_for(monkeypatch):
    """A solution at a frequency costs as much as poles and residues at a hundred: some twenty check the others."""
    system, solved_for = random_robot(np.random.default_rng(1)), []
    solving = frequency_response._solved
    monkeypatch.setattr(
        frequency_response, "_solved", lambda A, B, C, s: solved_for.append(s.size) or solving(A, B, C, s)
    )
    system.at(np.geomspace(1, 1e4, 1000))
    assert 0 < sum(solved_for) <= 2 * frequency_response.CHECKED


def test_channels_are_chosen_by_name_and_by_group():
    system = one_mode()
    part = system.select("drive", ["force-sensor", "tool:z"])
    assert part.outputs == ("force-sensor:drive:1", "tool:z")
    np.testing.assert_array_equal(part.C, system.C[[2, 0]])
    np.testing.assert_array_equal(part.D, [[1], [0]])
    assert system.select(outputs="force-sensor:drive").outputs == ("force-sensor:drive:1",)


@pytest.mark.parametrize(
    ("given", "words"),
    [("tol", "Did you mean 'tool'"), ("tool:zz", "Did you mean 'tool:z'"), ("drive", "Allowed: tool, rate")],
)
def test_an_unknown_channel_is_refused_with_the_nearest(given, words):
    with pytest.raises(InputError, match=words):
        one_mode().select(outputs=given)


def test_matrices_that_do_not_fit_the_names_are_refused():
    with pytest.raises(InputError, match=r"B: has the shape \(1, 1\). Allowed: \(1, 2\)"):
        StateSpace(
            A=np.eye(1), B=np.eye(1), C=np.eye(1), D=np.ones((1, 2)), inputs=("a", "b"), outputs=("y",), states=("x",),
            units={},
        )  # fmt: skip
    with pytest.raises(InputError, match="are 1 inputs and 3 outputs"):
        one_mode().zeros()
    with pytest.raises(ValueError, match="read-only"):
        one_mode().A[0, 0] = 1.0


def test_at_rest_only_channels_with_integrators_have_no_response():
    system = masses([1.0, 1.0], [100.0], [0.1], ground=50.0)
    both = with_integrators(system)
    with_force = StateSpace(
        A=both.A, B=np.vstack([system.B, np.zeros((4, 2))]), C=both.C, D=both.D, inputs=system.inputs,
        outputs=both.outputs, states=both.states, units={},
    )  # fmt: skip
    np.testing.assert_allclose(with_force.at(0)[..., 0], np.linalg.inv([[150.0, -100], [-100, 100]]), rtol=1e-12)
    with pytest.raises(ComputationError, match="no finite size at 0 Hz: a pole"):
        both.at([0, 1.0])


def test_responses_over_all_frequencies_of_a_robot_are_those_of_solving(monkeypatch):
    """From far below its poles to three times the fastest: 7 decades, each part by poles that are known well there.
    Against solving at fifty points: what is checked to 1e-9 at some of them has ten times that between them at most.
    Channels that are 0 by symmetry hold rounding of the others."""
    plant = fx.linearize(fx.preset("nano-hexapod"), inputs="drive", outputs=["force-sensor:drive", "stroke"])
    hz, solved = np.geomspace(0.01, 2e5, 2000), []
    solving = frequency_response._solved
    monkeypatch.setattr(frequency_response, "_solved", lambda *a: (solved.append(a[3].size), solving(*a))[1])
    found = plant.at(hz)
    assert sum(solved) < 600  # the rest by residues
    for k in range(0, 2000, 40):
        exact = plant.C @ np.linalg.solve(2j * np.pi * hz[k] * np.eye(len(plant.A)) - plant.A, plant.B) + plant.D
        size = np.abs(exact).max(axis=1, keepdims=True)
        assert (np.abs(found[:, :, k] - exact) <= 1e-8 * size).all()
