"""Play as a gap in motions: against the map of signs, energy, limits, refusals, files."""

from types import SimpleNamespace

import numpy as np
import pytest
from tests.helpers.machines import SCREW, machine, study

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.mechanics.elements.drive_train import DriveTrain
from flexapod.mechanics.elements.gap import Gap, dead_zone, dead_zone_slope
from flexapod.mechanics.elements.slot import Slot
from flexapod.model import AxialSpring, Load, SineWrench, to_toml
from flexapod.model.leg.joint import Joint

pytestmark = pytest.mark.consistency

PLAY = {"base_joint": Joint(play=10e-6)}


def loose(damping, *, period=1.0, backlash=10e-6, joints=PLAY, **simulation):
    """A machine at rest whose tool is pulled up and pushed down by 2.5 times its weight; 20 um of play a leg."""
    nut = SCREW.nut.replace(backlash=backlash, damping=damping)
    robot = machine(drive=SCREW.replace(nut=nut), damping=0.02 if damping else 0.0, **joints)
    found = study(robot, fidelity="lumped", play="gap", **simulation)
    load = Load(wrench=SineWrench(amplitude=[0, 0, 25e3, 0, 0, 0], frequency=1 / period))
    return found.replace(motion=found.motion.replace(amplitude=1e-9), load=load)


def static(found):
    return found.replace(simulation=found.simulation.replace(play="static"))


def test_the_gap_is_a_dead_band_with_rounded_edges():
    half = 5e-6
    x = np.linspace(-50e-6, 50e-6, 2001)
    sharp = np.sign(x) * np.maximum(np.abs(x) - half, 0.0)
    assert np.abs(dead_zone(x, half) - sharp).max() < 0.11 * half  # half of the width of the rounding
    assert dead_zone(1e-3, half) == pytest.approx(1e-3 - half, abs=1e-6 * half)
    np.testing.assert_allclose(np.gradient(dead_zone(x, half), x)[1:-1], dead_zone_slope(x, half)[1:-1], atol=2e-3)
    np.testing.assert_array_equal(dead_zone(x, 0.0), x)


def test_a_rotor_that_is_free_in_its_gap_loses_nothing():
    # Between the edges neither spring nor damper acts; past them both do. The edges are rounded over a fifth of the
    # half play w: at the middle a slope of 1 - 1 / sqrt(1.04) = 0.02 is left, at 4 w 1 - (1 / 450 - 1 / 1250) = 0.999.
    w, damping, stiffness, rate = 10e-6, 2e5, 3e8, 0.04
    p = SimpleNamespace(series_home=0.7, series_softening=[0.1, 0.0], series_stiffness=stiffness,
                        series_damping=damping, half_play=w, rotor_mass=0.0)  # fmt: skip
    there = np.array([0.0, -0.3, 0.3, 4.0, -4.0]) * w
    found = [
        DriveTrain.energy_along(
            SimpleNamespace(
                p=p, q=SimpleNamespace(r=0.7 + x, l=0.7), v=SimpleNamespace(r=rate, l=0.0), elements=[Slot(Gap)]
            )
        )
        for x in there
    ]
    lost = np.array([one.dissipation for one in found]) / (0.5 * damping * rate**2)
    stored = np.array([one.strain for one in found]) / (0.5 * stiffness * w**2)
    assert (lost[:3] < 1e-3).all() and (stored[:3] < 1e-3).all()
    np.testing.assert_allclose(lost[3:], 1.0, atol=5e-3)
    np.testing.assert_allclose(stored[3:], 9.0, rtol=1e-2)


def test_a_slow_motion_lies_where_the_signs_of_the_forces_say():
    found = loose(1.5e6, duration=1.0, step=5e-4)
    gap, without = fx.simulate(found), fx.simulate(static(found))
    moved = (gap.tool_deviation - without.tool_deviation).sel(axis="z").values
    signs = fx.play(found)
    said = signs.play_error.sel(component="z").interp(time=gap.time).values
    at_rest, pulled, pushed = (gap.time.values.searchsorted(t) for t in (0.0, 0.3, 0.8))
    assert said[pulled] > 5e-6 > -5e-6 > said[pushed]
    for k in (at_rest, pulled, pushed):
        # The edges are rounded: by 2 % of the play over the square of the spring's share in the displacement.
        assert moved[k] == pytest.approx(said[k], abs=0.03 * abs(said[k]))
    # What the drives hold is their command; the play is in the cause "drive".
    cause = gap.deviation_by_cause.sel(cause="drive").sum("leg").sel(axis="z").values
    assert cause[pushed] == pytest.approx(said[pushed], abs=0.03 * abs(said[pushed]))


def test_a_budget_counts_play_once():
    # The simulation goes through the gap; the budget's row of play is its bound, and what is dynamic is beside it.
    found = loose(1.5e6, duration=0.3, step=5e-4)
    gap, without = fx.budget(found, motion=True), fx.budget(static(found), motion=True)
    names = ["base_joint play", "drive play"]
    bound = gap.budget.sel(part=names, kind="hysteretic", component="z")
    np.testing.assert_array_equal(bound, without.budget.sel(part=names, kind="hysteretic", component="z"))
    assert bound.sum() > 9e-6
    for kind in ("dynamic_peak", "dynamic_rms"):  # the way through the gap excites a little vibration
        one, other = (x.budget_total.sel(kind=kind, component="z") for x in (gap, without))
        assert float(abs(one - other)) < 0.1 * float(bound.sum())
        assert float(abs(gap.budget_residual.sel(kind=kind, component="z"))) < 1e-3 * float(abs(one))


def test_energy_is_kept_to_the_order_of_the_method():
    drifts = []
    for step in (2e-4, 1e-4):
        x = fx.simulate(loose(0.0, period=0.1, duration=0.06, step=step))
        balance = x.energy_kinetic + x.energy_potential + x.energy_strain + x.energy_dissipated
        drifts.append(np.ptp((balance - x.work_drive - x.work_external).values))
    assert drifts[0] / drifts[1] == pytest.approx(4.0, rel=0.1)  # second order through the gap
    assert drifts[1] < 2e-4 * np.ptp(x.work_external.values)


def test_without_play_a_gap_is_none():
    found = loose(1e5, backlash=None, joints={}, duration=0.02, step=5e-4)
    np.testing.assert_array_equal(fx.simulate(found).tool_position, fx.simulate(static(found)).tool_position)
    # Poses at rest leave play to its bounds, whatever motions do.
    here = loose(1e5, duration=0.02)
    for compute, name in ((fx.modes, "frequency"), (fx.budget, "worst")):
        np.testing.assert_array_equal(compute(here)[name], compute(static(here))[name])


def test_a_gap_needs_springs_before_the_piston():
    found = study(machine(**PLAY), play="gap")
    with pytest.raises(InputError, match="leg 1 has none") as caught:
        fx.simulate(found)
    assert caught.value.key == "simulation.play"
    springs = (AxialSpring(name="bracket", stiffness=5e8, damping=1e5),)
    whole = study(machine(**PLAY, springs=springs), play="gap", duration=0.01, fidelity="lumped", step=5e-4)
    assert fx.simulate(whole).attrs["steps"] > 0
    assert fx.loads(to_toml(whole)).simulation.play == "gap"


def test_drives_stand_where_their_rotors_are():
    # The play lies between rotor and stroke: held rotors stay at their command, as without play.
    data = fx.simulate(loose(1.5e6, duration=0.05, step=5e-4))
    np.testing.assert_allclose(data.drive_position, data.drive_command, atol=1e-9)
