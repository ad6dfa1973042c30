"""Damping in proportion to stiffness: ratios of modes, energy lost, files, sweeps, words, against closed forms."""

import numpy as np
import pytest
from tests.helpers.runs import FIELDS, paper_robot, run_actuator, run_robot, with_legs

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.common.tables.key_paths import parse_key
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, columns
from flexapod.model import Actuator, ActuatorMotion, ActuatorStudy, Damping, Simulation, loads, override, to_toml
from flexapod.model.file.fields import read_fields
from flexapod.model.file.key_paths import put, value_at
from flexapod.output.text.study import _damping
from flexapod.solve.modal.actuator_modes import actuator_modes
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.analytic

BEAM = {"length": 1.0, "rhoA": 1.0, "EI": 1.0, "free_length": 1.0}
BETA = np.array([1.875104068711961, 4.694091132974174, 7.854757438237613])  # roots of cos b cosh b = -1


@pytest.mark.parametrize("basis", ["clamped-free", "tip-load"])
@pytest.mark.parametrize("ratio", [0.0, 0.02])
def test_ratio_of_the_modes_of_a_bare_beam(basis, ratio):
    """ratio + stiffness omega / 2, omega_i = beta_i^2 of the textbook's clamped-free beam."""
    time = 1e-4
    simulation = Simulation(basis=basis, modes=6)
    found = actuator_modes(Actuator(**BEAM, damping=Damping(ratio=ratio, stiffness=time)), simulation)
    # The highest shapes of the basis of loads stand for all higher modes: three of six are right to 1e-3.
    np.testing.assert_allclose(
        found.damping_ratio[:3], ratio + time * BETA**2 / 2, rtol=1e-9 if basis == "clamped-free" else 1e-3
    )


@pytest.mark.parametrize("fidelity", ["finite-segment", "beam-fem"])
def test_ratio_of_the_modes_of_elements(fidelity):
    """Whatever the basis, its own frequencies carry the ratio."""
    beam = Actuator(**BEAM, damping={"ratio": 0.01, "stiffness": 2e-4})
    found = actuator_modes(beam, Simulation(fidelity=fidelity, modes=6))
    np.testing.assert_allclose(found.damping_ratio, 0.01 + 1e-4 * 2 * np.pi * found.frequency, rtol=1e-9)


def test_matrices_of_a_leg_in_stretch_and_bending():
    """D = time K without gravity and force, in every elastic coordinate: K of another function than D."""
    study = paper_robot(leg={"damping": Damping(stiffness=1e-4)})
    system = prepare(override(study, duration=1e-3, step=1e-3)).system
    p = system.leg_p[0].copy()
    p[columns(LEG_PARAMETERS, "gravity")] = 0.0
    q = np.zeros(system.n)
    q[2] = 0.9
    _, D, K, _ = system.kernel.leg_matrices(q, np.zeros(3), p)
    np.testing.assert_allclose(D[3:, 3:], 1e-4 * K[3:, 3:], rtol=1e-12, atol=1e-9)
    assert (np.diag(D)[3:] > 0).all()
    assert not D[:3].any()


def test_energy_lost_by_a_ringing_beam():
    """A mode of angular frequency w and ratio z = time w / 2 has lost 1 - exp(-2 z w t) of its energy after periods."""
    time, periods = 2e-3, 3
    omega = BETA[0] ** 2
    damped = omega * np.sqrt(1 - (time * omega / 2) ** 2)
    study = ActuatorStudy(
        actuator=Actuator(**BEAM, damping=Damping(stiffness=time)),
        motion=ActuatorMotion(),
        simulation=Simulation(
            basis="clamped-free", modes=1, duration=periods * 2 * np.pi / damped,
            step=2 * np.pi / damped / 400, output_step=2 * np.pi / damped / 4, rho_inf=1.0,
        ),
    )  # fmt: skip
    run = run_actuator(study, amplitudes=np.array([1e-3]))
    lost = run["sums"][-1, 0] / run["energy"][0].sum()
    # Undamped by the method (rho = 1); its period is longer by (w h)^2 / 12 = 2e-5, so is the loss off.
    assert lost == pytest.approx(1 - np.exp(-time * omega**2 * study.simulation.duration), rel=1e-4)
    balance = run["energy"].sum(axis=1) + run["sums"][:, 0]
    np.testing.assert_allclose(balance, balance[0], rtol=1e-5)


