"""The model as Python objects: frozen, compared by content, validated again on change."""

import copy
import pickle

import numpy as np
import pytest

from flexapod import model
from flexapod.common.errors import ComputationError, InputError

pytestmark = pytest.mark.unit

STUDIES = {name: model.preset(name) for name in model.PRESETS}


@pytest.fixture(params=STUDIES)
def study(request):
    return STUDIES[request.param]


def test_nothing_can_be_changed(study):
    with pytest.raises(Exception, match="frozen"):
        study.simulation.modes = 5
    robot = STUDIES["paper-robot"].robot
    for array in (robot.base_joints, robot.gravity, robot.payload.inertia, robot.payload.com):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_arrays_given_are_copied():
    com = np.zeros(3)
    payload = model.Payload(mass=1.0, inertia=np.ones(3), com=com)
    com[0] = 7.0
    assert payload.com[0] == 0.0


@pytest.mark.parametrize("again", [copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s)), lambda s: s.replace()])
def test_copies_are_equal_and_hash_alike(study, again):
    other = again(study)
    assert other == study
    assert hash(other) == hash(study)
    robot = getattr(other, "robot", None)
    assert robot is None or not robot.base_joints.flags.writeable


def test_different_content_is_different():
    robot = STUDIES["paper-robot"].robot
    moved = np.array(robot.base_joints)
    moved[5, 2] += 1e-12
    assert robot.replace(base_joints=moved) != robot
    assert STUDIES["paper-robot"] != STUDIES["paper-robot-radii"]


def test_replace_validates_again():
    robot = STUDIES["paper-robot"].robot
    assert robot.replace(home_height=1.0).home_lengths[0] > robot.home_lengths[0]
    with pytest.raises(InputError, match="no piston is left outside"):
        robot.replace(home_height=0.2)
    with pytest.raises(InputError, match=r"unknown key.*Did you mean 'home_height'"):
        robot.replace(home_heigth=1.0)


def test_values_that_only_python_can_give():
    with pytest.raises(InputError, match="finite"):
        model.Payload(mass=1.0, inertia=np.ones(3), com=[0, np.nan, 0])
    with pytest.raises(InputError, match="is missing"):
        model.Payload(inertia=np.ones(3), com=np.zeros(3))
    with pytest.raises(InputError, match="coincide"):
        robot = STUDIES["paper-robot"].robot
        robot.replace(home_height=0.0, base_joints=robot.platform_joints)
    with pytest.raises(InputError, match="no direction"):
        STUDIES["paper-robot"].robot.legs[0].replace(u_axis=[0, 0, 0])
    with pytest.raises(InputError, match=r"does not increase at row 3"):
        model.CsvMotion(time=[0, 1, 1], pose=np.zeros((3, 6)))


def test_flat_plate_and_needle_are_bodies():
    # The triangle inequality holds with equality for a plate: round-off must not refuse it.
    model.Payload(mass=1.0, inertia=[0.1, 0.2, 0.1 + 0.2], com=[0, 0, 0])
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    tensor = turn @ np.diag([0.1, 0.2, 0.3]) @ turn.T
    model.Payload(mass=1.0, inertia=(tensor + tensor.T) / 2, com=[0, 0, 0])


def test_waypoints_in_order():
    point = model.Waypoint
    with pytest.raises(InputError, match=r"points\[3\].time"):
        model.WaypointMotion(points=(point(time=0.0), point(time=2.0), point(time=1.0)))
    with pytest.raises(InputError, match="no point after"):
        model.WaypointMotion(points=(point(time=0.0),))


class TestOverride:
    study = STUDIES["paper-robot"]

    def test_nothing_given_changes_nothing(self):
        assert model.override(self.study) == self.study

    def test_step_replaces_tolerance_and_back(self):
        fixed = model.override(self.study, step=5e-4)
        assert (fixed.simulation.step, fixed.simulation.tolerance) == (5e-4, None)
        back = model.override(fixed, tolerance=1e-3)
        assert (back.simulation.step, back.simulation.tolerance) == (None, 1e-3)
        with pytest.raises(InputError, match="not both"):
            model.override(self.study, step=5e-4, tolerance=1e-3)

    @pytest.mark.parametrize("fidelity", ["rigid", "lumped"])
    def test_presets_switch_fidelity(self, fidelity):
        simulation = model.override(self.study, fidelity=fidelity).simulation
        assert (simulation.fidelity, simulation.lateral_shapes) == (fidelity, 0)
        for unused in ({"modes": 3}, {"basis": "clamped-free"}, {"axial_modes": 1}):
            with pytest.raises(InputError, match="has no effect"):
                model.override(self.study, fidelity=fidelity, **unused)

    def test_legs_and_time(self):
        other = model.override(self.study, modes=6, basis="clamped-free", axial_modes=0, duration=0.5, output_step=1e-2)
        assert {leg.axial_modes for leg in other.robot.legs} == {0}
        assert (other.simulation.lateral_shapes, other.duration) == (6, 0.5)
        assert other.simulation.output_step == 1e-2

    def test_actuator(self):
        actuator = STUDIES["paper-actuator"]
        assert model.override(actuator, basis="tip-mass", modes=6).simulation.basis == "tip-mass"
        with pytest.raises(InputError, match="does not stretch"):
            model.override(actuator, axial_modes=1)
        with pytest.raises(InputError, match="single actuator"):
            model.override(self.study, basis="tip-mass")


def test_default_tolerance():
    assert model.Simulation().tolerance == model.DEFAULT_TOLERANCE
    assert model.Simulation(step=1e-3).tolerance is None


def test_errors_survive_a_process_boundary():
    for error in (
        InputError("is odd", file="a.toml", key="x.y", value=3, allowed="even", next_step="Double it"),
        ComputationError("The march stopped at t = 1 s", next_step="Take a smaller step"),
    ):
        again = pickle.loads(pickle.dumps(error))
        assert str(again) == str(error)
        assert again.exit_code == error.exit_code
    error = InputError("is odd", file="a.toml", key="x.y", value=3, allowed="even", next_step="Double it")
    assert str(error) == "a.toml: x.y = 3: is odd. Allowed: even. Double it."
    assert error.as_dict()["allowed"] == "even"


def test_actuator_end_of_motion():
    rate, smooth = model.RateLaw, model.ProfileLaw
    still = rate(rate=0.0)
    assert model.ActuatorMotion(rotation=smooth(law="smooth", amplitude=1.0, duration=2.0)).end_time == 2.0
    assert model.ActuatorMotion(rotation=rate(rate=1.0), extension=still).end_time is None
    assert model.ActuatorMotion(rotation=still, extension=still).end_time is None
    assert model.ActuatorMotion(rotation=None, extension=still).end_time is None


@pytest.mark.parametrize(
    ("tip", "basis", "remarked"),
    [
        ("tip_mass = 1", "clamped-free", True),
        ("tip_mass = 1", "tip-load", False),
        ("tip_mass = 1\ntip_inertia = 0.1", "tip-load", False),
        ("tip_inertia = 0.1", "clamped-free", True),
        ("tip_mass = 1\ntip_inertia = 0.1", "tip-mass", False),
        ("tip_mass = 0", "clamped-free", False),
    ],
)
def test_shapes_that_ignore_the_inertia_at_the_tip_are_remarked_on(tip, basis, remarked):
    text = (
        f"[actuator]\nlength = 2\nrhoA = 1\nEI = 1\nfree_length = 1\n{tip}\n"
        f'[simulation]\nduration = 1\nbasis = "{basis}"'
    )
    assert any('"tip-mass"' in remark for remark in model.loads(text).warnings) == remarked
