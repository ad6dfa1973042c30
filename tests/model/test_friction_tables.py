"""Friction in study files: there and back, and what makes no sense is refused with its value and what is allowed."""

import numpy as np
import pytest
from tests.helpers.texts import REAL_PARTS, replaced

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.model import JointFriction, ScrewFriction, StrokeFriction, to_toml

pytestmark = pytest.mark.unit

PLACES = {
    "leg.base_joint.friction": ("base_joint = {", "base_joint = { friction = %s,"),
    "leg.platform_joint.friction": ("springs = {", "platform_joint = { friction = %s }\nsprings = {"),
    "leg.drive.friction": ('lead = "10 mm"', 'lead = "10 mm"\nfriction = %s'),
}
TABLES = {
    "leg.base_joint.friction": "{ moment = '0.3 N m', stribeck = { moment = '0.4 N m', rate = '1 deg/s' } }",
    "leg.platform_joint.friction": "{ mu = 0.08, diameter = '40 mm', viscous = 0.1, damping_time = '1 ms' }",
    "leg.drive.friction": "{ torque = '0.8 N m', presliding = '1 deg' }",
}


def of(key, text):
    """A machine with a table of friction."""
    old, new = PLACES[key]
    return fx.loads(replaced(REAL_PARTS, (old, new % text)), path="mine.toml")


@pytest.mark.parametrize("key", TABLES)
def test_round_trip(key):
    study = of(key, TABLES[key])
    assert fx.loads(to_toml(study)).robot == study.robot != fx.loads(REAL_PARTS).robot


def test_moments_by_load():
    assert JointFriction(mu=0.1, diameter=0.04).arm == pytest.approx(0.002)
    assert JointFriction(M0=0.01, f1=5e-4, diameter=0.02).arm == pytest.approx(1e-5)
    assert JointFriction(moment=0.3).numbers == (0.3, 0.0, 1e-3, 0.0, 0.0, 0.0, 0.0)
    steep = ScrewFriction(torque=0.8, stribeck={"moment": 1.0, "rate": 2.0}).numbers
    np.testing.assert_allclose(steep, (0.8, 0, 0.01, 0.25, 0.5, 0, 0))
    assert StrokeFriction(force=10.0).presliding == 1e-5


def test_friction_of_what_does_not_turn_or_slide_is_refused():
    rubs = JointFriction(moment=1.0)
    leg = fx.loads(REAL_PARTS).robot.legs[0]
    with pytest.raises(InputError, match="does not turn"):
        leg.replace(chain="UPF", platform_joint=leg.platform_joint.replace(friction=rubs))
