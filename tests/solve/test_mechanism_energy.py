"""Energy and closures of robots of every kind in motion."""

import numpy as np
import pytest
from tests.helpers.moving import KINDS, SOFT, moving
from tests.helpers.runs import balance, run_robot, with_legs

from flexapod.model import override
from flexapod.model.leg.joint import Joint
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.conservation

#: Stiffness of a flexure in the axes of its leg [N/m, N, N m/rad].
SIX = np.diag([1.3e7, 1.3e7, 9.4e7, 150.0, 150.0, 200.0])


@pytest.mark.parametrize("kind", KINDS)
def test_the_balance_closes_at_second_order_and_the_closures_at_rounding(kind):
    # One shape a plane and soft drives: 40 and 100 Hz, which these steps resolve. A leg welded at both ends needs the
    # second shape to be able to move at all; its 500 Hz are resolved worse.
    modes, drift = (2, []) if kind == "6-FPF" else (1, [])
    for h in (5e-4, 2.5e-4):
        run = run_robot(moving(kind, SOFT, axial_modes=0, modes=modes, step=h))
        drift.append(np.ptp(balance(run)))
        assert run["closure"].max() < 1e-13  # rounding of metres, of turns times L_c
    assert drift[1] < 2e-4 * np.ptp(run["sums"][:, 1])
    assert np.log2(drift[0] / drift[1]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("joint", [Joint(bending=150.0, torsion=200.0), Joint(stiffness=SIX, leg_axes=True)])
def test_legs_on_flexures_close_the_balance_as_others_do(joint):
    # Springs on angles, and places that give way without any mass of their own.
    study, drift = moving("6-FPF", SOFT, axial_modes=0, modes=2), []
    for h in (5e-4, 2.5e-4):
        study = override(with_legs(study, base_joint=joint, platform_joint=joint), step=h)
        run = run_robot(study)
        drift.append(np.ptp(balance(run)))
        assert run["closure"].max() < 1e-13
    assert np.log2(drift[0] / drift[1]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("kind", ["3-RPS", "6-PUS", "3-UPS+UP", "3-PUU"])
def test_what_joints_hold_does_no_work(kind):
    """The whole work of the drives is that of their thrusts: hinges, struts and welds have forces and no power."""
    study, h = moving(kind, step=2.5e-4, output_step=2.5e-4), 2.5e-4
    system, run = prepare(study).system, run_robot(study)
    rates = run["v"][:, : system.legs * system.n].reshape(-1, system.legs, system.n)[..., system.ports]
    still = system.held[:, system.ports] & (np.abs(rates).max(axis=0) == 0)
    assert (np.abs(run["drive"]).max(axis=0)[still] > 1.0).any()  # N, N m
    power = (run["drive"] * rates).sum(axis=(1, 2))
    work = np.concatenate([[0.0], np.cumsum(0.5 * h * (power[1:] + power[:-1]))])
    # What each step adds is computed from forces that have met their tolerance, 1e-10 of the largest.
    np.testing.assert_allclose(run["sums"][:, 1], work, atol=1e-9 * np.abs(work).max())


def test_a_fixed_platform_is_held_by_its_reaction():
    """One leg between two fixed points: what it does to the platform is what holds the platform, its stroke stands."""
    run = run_robot(moving("1-UPS", modes=3, step=1e-4, output_step=1e-3, duration=0.05))
    assert np.ptp(run["pose"], axis=0).max() == 0
    np.testing.assert_allclose(run["reaction"][:, :3], -run["lam"][:, 0], rtol=0, atol=1e-9)
    assert np.abs(run["reaction"][:, 3:]).max() < 1e-12  # its joint is at the centre of mass


@pytest.mark.parametrize("chain", ["FPF"])
def test_legs_on_flexures_that_give_way_along_and_about_all_axes(chain):
    soft = Joint(stiffness=np.diag([1.3e7, 1.3e7, 9.4e7, 15.0, 15.0, 20.0]), leg_axes=True)
    ends = [soft if letter == "F" else Joint() for letter in (chain[0], chain[-1])]
    study = moving("6-UPS", step=2.5e-4, output_step=5e-3)
    legs = [leg.replace(chain=chain, base_joint=ends[0], platform_joint=ends[1]) for leg in study.robot.legs]
    study = study.replace(robot=study.robot.replace(type=f"6-{chain}", legs=tuple(legs)))
    run = run_robot(study.replace(initial=study.initial.replace(start="equilibrium")))
    assert run["closure"].max() < 1e-13
    # Stretch and flexures ring with some kHz after the corner of the law's start: a thousandth of the work would show.
    assert np.ptp(balance(run)) < 2e-4 * np.ptp(run["sums"][:, 1])
    held = np.abs(run["drive"]).max(axis=(0, 1))
    assert held[0] > 1e3  # N: the weight is on the strokes
