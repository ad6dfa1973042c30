"""Study files of any mechanism: the samples, what is read of chains, places and words, and every refusal."""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.helpers.samples import MECHANISMS
from tests.helpers.texts import replaced

from flexapod import model
from flexapod.common.errors import InputError
from flexapod.model.leg.chain import chain_of, chains_of

pytestmark = pytest.mark.unit

SAMPLES = {path.stem: path.read_text(encoding="utf-8") for path in sorted(MECHANISMS.glob("*.toml"))}
PRESETS = ("tripod", "flight-simulator", "machine-hexapod")


def content(study):
    return study.replace(source_text="x", path=None, notes=())


def changed(name, *pairs):
    return replaced(SAMPLES[name], *pairs)


def robot(name, *pairs):
    return model.loads(changed(name, *pairs)).robot


def test_there_are_nine_samples():
    types = {re.search(r'type = "([^"]+)"', text)[1] for text in SAMPLES.values()}
    assert types == {"6-UPS", "6-PUS", "3-RPS", "3-UPS+UP", "3-PRR", "3-PUU", "1-UPS", "6-FPF", "8-UPS"}


@pytest.mark.parametrize("name", [*SAMPLES, *PRESETS])
def test_a_sample_is_read_without_a_remark_and_written_and_read_again(name):
    study = model.loads(SAMPLES[name]) if name in SAMPLES else model.preset(name)
    assert study.warnings == ()
    assert content(model.loads(model.to_toml(study))) == content(study)
    assert len(repr(study.robot)) < 400
    assert study.robot.alike == (name not in ("tricept", "eight-legs"))


@pytest.mark.parametrize("name", PRESETS)
def test_presets_move_within_their_strokes_at_home(name):
    robot = model.preset(name).robot
    leg = robot.legs[0]
    assert leg.stroke.min < robot.home_lengths.min() and robot.home_lengths.max() < leg.stroke.max
    assert robot.home_lengths.max() - leg.cylinder.mouth < leg.piston.length


def test_the_flight_simulator_has_the_masses_of_its_solids():
    # Bodies of the public data: steel of 76e3 / 9.81 kg/m^3; bodies of 0.75 of a leg's length.
    robot, density = model.preset("flight-simulator").robot, 76e3 / 9.81
    leg, length = robot.legs[0], 0.75 * np.sqrt(14 - 6 * np.cos(np.deg2rad(47.5)))
    np.testing.assert_allclose(robot.home_lengths, length / 0.75, rtol=1e-12)
    tube = density * np.pi * (0.05**2 - 0.03**2) * length
    np.testing.assert_allclose(leg.cylinder.mass, tube, rtol=2e-5)
    np.testing.assert_allclose(leg.cylinder.inertia, tube * (3 * (0.05**2 + 0.03**2) + length**2) / 12, rtol=2e-5)
    np.testing.assert_allclose(leg.cylinder.axial_inertia, tube * (0.05**2 + 0.03**2) / 2, rtol=2e-5)
    np.testing.assert_allclose([leg.cylinder.com, leg.cylinder.mouth], [length / 2, length], rtol=1e-5)
    np.testing.assert_allclose(leg.piston.mass, density * np.pi * 0.03**2 * length, rtol=2e-5)
    np.testing.assert_allclose(leg.piston.axial_inertia, leg.piston.mass * 0.03**2 / 2, rtol=2e-5)
    plate = density * np.pi * 0.05
    np.testing.assert_allclose(robot.payload.mass, plate, rtol=1e-5)
    np.testing.assert_allclose(
        np.diag(robot.payload.inertia), plate * np.array([3.0025 / 12, 3.0025 / 12, 0.5]), rtol=1e-5
    )


class TestChains:
    @pytest.mark.parametrize(
        ("letters", "parts", "driven"),
        [
            ("UPS", ("", "U", "P", "S"), "stroke"),
            ("UCU", ("", "U", "C", "U"), "stroke"),
            ("UP", ("", "U", "P", ""), "stroke"),
            ("FPF", ("", "F", "P", "F"), "stroke"),
            ("RPR", ("", "R", "P", "R"), "stroke"),
            ("PUS", ("slider", "U", "", "S"), "carriage"),
            ("PRS", ("slider", "R", "", "S"), "carriage"),
            ("RUS", ("crank", "U", "", "S"), "carriage"),
            ("RRR", ("crank", "R", "", "R"), "carriage"),
            ("PUPS", ("slider", "U", "P", "S"), "carriage"),
            ("SS", ("", "S", "", "S"), ""),
            ("RS", ("", "R", "", "S"), ""),
        ],
    )
    def test_letters(self, letters, parts, driven):
        found = chain_of(letters)
        assert (found.carriage, found.base, found.stroke, found.platform) == parts
        assert found.driven == driven

    @pytest.mark.parametrize("letters", ["", "U", "P", "PS", "UPPS", "XPS", "UPSU", "PC", "SPP", "ups", "PP", "RUPS"])
    def test_letters_that_make_no_leg(self, letters):
        with pytest.raises(InputError, match=r"no leg|crank and a stroke"):
            chain_of(letters)

    def test_types(self):
        assert chains_of("3-UPS+UP") == ("UPS", "UPS", "UPS", "UP")
        assert chains_of("2-PRR + RPR") == ("PRR", "PRR", "RPR")
        assert chains_of("UPS") == ("UPS",)
        for text, words in (("6_UPS", "COUNT-CHAIN"), ("", "COUNT-CHAIN"), ("17-UPS", "1 to 16"), ("0-UPS", "1 to 16"),
                            ("6-ups", "Write '6-UPS'"), ("3-UPS+UX", "UX: letters that make no leg")):  # fmt: skip
            with pytest.raises(InputError, match=re.escape(words)):
                chains_of(text)


