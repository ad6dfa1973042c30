"""The compiled march with leg-by-leg elimination against the dense twin in NumPy, in every limit of the leg."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, with_legs

from flexapod import kinematics
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import ForceDrive, PrescribedDrive, ServoDrive, override, preset
from flexapod.solve.time import interpreted, native
from flexapod.solve.time.actuator_march import prepare_actuator
from flexapod.solve.time.command_tables import robot_law
from flexapod.solve.time.recording import Counters
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.consistency

DRIVES = {
    "prescribed": PrescribedDrive(),
    "servo": ServoDrive(stiffness=2e7, damping=1e3),
    "force": ForceDrive(law="rigid", feedback={"stiffness": 1e6, "damping": 1e3}),
}
FIDELITIES = [
    ("rigid", 3, 2),
    ("lumped", 3, 1),
    ("assumed-modes", 2, 0),
    ("assumed-modes", 2, 2),
    ("assumed-modes", 1, 1),
    ("beam-fem", 2, 2),
    ("finite-segment", 2, 1),
]


def bare(leg):
    """No cylinder: mass, inertia and mouth zero."""
    return leg.replace(cylinder=leg.cylinder.replace(mass=0.0, com=0.0, inertia=0.0, mouth=0.0))


def study_for(fidelity, modes, axial_modes, drive, cylinder):
    study = paper_robot(leg={"drive": DRIVES[drive], "axial_modes": axial_modes}, start="moving")
    if not cylinder:
        study = with_legs(study, lambda leg: bare(leg).replace(piston=leg.piston.replace(length=1.2)))
    settings = {"modes": modes} if fidelity not in ("rigid", "lumped") else {}
    return override(study, fidelity=fidelity, step=1e-3, duration=0.02, **settings)


@pytest.mark.parametrize("cylinder", [True, False], ids=["cylinder", "bare"])
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(("fidelity", "modes", "axial_modes"), FIDELITIES)
def test_elimination_equals_the_dense_system(fidelity, modes, axial_modes, drive, cylinder):
    study = study_for(fidelity, modes, axial_modes, drive, cylinder)
    prepared = prepare(study)
    system = prepared.system
    law = robot_law(system, study.robot, study.load, partial(kinematics.rigid_poses, study.robot, study.motion))
    tables = law(np.arange(11) * 1e-3)
    method = replace_method(study)
    flow, _ = native.first_record(system, prepared.start, *tables)
    fast = native.advance(system, method, flow, 1e-3, tables, 1, Counters())
    slow = interpreted.advance(system, method, flow, 1e-3, tables, 1, Counters())
    assert fast.status == slow.status == 0
    # Both end their Newton iterations at rounding. Where nothing yields (no axial shape, prescribed strokes) gaps of
    # 1e-16 m make forces of M / (beta h^2 sigma^2) times that: 4e8 / 0.03^2 * 1e-16 = 5e-5 N, several times over.
    for name, atol in (("q", 1e-12), ("pose", 1e-12), ("v", 1e-9), ("lam", 4e-4), ("drive", 4e-4)):
        np.testing.assert_allclose(
            getattr(fast.flow, name), getattr(slow.flow, name), rtol=1e-8, atol=atol, err_msg=name
        )


def test_legs_whose_matrix_is_not_positive_seek_pivots():
    """Pistons of negative mass and stiffness: every second leg has a matrix of its shapes that is negative."""
    study = study_for("assumed-modes", 2, 2, "servo", True)
    prepared = prepare(study)
    leg_p = prepared.system.leg_p.copy()
    for name in ("rhoA", "EI", "EA"):
        leg_p[::2, columns(leg_parameters(prepared.system.kernel.shapes), name)] *= -1
    system = replace(prepared.system, leg_p=leg_p)
    law = robot_law(system, study.robot, study.load, partial(kinematics.rigid_poses, study.robot, study.motion))
    tables = law(np.arange(4) * 1e-3)
    fast, slow = (
        twin.advance(system, replace_method(study), prepared.start, 1e-3, tables, 1, Counters())
        for twin in (native, interpreted)
    )
    assert fast.status == slow.status == 0
    for name, atol in (("q", 1e-12), ("pose", 1e-12), ("v", 1e-9), ("lam", 4e-4)):  # as above
        np.testing.assert_allclose(
            getattr(fast.flow, name), getattr(slow.flow, name), rtol=1e-8, atol=atol, err_msg=name
        )


def replace_method(study):
    from flexapod.common.generalized_alpha import GeneralizedAlpha

    return GeneralizedAlpha(study.simulation.rho_inf)


@pytest.mark.parametrize("driven", [False, True])
def test_single_actuator_equals_its_twin(driven):
    study = override(preset("paper-actuator"), step=1e-3, duration=0.05)
    if driven:
        study = study.replace(
            motion=study.motion.replace(rotation=None, extension=None),
            load=study.load.replace(torque={"law": "constant", "value": 3.0}, force={"law": "constant", "value": -2.0}),
        )
    prepared = prepare_actuator(study)
    system = prepared.system
    from flexapod.solve.time.actuator_march import _tables as actuator_tables

    tables = actuator_tables(study)(np.arange(51) * 1e-3)
    fast = native.advance(system, replace_method(study), prepared.start, 1e-3, tables, 1, Counters())
    slow = interpreted.advance(system, replace_method(study), prepared.start, 1e-3, tables, 1, Counters())
    for name in ("q", "v", "drive"):
        # The free system has no constraint to magnify rounding; Newton ends at 1e-10 of the largest force.
        np.testing.assert_allclose(
            getattr(fast.flow, name), getattr(slow.flow, name), rtol=1e-7, atol=1e-9, err_msg=name
        )
