"""Paths far outside of all reach: refused at their first instants, and where a length is not what was meant."""

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.samples import sample_text

import flexapod as fx
from flexapod.kinematics import closures
from flexapod.model import AxisMotion

pytestmark = pytest.mark.consistency


@pytest.fixture
def newtons(monkeypatch):
    """How many poses Newton's method has been asked for: the cost, whatever the machine."""
    asked, one = [], closures._newton

    def counted(limbs, task, q, *rest):
        asked.append(len(q))
        return one(limbs, task, q, *rest)

    monkeypatch.setattr(closures, "_newton", counted)
    return asked


def sample(name, old="", new=""):
    text = sample_text(name)
    assert old in text
    return fx.loads(text.replace(old, new))


FAR = {
    "delta": ('surge = "60 mm"', "surge = 660"),
    "planar": ('duration = "0.1 s"', 'duration = "0.1 s"\npivot = [1e6, 0]'),
}


@pytest.mark.parametrize("call", [fx.simulate, fx.inverse_kinematics, fx.budget], ids=["run", "kinematics", "budget"])
@pytest.mark.parametrize("name", FAR)
def test_a_length_a_thousand_times_the_robots_is_named(name, call, newtons):
    """Each was followed in strides of a third of a leg, at 2001 instants and more: minutes."""
    more = {"motion": True} if call is fx.budget else {}
    with pytest.raises(fx.InputError, match=r"leads the platform .* m away from home at t = .* legs are 0.[24] m long"):
        call(sample(name, *FAR[name]), **more)
    assert sum(newtons) < 100  # those of home


@pytest.mark.parametrize("surge", [6.6, 150.0])
def test_a_path_is_refused_at_its_first_instants_out_of_reach(surge, newtons):
    # Struts of 0.4 m on upright rails at 0.25 m, joints of the platform at 0.05 m: its legs reach 0.2 to 0.6 m aside,
    # whatever their carriages do. The profile says when that is: the first look has 33 instants up to two legs.
    study = sample("delta", 'surge = "60 mm"', f"surge = {surge}")
    with pytest.raises(fx.InputError, match=r"does not reach its platform joint") as refused:
        fx.simulate(study)
    t = float(refused.value.what.split("t = ")[1].split(" s")[0])
    tau = t / 0.2
    assert 0.15 < surge * tau**3 * (10 - 15 * tau + 6 * tau**2) < 0.8
    assert sum(newtons) < 3000  # 33 instants, six strides


def test_strokes_are_looked_at_as_well(newtons):
    motion = AxisMotion(type="heave", amplitude=150.0, duration=1.0)
    with pytest.raises(fx.InputError, match="longer than its stroke allows"):
        fx.simulate(sample("tripod").replace(motion=motion))
    assert sum(newtons) < 3000


def test_poses_far_away_are_out_of_reach(newtons):
    study = sample("delta")
    many = fx.modes(study, {"surge": np.array([0.0, 0.02, 40.0, 4e4])})
    flags = many.reason.attrs["flag_meanings"].split()
    assert [flags[int(code)] for code in many.reason] == ["reached", "reached", "out_of_reach", "out_of_reach"]
    with pytest.raises(fx.InputError, match="does not reach"):
        fx.modes(study, {"surge": 660.0})
    assert sum(newtons) < 1000


@pytest.mark.parametrize("name", ["3-RPS", "3-PUU", "6-PUS", "3-UPS+UP"])
def test_poses_within_reach_are_those_beside_far_ones(name):
    """What a far pose asks for changes nothing of the near ones."""
    robot = ROBOTS[name]()
    alone = fx.modes(robot, {"heave": np.array([0.0, 0.03])}, fidelity="lumped").frequency.values
    beside = fx.modes(robot, {"heave": np.array([0.0, 0.03, 50.0])}, fidelity="lumped").frequency.values[:2]
    np.testing.assert_allclose(beside[:, : alone.shape[1]], alone, rtol=1e-9)


def test_a_leg_that_is_held_at_both_ends_has_to_stretch():
    """It ended in "SVD did not converge"."""
    study = sample("strut", "[leg]", "[leg]\naxial_modes = 0")
    with pytest.raises(fx.InputError, match="leg 1 is held at both ends and cannot stretch") as refused:
        fx.modes(study)
    assert refused.value.key == "leg.axial_modes"
    with pytest.raises(fx.InputError, match="cannot stretch"):
        fx.simulate(sample("strut", "[leg]", "[leg]\naxial_modes = 0").replace(initial=fx.model.Initial()))
    with pytest.raises(fx.ComputationError, match="do not fit"):  # let go straight it would have to get longer
        fx.simulate(study, duration=0.01)
    servo = '[leg]\naxial_modes = 0\ndrive = { type = "servo", stiffness = 1e8, damping = 1e3 }'
    found = fx.modes(sample("strut", "[leg]", servo))
    # A servo as stiff as the piston: the bending is that of one that stretches.
    np.testing.assert_allclose(found.frequency[:2], fx.modes(sample("strut")).frequency[:2], rtol=1e-3)
