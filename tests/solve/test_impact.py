"""Jumps in the commanded rate are impacts: velocities jump consistently and the energy balance stays."""

import numpy as np
import pytest
from tests.helpers.runs import balance, collect, paper_robot, run_actuator

from flexapod import kinematics
from flexapod.model import override, preset
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.conservation


def first_instant(fidelity):
    march = prepare(paper_robot(profile="linear", fidelity=fidelity, step=2e-4, duration=0.01))
    return march, collect(march.chunks)


def test_rigid_robot_takes_the_whole_impact():
    # Rigid legs leave the payload no choice: kinetic energy jumps to that of the commanded velocity field.
    march, run = first_instant("rigid")
    study = paper_robot(profile="linear")
    kinetic, _ = kinematics.energies(study.robot, kinematics.poses(study.robot, study.motion, np.zeros(1)))
    np.testing.assert_allclose([march.impact, run["energy"][0, 0]], kinetic[0], rtol=1e-8)


def test_elastic_legs_take_the_impact_in_their_stretch():
    # The pistons' inner ends jump; the payload, hanging on axial springs, does not: only piston mass moves.
    march, run = first_instant("lumped")
    np.testing.assert_allclose(march.impact, run["energy"][0, 0], rtol=1e-6)
    assert 0 < march.impact < 1e-2
    assert np.abs(run["v"][0, -6:]).max() < 0.01


def test_energy_balance_across_an_impact_converges_at_second_order():
    # The impact lies inside the run; its work is booked with the drives, so the balance stays to the order.
    drift = []
    for h in (1e-3, 5e-4, 2.5e-4):
        study = paper_robot(profile="linear", fidelity="lumped", step=h, output_step=2e-3)
        study = study.replace(motion=study.motion.replace(duration=0.1, amplitude=0.01))
        run = collect(prepare(override(study, duration=0.2)).chunks)
        drift.append(np.ptp(balance(run)))
        assert run["closure"].max() < 1e-13  # rounding of metres
    scale = np.ptp(run["energy"][:, 0])
    assert drift[-1] < 0.05 * scale  # undissolved axial ringing at 200 Hz after the impact
    assert drift[2] < 0.5 * drift[1] < 0.25 * drift[0] * 1.3


def test_actuator_passes_the_impact_of_its_own_laws():
    study = preset("paper-actuator")
    law = {"law": "linear", "amplitude": 0.05, "duration": 0.5}
    study = study.replace(motion=study.motion.replace(rotation=law, extension=law))
    drift = [
        np.ptp(balance(run_actuator(override(study, step=h, output_step=1e-2, duration=1.0))))
        for h in (2e-3, 1e-3, 5e-4)
    ]
    np.testing.assert_allclose(np.log2(np.array(drift[:-1]) / drift[1:]), 2.0, atol=0.15)
