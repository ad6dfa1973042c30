"""Screws against catalogues: worked examples of THK, limits of the laws, remarks on what is exceeded, refusals."""

import numpy as np
import pytest
from tests.helpers.texts import replaced

from flexapod import model
from flexapod.analysis.checks.screws import (
    back_efficiency,
    buckling_thrust,
    critical_speed,
    drag_torque,
    half_loads,
    mean_load,
    motor_torque,
    turns_of_life,
)
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.description.screw_description import back_driving, describe_screw, describe_screws, screw_remarks
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.errors import InputError
from flexapod.model import MATERIALS, Bearing, Nut, ScrewDrive
from flexapod.output.text import html
from flexapod.output.text.check import check_items
from flexapod.output.text.description import back_words
from flexapod.output.text.study import study_items
from flexapod.output.text.terminal import print_items

pytestmark = pytest.mark.unit

STEEL = MATERIALS["steel"].replace(E=206e9, density=7850.0)  # of THK's catalogue
NUT = 'rigidity = "1130 N/um", preload = "1540 N", dynamic_load = "30.8 kN"'
HEXAPOD = model.preset_text("machine-hexapod")


def screw(**fields):
    given = {"lead": 0.01, "root_diameter": 0.0175, "length": 1.1, "material": STEEL, "nut": Nut(stiffness=1e9)}
    return ScrewDrive(**{**given, "bearing": Bearing(position=0.0, stiffness=1e9), **fields})


def changed(*pairs):
    """The path of the machine hexapod, changed, and its screws."""
    path = RigidPath(model.loads(replaced(HEXAPOD, *pairs)))
    return path, describe_screws(path)


def remarks(*pairs):
    path, screws = changed(*pairs)
    return screw_remarks(path.robot, screws)


def refused(*pairs):
    with pytest.raises(InputError) as caught:
        changed(*pairs)
    return caught.value


class TestBuckling:
    def test_example_of_the_catalogue(self):
        # THK: root 17.5 mm, 1100 mm, fixed-fixed: 15500 N with the factor 0.5. Its coefficient 20 is pi^3 E / 32 =
        # 199,600 N/mm^2 rounded (0.2 %), its result rounded (0.02 %).
        np.testing.assert_allclose(buckling_thrust(screw(mounting="fixed-fixed"), 0.5), 15500, rtol=3e-3)

    @pytest.mark.parametrize("mounting, coefficient, rounding", [
        ("fixed-free", 20 / 16, 0.005), ("fixed-supported", 10, 0.05), ("fixed-fixed", 20, 0.1),
    ])  # fmt: skip
    def test_coefficients_of_the_catalogue(self, mounting, coefficient, rounding):
        # THK A-694: coefficient times 1e4 d^4 / l^2, in N and mm; 20 / 16 is printed as 1.3, pi^3 E / 32 as 20
        found = buckling_thrust(screw(mounting=mounting), 1.1) * 1100**2 / 17.5**4 / 1e4
        assert abs(found - coefficient) < rounding

    def test_the_free_shaft_counts_to_the_nut(self):
        free = buckling_thrust(screw(), np.array([0.0, 0.2, 0.4]))
        assert np.isinf(free[0]) and free[1] == pytest.approx(4 * free[2])


@pytest.mark.parametrize(
    "mounting, coefficient", [("fixed-free", 3.4), ("fixed-supported", 15.1), ("fixed-fixed", 21.9)]
)
def test_critical_speeds_of_the_catalogue(mounting, coefficient):
    # THK A-696: coefficient times 1e7 d / l^2 [rpm], mm; coefficients are printed to 0.1
    found = critical_speed(screw(mounting=mounting)) * 30 / np.pi
    assert abs(found * 1100**2 / 17.5 / 1e7 - coefficient) < 0.06


def test_drag_of_a_preload_in_the_catalogue():
    # THK A-689: 3000 N, lead 10 mm on a circle of balls of 41.75 mm: 865 N mm, printed to 1
    drive = screw(root_diameter=0.04175, nut=Nut(rigidity=1e9, preload=3000.0, dynamic_load=60e3))
    np.testing.assert_allclose(drag_torque(drive, np.array([3.0, 0.0, -2.0])), [0.865, 0.0, -0.865], atol=1e-3)


