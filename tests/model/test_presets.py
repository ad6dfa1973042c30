"""Presets of machines that somebody builds: stiffness of their parts by hand, what they do beside ideal ones."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from tests.helpers.texts import replaced

import flexapod as fx
from flexapod import model
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.results.idealizations import soft_drives

pytestmark = pytest.mark.consistency


def shares(name):
    """Parts' shares in the compliance of leg 1 at home."""
    found = fx.parts(fx.preset(name).robot)
    give = 1 / found.part_stiffness.sel(leg=1)
    return dict(zip(give.part.values.tolist(), (give / give.sum()).values.tolist(), strict=True))


def leaves(table, path=""):
    for key, value in table.items():
        yield from leaves(value, f"{path}{key}.") if isinstance(value, dict) else [f"{path}{key}"]


@pytest.mark.parametrize("name", ["machine-hexapod", "small-hexapod", "motion-base"])
def test_every_number_is_out_of_a_catalogue_or_ours_with_a_reason(name):
    sourced = re.compile(
        r"(robot|motion|leg\.drive)\.type|robot\.gravity|heat\.reference|simulation\.fidelity|.*\.material"
        r"|payload\.mass|leg\.drive\.(bulk_modulus|lead|root_diameter|efficiency|bearing\.stiffness|nut\.(rigidity|(dynamic|static)_load))"
        r"|leg\.base_joint\.friction\.f1"
    )
    ours = {value.key for value in model.open_values(name)}
    left = [key for key in leaves(tomllib.loads(model.preset_text(name))) if not sourced.fullmatch(key)]
    assert [key for key in left if not any(key == own or key.startswith(f"{own}.") for own in ours)] == []


def test_a_leg_of_the_machine_hexapod_is_its_catalogue_in_series():
    # HIWIN, IBC, THK by hand, N and mm; the nut stands 245.75 mm from the bearing: 905.75 - 600 - 60.
    study = fx.preset("machine-hexapod")
    np.testing.assert_allclose(study.robot.home_lengths, 0.90575, atol=5e-6)
    steel = study.robot.legs[0].screw.material
    modulus, shear = steel.E / 1e6, steel.E / 1e6 / (2 * (1 + steel.poisson))
    area, polar = np.pi / 4 * 28.744**2, np.pi / 32 * 28.744**4
    shaft = modulus * area / (905.75 - 660)
    twist = shear * polar / (905.75 - 660) * (2 * np.pi / 10) ** 2
    nut = 0.8 * 1130e3 * (1540 / 3080) ** (1 / 3)
    piston = modulus * np.pi / 4 * (60**2 - 40**2) / 600
    give = 2 / 200e3 + 2 / 1000e3 + 1 / 830e3 + 1 / nut + 1 / shaft + 1 / twist + 1 / piston
    np.testing.assert_allclose(fx.parts(study.robot).leg_stiffness, 1e3 / give, rtol=1e-5)


def test_shares_of_the_machine_hexapod_are_those_of_real_machines():
    # Of ball-jointed machines: joints 40-60 %, screw, nut and bearing 20-35 %, piston 5-15 %, frame 5-20 %.
    found = shares("machine-hexapod")
    assert 0.4 < found["base_joint"] + found["platform_joint"] < 0.6
    assert 0.2 < found["screw"] + found["twist"] + found["nut"] + found["bearing"] < 0.35
    assert 0.05 < found["piston"] < 0.15
    assert 0.05 < found["base_plate"] + found["top_plate"] < 0.2


def test_what_check_says_of_the_machine_hexapod():
    study = fx.preset("machine-hexapod")
    found = describe(study)
    start = found.poses[0]
    assert soft_drives(study.robot) == ()
    assert 40 < start.modes[0].frequency < 70  # machine-tool hexapods: 20 to 60 N/um at the tool, some 50 Hz
    assert 20e6 < start.stiffness.least < 60e6
    assert 10e-6 < start.sag < 40e-6


def with_ideal_parts(text):
    """A study without the tables of joints, springs and drives, and so without the heat of screws."""
    text = re.sub(r"\[heat\].*?\n\n|\[leg\.drive\].*?\n\n", "", text, flags=re.DOTALL)
    return re.sub(r"\n(base|platform)_joint +=.*|\nsprings =.*", "", text)


