"""Fidelity `solid-fem`: the same leg with shapes and stiffness reduced from the solid piston."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.model import Rectangle, preset_text

pytestmark = pytest.mark.contract

ROBOT = fx.preset("paper-robot")
SHORT = {"duration": 0.1, "step": 1e-3}


def test_the_robot_differs_from_beam_legs_by_shear_only():
    beam = fx.simulate(ROBOT, modes=6, **SHORT)
    solid = fx.simulate(ROBOT, fidelity="solid-fem", modes=6, **SHORT)
    assert (solid.attrs["fidelity"], solid.attrs["basis"]) == ("solid-fem", "solid")
    assert solid.closure_residual.max() < 1e-13
    # Bending under a tip force is softer by 6 (1 + nu) / kappa (r / s)^2 = 9e-4 at nu = 0; the whole difference of the
    # tips is of that size. The payload's path is all stretch, which both have in common.
    gap = np.abs(solid.tip_deflection - beam.tip_deflection).max() / np.abs(beam.tip_deflection).max()
    assert 3e-4 < gap < 3e-3
    assert np.abs(solid.com_deviation - beam.com_deviation).max() < 2e-4 * np.abs(beam.com_deviation).max()


def test_frequencies_of_the_locked_robot():
    def lowest(fidelity):
        return fx.modes(ROBOT, fidelity=fidelity, modes=6).frequency.values[:16]

    # Shear costs the first bending of a clamped leg half of 9e-4: a tip force is its static load.
    ratio = lowest("solid-fem") / lowest("assumed-modes")
    assert np.all(ratio < 1 + 1e-7)
    assert -6e-4 < ratio.min() - 1 < -3e-4


def test_it_is_read_from_a_file_and_written_again():
    text = preset_text("paper-robot").replace('"assumed-modes"', '"solid-fem"')
    study = fx.loads(text)
    assert (study.simulation.fidelity, study.simulation.lateral_shapes) == ("solid-fem", 3)
    with pytest.raises(InputError, match=r"simulation\.basis.*no effect.*own"):
        fx.loads(text.replace("modes = 3", 'modes = 3\nbasis = "tip-load"'))


def with_piston(**changes):
    legs = ROBOT.robot.legs
    piston = legs[0].piston.replace(**changes)
    return ROBOT.robot.replace(legs=(legs[0].replace(piston=piston), *legs[1:]))


def test_pistons_without_one_diameter_are_refused():
    thicker = with_piston(diameter=0.03)
    with pytest.raises(InputError, match="alike") as error:
        fx.simulate(thicker, ROBOT.motion, fidelity="solid-fem", **SHORT)
    assert error.value.key == "simulation.fidelity"


def test_the_single_actuator_needs_its_section():
    study = fx.preset("paper-actuator")
    with pytest.raises(InputError, match="section"):
        fx.simulate_actuator(study, fidelity="solid-fem", **SHORT)
    flat = study.actuator.replace(section=Rectangle(width=0.1524, height=0.0095))
    solid = fx.simulate_actuator(study.replace(actuator=flat), fidelity="solid-fem", modes=10, **SHORT)
    beam = fx.simulate_actuator(study, modes=10, **SHORT)
    # Shear of a beam 9.5 mm deep and 1.83 m long is 1e-5 in the first frequency, 1e-3 in the tenth; ten shapes carry
    # the static start to 1e-4.
    assert np.abs(solid.tip_deflection - beam.tip_deflection).max() < 5e-4 * np.abs(beam.tip_deflection).max()