class TestTorque:
    def test_work_both_ways_is_lost_alike(self):
        drive = screw(efficiency=0.8)
        out, in_, rest = motor_torque(drive, np.array([1e3, 1e3, 1e3]), np.array([0.1, -0.1, 0.0]), np.zeros(3))
        ideal = 1e3 * 0.01 / (2 * np.pi)
        np.testing.assert_allclose([out, in_, rest], ideal * np.array([1.25, 0.75, 1.0]), rtol=1e-14)
        np.testing.assert_allclose(out - ideal, ideal - in_, rtol=1e-13)

    def test_friction_grows_with_the_speed_and_is_largest_before_it_slides(self):
        # By hand: 0.5 N m that slide, 0.8 at least speed, 20 rad/s; e^-1 of the excess there, and 0.002 N m s/rad
        rubs = model.ScrewFriction(torque=0.5, viscous=0.002, stribeck={"moment": 0.8, "rate": 20.0})
        drive = screw(friction=rubs, rotor=model.Rotor(ratio=2.0))
        speed = np.array([20.0, -20.0, 0.0, 400.0])
        torque = motor_torque(drive, np.zeros(4), speed * drive.per_turn, np.zeros(4))
        at_20 = 0.5 + 0.3 / np.e + 0.04
        np.testing.assert_allclose(torque, np.array([at_20, -at_20, 0.0, 1.3]) / 2, rtol=1e-12)

    def test_half_is_where_a_screw_holds_itself(self):
        assert back_efficiency(screw(efficiency=0.5)) == 0
        assert back_efficiency(screw(efficiency=1.0)) == 1

    def test_a_reduction_takes_torque_and_adds_inertia(self):
        # Without thrust and drag: (J_S + i^2 J_M) angular acceleration / i
        drive = screw(rotor=model.Rotor(inertia=1e-3, ratio=3.0))
        torque = motor_torque(drive, np.zeros(1), np.zeros(1), np.array([2.0]))
        shaft = 7850 * 1.1 * np.pi / 32 * 0.0175**4
        np.testing.assert_allclose(torque, (shaft + 9e-3) * 2.0 * 2 * np.pi / 0.01 / 3, rtol=1e-12)


class TestLife:
    def test_rating_is_a_million_turns(self):
        loads = half_loads(Nut(stiffness=1e9), np.full(3, 5e3))
        np.testing.assert_allclose(loads, [[5e3] * 3, [0] * 3])
        assert turns_of_life(5e3, mean_load(loads, np.ones(3))) == pytest.approx(1e6)

    def test_hours_of_the_catalogue(self):
        # By hand: (30 kN / 5 kN)^3 = 216 million turns; 6 m/min on a lead of 10 mm are 600 rpm: 216e6 / (60 x 600) =
        # 6000 h. At rest for half of the time: twice as many.
        leg = model.loads(HEXAPOD).robot.legs[0]
        drive = leg.replace(drive=leg.drive.replace(nut=Nut(stiffness=1e9, dynamic_load=30e3), friction=None))
        t = np.linspace(0.0, 2.0, 2001)
        for rate, hours in ((np.full(2001, 0.1), 6000.0), (np.where(t < 1, 0.1, 0.0), 12000.0)):
            found = describe_screw(0, drive, t, leg.begins + 0.2 + 0.0 * t, np.full(2001, 5e3), rate, np.zeros(2001))
            assert found.life == pytest.approx(216e6)
            assert found.hours == pytest.approx(hours, rel=1e-3)  # one interval of 1000 falls

    def test_preload_alone_wears_both_sides(self):
        nut = Nut(rigidity=1e9, preload=1e3, dynamic_load=20e3)
        loads = half_loads(nut, np.array([0.0, 2**1.5 * 1e3, 5e3, -5e3]))
        np.testing.assert_allclose(loads, [[1e3, 2**1.5 * 1e3, 5e3, 0], [1e3, 0, 0, 5e3]], atol=1e-9)
        both = turns_of_life(20e3, np.array([1e3, 1e3]))
        np.testing.assert_allclose(both, 8e9 * 2**-0.9, rtol=1e-12)

    def test_the_difference_of_the_sides_is_the_thrust(self):
        # (T15.46) is a line for the approach; the exact pair keeps F_+ - F_- = F: they differ by less than 6 %
        thrust = np.linspace(0.1, 2.8, 28)
        plus, minus = half_loads(Nut(rigidity=1e9, preload=1.0, dynamic_load=20.0), thrust)
        np.testing.assert_allclose(plus - minus, thrust, rtol=0.0607)

    def test_mean_is_weighted_by_turns(self):
        assert mean_load(np.array([[1.0, 2.0]]), np.array([3.0, -1.0]))[0] == pytest.approx((11 / 4) ** (1 / 3))