def test_readme_says_how_accurate_the_machine_is_before_calibration():
    """The table showed 17 um and hid that the machine's own budget has 170 um of tolerances, heat and sag.

    Of the ideal one, tolerances alone: by hand at least 20 um a joint, two joints a leg, three standard deviations.
    """
    readme = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    printed = re.search(r"\| accuracy before calibration, after it \| (.*) \| (.*) \|", readme).groups()
    text = model.preset_text("machine-hexapod")
    for row, study in zip(printed, (with_ideal_parts(text), text), strict=True):
        before, after = np.linalg.norm(fx.budget(model.loads(study)).pose_accuracy.values[:, :3], axis=1)
        assert row == f"{1e6 * before:.3g} µm, {1e6 * after:.3g} µm"
        assert before > 3 * 20e-6 * np.sqrt(2)


def test_ideal_parts_hide_nine_tenths_of_it():
    # docs/real-machines.md. By hand: what sinks are 250 kg on six legs with the cosine 0.8 / 0.90575, of pistons alone
    # 524 N/um, with all parts 54 N/um. The legs weigh 31 kg each, of which springs low in the leg bear most: up to
    # three tenths more.
    real = re.sub(r"\[heat\].*?\n\n", "", model.preset_text("machine-hexapod"), flags=re.DOTALL)
    for text, stiffness, first, sag in (
        (with_ideal_parts(real), 523.6e6, 151.5, 1.12e-6),
        (real, 53.99e6, 56.2, 12.4e-6),
    ):
        robot = model.loads(text).robot
        assert 1.05 < sag * 6 * stiffness * (0.8 / 0.90575) ** 2 / (250 * 9.81) < 1.3
        found = fx.modes(robot)
        np.testing.assert_allclose(found.frequency[0], first, rtol=1e-3)
        np.testing.assert_allclose(-found.com_sag[2], sag, rtol=1e-2)


def test_shares_of_the_small_hexapod_are_those_of_real_machines():
    found = shares("small-hexapod")
    assert 0.4 < found["base_joint"] + found["platform_joint"] < 0.6
    assert 0.2 < found["screw"] + found["twist"] + found["nut"] + found["bearing"] < 0.35
    assert found["piston"] < 0.15


class TestNanoHexapod:
    """Against the frequencies that its public model prints, and scaled from them."""

    PUBLISHED = (780.60, 780.60, 903.89, 1061.43, 1061.43, 1269.66)  # ideal joints, struts of 20 N/um, no gravity [Hz]

    def test_with_ideal_joints_it_has_the_published_frequencies(self):
        # The public struts are round bars of radius 5 mm; ours have no inertia of their section in the upper half, 3 %
        # of that half's inertia, which is some hundredth of all that moves: below 3e-4 of a frequency.
        text = re.sub(r"\n(base|platform)_joint +=.*", "", model.preset_text("nano-hexapod"))
        changes = {"6-FPF": "6-UPS", "-9.81]": "0]", '"1.846 N/um"': '"20 N/um"', '"15.7 MN"': '"1e6 MN"'}
        robot = model.loads(replaced(text, *changes.items())).robot
        found = fx.modes(robot, fidelity="lumped")
        np.testing.assert_allclose(found.frequency[:6], self.PUBLISHED, rtol=3e-4)
        np.testing.assert_allclose(
            found.damping_ratio[:6], 20.0 * 2 * np.pi * found.frequency[:6] / (2 * 20e6), rtol=1e-3
        )
        # its printed compliance, all six by six numbers in SI units: 7.558e-6
        give = np.linalg.inv(fx.stiffness(robot, fidelity="lumped").stiffness)
        assert abs(np.linalg.norm(give) - 7.558e-6) < 1e-9

    def test_its_flexures_and_piezos_lower_them_by_the_root_of_the_stiffness(self):
        # 1.846 N/um, two flexures and a steel rod in series: 1.766 N/um. What the flexures add by turning: torsion, two
        # in series, 6 x 130 N m/rad times the square of the axis' cosine, 0.40 about z: 310 of the 17,300 N m/rad of
        # yaw, 1.8 % of a stiffness; bending, 10 N m/rad over 0.095 m squared, 1 N/mm of 1.8 N/um: 1 % of a frequency.
        study = fx.preset("nano-hexapod")
        along = 1 / (1 / 1.846 + 2 / 93.95 + 0.050 / 15.7)
        np.testing.assert_allclose(fx.parts(study.robot).leg_stiffness, along * 1e6, rtol=1e-9)
        found = fx.modes(study.robot, fidelity="lumped").frequency[:6]
        np.testing.assert_allclose(found, np.array(self.PUBLISHED) * np.sqrt(along / 20), rtol=0.01)

    def test_the_stroke_is_the_actuators(self):
        robot = fx.preset("nano-hexapod").robot
        stroke = robot.legs[0].stroke
        np.testing.assert_allclose(
            [stroke.min, stroke.max], robot.home_lengths[0] + np.array([-150e-6, 150e-6]), atol=5e-6
        )