class TestPlacesAndWords:
    def test_words_are_directions_as_seen_from_the_joint(self):
        three = robot("tripod")
        for joint, leg in zip(three.base_joints, three.legs, strict=True):
            np.testing.assert_allclose(leg.u_axis, np.cross([0, 0, 1], joint) / 0.35, atol=1e-15)
        radial = robot("tripod", ('axis = "tangential"', 'axis = "radial"'))
        np.testing.assert_allclose(radial.legs[1].u_axis, radial.base_joints[1] / 0.35, atol=1e-15)
        assert 'base_joint = { axis = "radial" }' in model.to_toml(
            model.loads(changed("tripod", ('axis = "tangential"', 'axis = "radial"')))
        )

    def test_legs_take_places_of_their_own(self):
        found = robot("tricept")
        np.testing.assert_array_equal(found.base_joints[3], 0)
        np.testing.assert_allclose(np.linalg.norm(found.base_joints[:3], axis=1), 0.4)
        assert [leg.driven for leg in found.legs] == ["stroke"] * 3 + [""]

    def test_the_drive_of_all_legs_may_stand_at_a_passive_one(self):
        earlier = robot("tricept", ("passive = true ", 'passive = true\ndrive = { type = "prescribed" }'))
        assert earlier == robot("tricept")  # results of earlier versions carry such studies

    def test_a_strut_reaches_from_two_places(self):
        lower, upper = robot("hexaglide"), robot("hexaglide", ("side = -1", "side = 1"))
        near = robot("hexaglide", ("side = -1", 'home = "1.5 m"'))
        assert (lower.home_carriages < 0.5).all() and (upper.home_carriages > 1.5).all() and near.alike
        np.testing.assert_array_equal(near.home_carriages, upper.home_carriages)
        for found in (lower, upper):
            np.testing.assert_allclose(found.home_lengths, 0.7, rtol=1e-14)

    @pytest.mark.parametrize("carriage", [
        'crank = "tangential", radius = "0.1 m"',
        'crank = [0, 0, 1], arm = [0, "0.1 m", 0]',
        'crank = "radial", radius = 0.1',
    ])  # fmt: skip
    def test_cranks(self, carriage):
        turned = changed("hexaglide", ('type = "6-PUS"', 'type = "6-RUS"'), ('length = "0.7 m"', 'length = "0.98 m"'))
        text = re.sub(r"carriage = .*", f"carriage = {{ {carriage}, side = 1 }}", turned)
        study = model.loads(text)
        np.testing.assert_allclose(study.robot.home_lengths, 0.98, rtol=1e-14)
        arms = np.linalg.norm(study.robot.home_bases - study.robot.base_joints, axis=1)
        np.testing.assert_allclose(arms, 0.1, rtol=1e-14)
        assert content(model.loads(model.to_toml(study))) == content(study)

    @pytest.mark.parametrize(("plane", "axes"), [("xy", (0, 1, 2)), ("yz", (1, 2, 0)), ("zx", (2, 0, 1))])
    def test_planes(self, plane, axes):
        words = {"xy": ("surge", "yaw"), "yz": ("sway", "roll"), "zx": ("heave", "pitch")}[plane]
        text = changed("planar", ('plane = "xy"', f'plane = "{plane}"'), ("surge = ", f"{words[0]} = "),
                       ("yaw = ", f"{words[1]} = "), ("com = [0, 0]", 'com = [0.01, "20 mm"]'))  # fmt: skip
        study = model.loads(text)
        flat = robot("planar")
        first, second, normal = axes
        np.testing.assert_array_equal(study.robot.base_joints[:, [first, second, normal]], flat.base_joints)
        np.testing.assert_allclose(study.robot.home_carriages, flat.home_carriages)
        np.testing.assert_array_equal(study.robot.payload.com[[first, second, normal]], [0.01, 0.02, 0])
        np.testing.assert_allclose(np.diag(study.robot.payload.inertia)[list(axes)], [0.00075, 0.00075, 0.0015])
        assert content(model.loads(model.to_toml(study))) == content(study)

    def test_home(self):
        home = 'home = { position = [0, "10 mm", 0.9], rotation = ["10 deg", 0, "20 deg"] }'
        found = robot("hexapod", ('home_height = "0.9 m"', home))
        assert found.home_height == 0.9
        turn = found.home_rotation
        roll, yaw = np.deg2rad([10, 20])
        Rx = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
        Rz = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        np.testing.assert_allclose(turn, Rz @ Rx, atol=1e-15)
        np.testing.assert_allclose(found.home_tips, found.platform_joints @ turn.T + [0, 0.01, 0.9], atol=1e-15)
        study = model.loads(changed("hexapod", ('home_height = "0.9 m"', home)))
        assert content(model.loads(model.to_toml(study))) == content(study)

    @pytest.mark.parametrize("stiffness", [
        '"50 N/um"', '{ axial = "94 N/um", radial = 13e6 }', '[[1e7, 0, 0], [0, 1e7, 0], [0, 0, "9 N/um"]]',
    ])  # fmt: skip
    def test_flexures(self, stiffness):
        joint = 'platform_joint = { bending = "15 N m/rad", torsion = "20 N m/rad" }'
        text = changed("flexures", (joint, f'platform_joint = {{ bending = "15 N m/rad", stiffness = {stiffness} }}'))
        study = model.loads(text)
        found = study.robot.legs[0].platform_joint
        assert (found.bending, found.torsion) == (15.0, None)
        assert found.stiffness[2, 2] in (5e7, 9.4e7, 9e6) and not found.stiffness[3:].any()
        assert content(model.loads(model.to_toml(study))) == content(study)

    def test_six_rows_of_stiffness(self):
        rows = np.diag([1e7, 1e7, 9e7, 15.0, 15.0, 20.0])
        rows[0, 4] = rows[4, 0] = 100.0
        joint = 'platform_joint = { bending = "15 N m/rad", torsion = "20 N m/rad" }'
        found = robot("flexures", (joint, f"platform_joint = {{ stiffness = {rows.tolist()} }}"))
        np.testing.assert_array_equal(found.legs[3].platform_joint.stiffness, rows)

    def test_the_old_name_of_the_axis(self):
        old = robot("tripod", ('base_joint = { axis = "tangential" }', "u_axis = [1, 0, 0]"))
        new = robot("tripod", ('axis = "tangential"', "axis = [1, 0, 0]"))
        assert old == new

    def test_a_constant_force(self):
        drive = robot("eight-legs").legs[7].drive
        assert (drive.law, drive.value, drive.time) == ("constant", 500.0, None)