class TestCheck:
    def test_the_machine_hexapod_is_within_its_catalogue(self):
        assert remarks() == []

    def test_numbers_by_hand(self, capsys):
        study = model.preset("machine-hexapod")
        found = describe(study)
        print_items(check_items(found))
        assert "Screws, largest values on the path" in capsys.readouterr().out
        report = html.parts(study_items(study, found)).replace("\xa0", " ")
        assert "Screws, largest values on the path" in report and "screw of 28.74 mm with a lead of 10 mm" in report
        worst = max(found.screws, key=lambda leg: leg.thrust.value)
        assert worst.thrust.value == pytest.approx(max(leg.force_max.value for leg in found.legs))
        assert worst.back_torque == pytest.approx(worst.thrust.value * 0.01 / (2 * np.pi) * (2 - 1 / 0.9))
        assert "turns the motor of leg 1 back" in back_words(found.back) and "4 N m" in back_words(found.back)

    @pytest.mark.parametrize("change, words", [
        (('speed = "3000 rpm"', 'speed = "500 rpm"'), "the motor's speed reaches 748 rpm"),
        (('torque = "10 N m", rms_torque = "3.5 N m"', 'torque = "1 N m"'), "above the limit of 1 N m"),
        (('rms_torque = "3.5 N m"', 'rms_torque = "0.5 N m"'), "(root mean square), above the limit of 0.5 N m"),
        (('brake = { torque = "4 N m" }', 'brake = { torque = "0.5 N m" }'), "the brake holds 500 mN m"),
        (('limits = { speed', 'limits = { force = "700 N", speed'), "above the limit of 700 N"),
        (('root_diameter = "28.744 mm"', 'root_diameter = "5 mm"'), "times the"),
        (('lead = "10 mm"', 'lead = "1 mm"'), "times as fast as its shaft may"),
    ])  # fmt: skip
    def test_what_is_exceeded_is_said_with_leg_and_numbers(self, change, words):
        found = [remark for remark in remarks(change) if words in remark]
        assert len(found) == 1 and found[0].startswith("leg ")

    def test_static_load_is_compared_with_the_pushed_half(self):
        found = remarks((NUT, 'stiffness = "717 N/um", dynamic_load = "400 N", static_load = "500 N"'))
        assert "times its static load rating" in found[0] and "also legs" in found[0]
        assert changed((NUT, 'stiffness = "717 N/um"'))[1][0].hours is None

    def test_a_screw_that_holds_itself(self):
        assert "stay where they are" in back_words(back_driving(*changed(("efficiency = 0.9 ", "efficiency = 0.4 "))))

    def test_no_brake(self):
        assert "no brake is given" in back_words(back_driving(*changed(('brake = { torque = "4 N m" }', ""))))

    @pytest.mark.parametrize("nut", ['stiffness = "700 N/um", dynamic_load = "30 kN"', 'stiffness = "700 N/um"'])
    def test_at_rest_without_gravity_nothing_wears(self, nut):
        rest = (
            ("-9.81]", "0]"),
            ('surge = "80 mm", pitch = "6 deg"', "surge = 0"),
            (NUT, f'{nut}, static_load = "90 kN"'),
        )
        path, screws = changed(*rest)
        assert screws[0].hours is screws[0].life is screws[0].safety is None
        assert screw_remarks(path.robot, screws) == []
        assert "no leg bears a thrust" in back_words(back_driving(path, screws))


class TestRefusals:
    def test_ratings_that_changed_places(self):
        error = refused(('dynamic_load = "30.8 kN"', 'dynamic_load = "30.8 kN", static_load = "20 kN"'))
        assert error.key == "leg.drive.nut.static_load" and "at least 30800 N" in error.allowed and error.next_step

    def test_rms_above_peak(self):
        error = refused(('rms_torque = "3.5 N m"', 'rms_torque = "12 N m"'))
        assert error.key == "leg.drive.limits.rms_torque" and "at most torque" in error.allowed and error.next_step

    @pytest.mark.parametrize("value", ["0", "-3", '"3 m"'])
    def test_brake_and_limits_are_torques_and_above_zero(self, value):
        assert refused(('torque = "4 N m"', f"torque = {value}")).key == "leg.drive.brake.torque"
        assert refused(('torque = "10 N m", rms', f"torque = {value}, rms")).key == "leg.drive.limits.torque"

    def test_a_rigidity_needs_preload_and_rating(self):
        assert refused(('preload = "1540 N", dynamic', "dynamic")).key == "leg.drive.nut.preload"
        error = refused(('rigidity = "1130 N/um"', 'rigidity = "1130 N/um", stiffness = "700 N/um"'))
        assert error.key == "leg.drive.nut.rigidity"


class TestNutOnTheScrew:
    @pytest.mark.parametrize(("change", "key", "words"), [
        (('length = "400 mm"            #', 'length = "250 mm" #'), "leg.drive.length", "ends before the nut of leg"),
        (('position = "60 mm"', 'position = "300 mm"'), "leg.drive.bearing.position", "behind the bearing at t = "),
    ])  # fmt: skip
    def test_a_nut_that_leaves_its_screw_is_refused_on_the_path(self, change, key, words):
        study = model.loads(HEXAPOD.replace(*change))  # a file may name it: the path decides
        with pytest.raises(InputError) as caught:
            describe(study)
        assert caught.value.key == key and words in str(caught.value) and "between 0 and the screw" in str(caught.value)

    def test_a_preload_above_the_catalogue_is_refused_with_its_limit(self):
        error = refused(('preload = "1540 N"', 'preload = "4 kN"'))
        assert error.key == "leg.drive.nut.preload" and "3080 N" in str(error)

    def test_a_thrust_that_unloads_half_a_nut_is_remarked(self):
        path, _ = changed(('preload = "1540 N"', 'preload = "100 N"'))
        found = describe(path.study)
        assert any("2.83 times the preload of the nut" in remark for remark in found.remarks)
