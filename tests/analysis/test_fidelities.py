"""Fidelities that bring a basis of their own run everywhere: from Python and from a file, robot and single actuator."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import Simulation, Study, loads, override, preset_text

pytestmark = pytest.mark.contract

OWN = [("beam-fem", 6, "hermite"), ("finite-segment", 8, "segments")]
every_fidelity = pytest.mark.parametrize(("fidelity", "modes", "basis"), OWN)
ROBOT, ACTUATOR = fx.preset("paper-robot"), fx.preset("paper-actuator")
SHORT = {"duration": 0.02, "step": 1e-3}


def as_file(name, fidelity, modes):
    lines = [line for line in preset_text(name).splitlines() if not line.startswith(("fidelity =", "basis ="))]
    text = "\n".join(lines).replace("modes = 3", f'modes = {modes}\nfidelity = "{fidelity}"')
    return loads(text)


@every_fidelity
@pytest.mark.parametrize("name", ["paper-robot", "paper-actuator"])
def test_presets_from_python_and_from_a_file(name, fidelity, modes, basis):
    run = fx.simulate if name == "paper-robot" else fx.simulate_actuator
    called = run(fx.preset(name), fidelity=fidelity, modes=modes, **SHORT)
    read = run(as_file(name, fidelity, modes), **SHORT)
    assert {key: called.attrs[key] for key in ("fidelity", "basis", "modes", "partial")} == {
        "fidelity": fidelity, "basis": basis, "modes": modes, "partial": 0,
    }  # fmt: skip
    np.testing.assert_array_equal(called.tip_deflection, read.tip_deflection)
    assert called.closure_residual.max() < 1e-13
    assert called.attrs["study_hash"] == read.attrs["study_hash"]


@every_fidelity
def test_the_written_study_names_no_basis(fidelity, modes, basis):
    for study in (ROBOT, ACTUATOR):
        changed = override(study.replace(simulation=study.simulation.replace(basis="clamped-free")), fidelity=fidelity,
                           modes=modes)  # fmt: skip
        assert "basis" not in changed.source_text
        again = loads(changed.source_text)
        assert again.simulation == changed.simulation
        assert again.warnings == study.warnings
        back = override(changed, fidelity="assumed-modes")
        assert back.simulation.lateral_basis == study.simulation.basis
    built = Study(robot=ROBOT.robot, motion=ROBOT.motion, simulation=Simulation(fidelity=fidelity, modes=modes))
    assert built.simulation.lateral_basis == basis


@every_fidelity
def test_a_basis_beside_them_is_refused(fidelity, modes, basis):
    with pytest.raises(InputError, match="no effect") as error:
        override(ROBOT, fidelity=fidelity, modes=modes, basis="clamped-free")
    assert error.value.key == "basis"
    for refused in (
        lambda: Simulation(fidelity=fidelity, modes=modes, basis="tip-load"),
        lambda: Simulation(fidelity=fidelity, modes=modes).replace(basis="clamped-free"),
        lambda: ROBOT.simulation.replace(fidelity=fidelity, modes=modes, basis="clamped-free"),
    ):
        with pytest.raises(InputError, match=r"basis = .*no effect.*own"):
            refused()
    text = preset_text("paper-robot")
    with pytest.raises(InputError, match=r"simulation\.basis.*no effect.*own"):
        loads(text.replace('"assumed-modes"', f'"{fidelity}"').replace("modes = 3", 'modes = 4\nbasis = "tip-load"'))
    with pytest.raises(InputError, match=f"simulation.basis.*{fidelity}"):
        loads(text.replace("modes = 3", f'modes = 3\nbasis = "{basis}"'))


@every_fidelity
def test_axial_shapes_are_kept(fidelity, modes, basis):
    study = override(ROBOT, fidelity=fidelity, modes=2, axial_modes=1)
    assert study.simulation.axial_shapes(1) == 1
    found = fx.modes(study)
    assert (found.attrs["basis"], found.attrs["modes"]) == (basis, 2)
    assert found.sizes["mode"] == 6 + 6 * (1 + 4) - 6  # payload, shapes, strokes; closures take the two angles and one


@every_fidelity
def test_the_moment_at_the_mouth_is_read_off(fidelity, modes, basis):
    # Tip force: exact in cubics. Hinges carry the moment of their own place: half a segment from the mouth it is less.
    b = lateral_basis(basis, modes)
    moment = np.linalg.solve(b.stiffness, b.tip) @ b.values(np.linspace(0, 1, 21), 2)
    first = 1.0 if basis == "hermite" else 1 - 0.5 / modes
    assert moment[0] == pytest.approx(first, rel=1e-10)
    assert np.argmax(np.round(moment, 9)) == 0


def test_beam_elements_take_more_shapes_than_the_others():
    assert Simulation(fidelity="beam-fem", modes=24).lateral_shapes == 24
    for fidelity, modes in (("assumed-modes", 13), ("finite-segment", 24), ("lumped", 13)):
        with pytest.raises(InputError, match="1 to 12"):
            Simulation(fidelity=fidelity, modes=modes)
    with pytest.raises(InputError, match="at most 24"):
        Simulation(fidelity="beam-fem", modes=26)
