"""Words and units of robots whose legs are not pistons: struts, places and angles of carriages, torques."""

import pytest
import xarray as xr
from tests.helpers.mechanisms import ROBOTS

import flexapod as fx
from flexapod.analysis.description.robot_description import Singularity, describe_legs
from flexapod.analysis.results.cause_labels import cause_labels
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.design.sweeps.outputs import _records, _robot_scalars
from flexapod.model import AxisMotion, Study
from flexapod.output.text import html
from flexapod.output.text.study import _path

pytestmark = pytest.mark.unit


def study(name):
    motion = AxisMotion(type="heave", amplitude=0.01, duration=0.1)
    return Study(robot=ROBOTS[name](), motion=motion, simulation=fx.preset("paper-robot").simulation)


def table(name):
    """Head and first row of the report's table of legs."""

    class Found:
        legs, screws, hydraulics = describe_legs(RigidPath(study(name))), (), ()
        singularity = Singularity(
            home_smallest_singular_value=1, home_condition=1, smallest_singular_value=1, condition=1, time=0
        )

    return html.parts(_path(Found)).replace("\xa0", " ")


def test_the_report_shows_what_drives_move():
    slider, crank, piston, passive = (table(name) for name in ("6-PUS", "6-RUS", "6-UPS", "3-UPS+UP"))
    assert "Position" in slider and "Travel left" in slider and "Drive force" in slider and " mm" in slider
    assert "Angle" in crank and "Turn left" in crank and "Drive torque" in crank and " deg" in crank and "N m" in crank
    assert "Length" in piston and "Stroke left" in piston
    assert "none: passive" in passive


def test_sweeps_give_torques_of_cranks_their_unit():
    scalars = _robot_scalars(study("6-RUS"))
    assert scalars["actuator_force_peak"].units == scalars["actuator_force_peak_by_leg"].units == "N m"
    assert _robot_scalars(study("6-PUS"))["actuator_force_peak"].units == "N"
    screws = _robot_scalars(fx.preset("machine-hexapod"))  # the thrust on the piston, not the motor's torque
    assert screws["actuator_force_peak"].units == "N"
    records = _records(study("6-RUS"))
    assert (records["drive_position"].units, records["drive_force"].units) == ("rad", "N m")


def test_what_bends_is_a_piston_or_a_strut():
    assert cause_labels(xr.Dataset({"leg_length": 0.0}))["bending"] == "bending of the pistons"
    assert cause_labels(xr.Dataset())["axial-strain"] == "stretch of the struts"
