"""Fidelity `solid-fem`: the same leg with shapes and stiffness reduced from the solid piston."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.errors import InputError
from flexapod.model import Rectangle, preset_text
from flexapod.solve.shapes import POISSON

ROBOT = fx.preset("paper-robot")
SHORT = {"duration": 0.1, "step": 1e-3}


def test_the_robot_differs_from_beam_legs_by_shear_only():
    beam = fx.simulate(ROBOT, modes=6, **SHORT)
    solid = fx.simulate(ROBOT, fidelity="solid-fem", modes=6, **SHORT)
    assert (solid.attrs["fidelity"], solid.attrs["basis"]) == ("solid-fem", "solid")
    assert solid.closure_residual.max() < 1e-13
    # Bending is softer by 6 (1 + nu) / kappa times (r / s)^2 = 1.1e-3 for a tip force, the mouth of the solid stiffer
    # by as much at nu = 0.3; the payload's path is all stretch, which both have in common.
    gap = np.abs(solid.tip_deflection - beam.tip_deflection).max() / np.abs(beam.tip_deflection).max()
    assert 1e-6 < gap < 1.1e-3
    assert np.abs(solid.com_deviation - beam.com_deviation).max() < 2e-4 * np.abs(beam.com_deviation).max()


def test_frequencies_of_the_locked_robot():
    def lowest(fidelity):
        return fx.modes(ROBOT, fidelity=fidelity, modes=6).frequency.values[:16]

    # First bending of a pinned leg: shear costs (r/s)^2 pi^2 (1 + E / kappa G) / 2, some 2e-3, less the stiffer mouth.
    ratio = lowest("solid-fem") / lowest("assumed-modes")
    assert np.all(np.abs(ratio - 1) < 2e-3)
    assert np.any(np.abs(ratio - 1) > 1e-5)
    assert 0 < POISSON < 0.5


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
    solid = fx.simulate_actuator(study.replace(actuator=flat), fidelity="solid-fem", modes=3, **SHORT)
    beam = fx.simulate_actuator(study, modes=3, **SHORT)
    # A wide flat beam at nu = 0.3: the held section average of the mouth stiffens it by 0.25 % in frequency.
    assert np.abs(solid.tip_deflection - beam.tip_deflection).max() < 0.01 * np.abs(beam.tip_deflection).max()