def test_what_only_python_can_give():
    found = robot("hexapod")
    with pytest.raises(InputError, match="says 6 legs, and there are 5"):
        found.replace(legs=found.legs[:5])
    with pytest.raises(InputError, match="says UPS, UPS"):
        found.replace(legs=(*found.legs[:5], found.legs[5].replace(chain="RPS")))
    with pytest.raises(InputError, match="5 joints for 6 legs"):
        found.replace(base_joints=found.base_joints[:5])
    with pytest.raises(InputError, match=r"payload.*is missing"):
        found.replace(payload=None)
    slider = robot("hexaglide").legs[0]
    crank = model.Carriage(kind="crank", axis=[0, 0, 1], arm=[0.1, 0, 0])
    with pytest.raises(InputError, match="sliders or cranks"):
        legs = [slider, *[slider.replace(chain="RUS", carriage=crank)] * 5]
        robot("hexaglide").replace(type="PUS+5-RUS", legs=legs)
    rod = slider.strut
    with pytest.raises(InputError, match=r"chain: has no drive: no P.*Allowed: passive = true"):
        model.Leg(chain="SS", strut=rod)
    assert model.Leg(chain="SS", strut=rod, passive=True).driven == ""
    with pytest.raises(InputError, match="carriage: is missing: P moves the foot"):
        model.Leg(chain="PUS", strut=rod)
    with pytest.raises(InputError, match="strut: is missing"):
        model.Leg(chain="PUS", piston=found.legs[0].piston, carriage=slider.carriage)
    with pytest.raises(InputError, match="along the axis"):
        crank.replace(arm=[0, 0, 1])
    assert found.replace(home_height=1.0).home.position.tolist() == [0, 0, 1]


def test_the_help_of_new_names_every_preset():
    text = (Path(__file__).parents[2] / "src/flexapod/app/cli/commands_study.py").read_text(encoding="utf-8")
    assert all(name in text for name in model.PRESETS)