def test_robot_loses_what_its_pistons_rates_say():
    """Power time * rates^T K rates of the elastic coordinates, summed from stored rates, is the energy lost."""
    study = paper_robot(leg={"damping": Damping(stiffness=3e-5)}, start="straight")
    study = override(study.replace(motion=study.motion.replace(amplitude=0.0)), duration=0.02, step=2e-5)
    run = run_robot(override(study, output_step=2e-5))
    shapes, leg = prepare(study).system.kernel.shapes, study.robot.legs[0]
    n = shapes.size
    rates, length = run["v"][:, : 6 * n].reshape(-1, 6, n)[:, :, 3:], run["q"][:, :, 2] - leg.cylinder.mouth
    m, k = shapes.beam.axial.count, shapes.beam.a.count
    parts = rates[:, :, :m], rates[:, :, m : m + k], rates[:, :, m + k :]
    stretch = (
        leg.piston.EA / leg.piston.length * np.einsum("tli,ij,tlj->t", parts[0], shapes.beam.axial.stiffness, parts[0])
    )
    bend = [np.einsum("tl,tli,ij,tlj->t", leg.piston.EI / length**3, x, shapes.beam.a.stiffness, x) for x in parts[1:]]
    power = 3e-5 * (stretch + sum(bend))
    work = 2e-5 * np.concatenate([[0], np.cumsum(0.5 * (power[1:] + power[:-1]))])
    np.testing.assert_allclose(run["sums"][:, 0], work, rtol=1e-7)  # velocities stored before the last correction
    assert work[-1] > 1e-3


def test_none_of_it_changes_no_digit():
    plain = paper_robot(duration=0.02, step=1e-3)
    same = with_legs(plain, lambda leg: leg.replace(damping=Damping(ratio=leg.damping)))
    one, other = run_robot(plain), run_robot(same)
    for name in FIELDS:
        np.testing.assert_array_equal(one[name], other[name])


@pytest.mark.parametrize("fidelity", ["lumped", "finite-segment", "assumed-modes", "beam-fem", "solid-fem"])
def test_every_fidelity_damps_with_it(fidelity):
    modes = {} if fidelity == "lumped" else {"modes": 2}
    ratios = []
    for damping in (0.0, {"stiffness": 1e-5}, {"stiffness": 2e-5}):
        robot = with_legs(paper_robot(), lambda leg, d=damping: leg.replace(damping=d)).robot
        ratios.append(fx.modes(robot, fidelity=fidelity, **modes).damping_ratio.values[:6])
    np.testing.assert_allclose(ratios[0], 0.0, atol=1e-12)
    np.testing.assert_allclose(ratios[2], 2 * ratios[1], rtol=1e-3)  # light damping
    assert (ratios[1] > 0).all()


ROBOT, ACTUATOR = fx.preset("paper-robot").source_text, fx.preset("paper-actuator").source_text


@pytest.mark.parametrize(("text", "old"), [(ROBOT, "damping = 0.005"), (ACTUATOR, "damping = 0 ")])
def test_in_files_and_back(text, old):
    study = loads(text.replace(old, 'damping = { ratio = 0.01, stiffness = "100 us" } '))
    body = study.actuator if "[actuator]" in text else study.robot.legs[0]
    assert (body.damping.ratio, body.damping.stiffness) == (0.01, pytest.approx(1e-4))
    again = loads(to_toml(study))
    assert (again.actuator if "[actuator]" in text else again.robot.legs[0]) == body
    fields = {field.key: field for field in read_fields(study.source_text, None)}
    table = "actuator" if "[actuator]" in text else "leg"
    assert fields[f"{table}.damping.stiffness"].dimensions == ("time",)
    assert fields[f"{table}.damping.ratio"].bounds.most == 1.0
    plain = {field.key: field for field in read_fields(text, None)}
    assert plain[f"{table}.damping"].bounds.words == "at least 0, below 1"


def test_what_is_refused_from_python():
    leg = paper_robot().robot.legs[0]
    for damping, key in ((-0.1, "damping"), ("much", "damping"), ({"ratio": 2.0}, "damping.ratio")):
        with pytest.raises(InputError) as error:
            leg.replace(damping=damping)
        assert error.value.key == key


def test_sweeps_reach_both_parts():
    data = {"leg": {"damping": 0.005}}
    put(data, parse_key("leg.damping.stiffness", what="key"), "1 ms")
    assert data == {"leg": {"damping": {"ratio": 0.005, "stiffness": "1 ms"}}}
    put(data, parse_key("leg[3].damping.ratio", what="key"), 0.1)
    assert [leg["damping"]["ratio"] for leg in data["leg"]] == [0.005, 0.005, 0.1, 0.005, 0.005, 0.005]
    assert value_at({"actuator": {"damping": 0.02}}, ("actuator", "damping", "ratio")) == 0.02


def test_words():
    study = paper_robot(leg={"damping": Damping(ratio=0.005, stiffness=1e-4)})
    assert _damping(study.robot.legs[0].damping, "piston") == (
        "damping of 0.5 % of the critical one in every mode of the bare piston and "
        "damping of 0.1 ms times the stiffness of the piston"
    )
    assert _damping(0.0, "beam") == "no damping"
