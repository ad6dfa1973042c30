"""Screws, nuts, bearings and springs in study files: catalogue laws, worked examples, refusals; `fx.parts`."""

import re

import numpy as np
import pytest
from tests.helpers.machines import BEARING, NUT, SCREW, SOFT, machine, study, symmetric
from tests.helpers.texts import REAL_PARTS
from typer.testing import CliRunner

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.error_budget.rows import names_of_rows
from flexapod.analysis.results.causes import cause_names
from flexapod.app.cli.cli import app
from flexapod.common.errors import InputError
from flexapod.mechanics.elements.springs import series_stiffness, softening, springs_along
from flexapod.model import (
    MATERIALS,
    AxialSpring,
    Bearing,
    Geometry,
    Heat,
    Material,
    Nut,
    ScrewFriction,
    to_toml,
)
from flexapod.model.heat import HEAT_PARTS
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.guide import Guide
from flexapod.model.leg.material import Tube
from flexapod.model.study.mount import Mount
from flexapod.output.exchange.decks_legs import legs_at_pose
from flexapod.solve.statics.parts import part_stiffness

pytestmark = pytest.mark.unit

UM = 1e6  # N/m


def along(name, length, screw, piston=0.0):
    """Stiffness of a screw's part with the nut at a distance from a bearing at 0."""
    leg = machine(drive=screw).legs[0]
    part = {spring.name: spring for spring in springs_along(leg)}[name]
    return 1.0 / part.at_length(np.array(length + leg.piston.length + screw.bearing.position))


def test_the_worked_example_of_the_catalogue():
    # THK BNF2512-2.5: root 21.9 mm, 2.06e5 N/mm^2, fixed-supported, 1500 N, nut at 100 and 700 mm.
    screw = SCREW.replace(
        root_diameter=0.0219, mounting="fixed-supported", material=Material(name="given", E=2.06e11, density=7850.0)
    )
    assert screw.area == pytest.approx(376.5e-6, rel=5e-4)  # four digits printed
    stiffness = [along("screw", x, screw) / UM for x in (0.1, 0.7)]
    assert stiffness == pytest.approx([776, 111], abs=0.5)
    errors = [1500 / k for k in stiffness]  # um
    assert errors == pytest.approx([1.9, 13.5], abs=0.05)
    assert errors[1] - errors[0] == pytest.approx(11.6, abs=0.05)


def test_a_screw_held_at_both_ends():
    free, both = SCREW.replace(mounting="fixed-free"), SCREW.replace(mounting="fixed-fixed")
    places = np.linspace(0.01, 0.89, 23)  # of 0.9 m
    one, two = along("screw", places, free), along("screw", places, both)
    np.testing.assert_allclose(two, two[::-1], rtol=1e-9)  # the nut seen from the other end
    assert (two >= one).all()
    assert along("screw", 0.45, both) == pytest.approx(4 * free.area * 200e9 / 0.9, rel=1e-12)
    assert along("screw", 1e-6, both) == pytest.approx(along("screw", 1e-6, free), rel=2e-6)  # a / L


@pytest.mark.parametrize(("lead", "share"), [(1 / 3.7, 0.04), (0.5, 0.13), (1.0, 0.53)])
def test_the_twist_of_a_screw_beside_its_stretch(lead, share):
    screw = SCREW.replace(lead=lead * SCREW.root_diameter, mounting="fixed-free")
    ratio = along("screw", 0.4, screw) / along("twist", 0.4, screw)
    assert ratio == pytest.approx(2 * 2.6 * (lead / np.pi) ** 2, rel=1e-12)
    assert ratio == pytest.approx(share, abs=0.006)  # two digits in the notes


def test_a_nut_goes_with_the_cube_root_of_its_preload():
    nut = Nut(rigidity=1130e6, preload=250.0, dynamic_load=30.8e3)
    assert nut.replace(preload=2000.0).k == pytest.approx(2 * nut.k, rel=1e-12)
    assert nut.replace(preload=3080.0).k == pytest.approx(0.8 * 1130e6, rel=1e-12)
    assert nut.linear_to == pytest.approx(2.83 * 250, rel=1e-3)


def test_a_pair_of_angular_contact_bearings():
    pair = {"model": "angular-contact", "position": 0.06, "balls": 16, "ball_diameter": 7e-3,
            "contact_angle": np.deg2rad(60)}  # fmt: skip
    found = Bearing(preload=1700.0, **pair)
    # 16 balls: Q = 122.7 N, Q^2 / D = 2151, its cube root 12.91, approach 6.707 um: by hand.
    assert found.k == pytest.approx(3 * 1700 / 6.707e-6, rel=1e-3)
    # IBC, p. 9: twice the preload, 1.26 times the stiffness.
    assert Bearing(preload=3400.0, **pair).k / found.k == pytest.approx(2 ** (1 / 3), rel=1e-12)


def test_five_springs_in_series_are_one():
    leg = machine(springs=tuple(AxialSpring(name=f"s{k}", stiffness=5e8, damping=5e3) for k in range(5))).legs[0]
    assert series_stiffness(springs_along(leg), 1.0, 0.0) == pytest.approx((1e8, 1e3), rel=1e-12)
    mixed = machine(springs=(AxialSpring(name="a", stiffness=1e8, loss=0.1), AxialSpring(name="b", stiffness=3e8)))
    stiffness, damping = series_stiffness(springs_along(mixed.legs[0]), 1.0, 1 / (2 * np.pi * 20.0))
    loss = (0.1 / 1e8) / (1 / 1e8 + 1 / 3e8)  # shares of the strain energy
    assert damping == pytest.approx(loss * stiffness / (2 * np.pi * 20.0), rel=1e-12)


def test_the_compliance_is_a_polynomial_about_home():
    springs = [x for x in springs_along(machine(drive=SCREW.replace(mounting="fixed-fixed")).legs[0]) if x.at == "nut"]
    stiffness, (first, second) = series_stiffness(springs, 1.1, 1.0)[0], softening(springs, 1.1)
    for away in (-0.05, 0.0, 0.2):
        whole = sum(float(x.at_length(np.array(1.1 + away))) for x in springs)
        assert (1 + away * (first + away * second)) / stiffness == pytest.approx(whole, rel=1e-12)


def test_a_study_with_a_screw_is_written_and_read_again():
    given = fx.loads(REAL_PARTS)
    assert fx.loads(to_toml(given)).robot == given.robot
    assert given.robot.legs[0].screw.inertia == pytest.approx(
        7800 * 0.9 * np.pi / 32 * 0.02874**4 + 4 * 2e-3, rel=1e-12
    )


def test_the_parts_of_a_machine():
    robot = symmetric(drive=SCREW, springs=(AxialSpring(name="bracket", stiffness=5e8),))
    data = fx.parts(robot)
    assert list(data.part.values) == ["piston", "screw", "twist", "nut", "bearing", "bracket"]
    one = data.part_stiffness.isel(leg=0).values
    assert one[[0, 3, 4, 5]] == pytest.approx([3.3e8 / 0.75, NUT.k, BEARING.k, 5e8], rel=1e-12)
    reach = robot.home_lengths[0] - 0.75 - BEARING.position
    assert one[1] == pytest.approx(SCREW.area * 200e9 / reach, rel=1e-12)
    np.testing.assert_allclose(1 / data.leg_stiffness, (1 / data.part_stiffness).sum("part"), rtol=1e-12)
    higher = fx.parts(robot, [0, 0, 0.05, 0, 0, 0])
    assert (higher.part_stiffness.sel(part="screw") < data.part_stiffness.sel(part="screw")).all()


def test_a_spring_has_no_name_of_another_part_or_cause():
    heat, mount = Heat(**dict.fromkeys(HEAT_PARTS, 22.0)), Mount(stiffness=np.eye(6) * 1e9)
    drive = SCREW.replace(friction=ScrewFriction(torque=1.0))
    robot = machine(drive=drive, base_joint=SOFT, platform_joint=SOFT).replace(base_mount=mount, platform_mount=mount)
    robot = robot.replace(heat=heat, geometry=Geometry(leg_offset=1e-5, lead=1e-5))
    names = {*cause_names(robot), *part_stiffness(robot, robot.home_lengths), *names_of_rows(study(robot))}
    for name in (name for name in names if " " not in name):
        with pytest.raises(InputError, match="is not a name for a spring"):
            AxialSpring(name=name, stiffness=1e8)


@pytest.mark.parametrize("compute", [fx.simulate, fx.parts, fx.modes])
def test_a_nut_off_the_screw_is_refused_on_the_path(compute):
    for changes, key in (
        ({"length": 0.25}, "length"),
        ({"bearing": BEARING.replace(position=0.5)}, "bearing.position"),
    ):
        robot = machine(drive=SCREW.replace(**changes))
        with pytest.raises(InputError, match=r"nut of leg \d, which is") as caught:
            compute(study(robot) if compute is fx.simulate else robot)
        assert caught.value.key == f"leg.drive.{key}"


def test_a_force_drive_takes_no_springs_behind_it():
    with pytest.raises(InputError, match="same at both ends"):
        machine(springs=(AxialSpring(name="bracket", stiffness=5e8),), drive=fx.model.ForceDrive())


def test_a_thrust_beyond_the_preload_is_remarked_on():
    soft = SCREW.replace(nut=Nut(rigidity=1130e6, preload=300.0, dynamic_load=30.8e3))
    found = fx.modes(symmetric(drive=soft), fidelity="lumped")
    assert "beyond 848.5 N" in found.attrs["warnings"]
    assert "one half" not in fx.modes(symmetric(drive=SCREW), fidelity="lumped").attrs["warnings"]


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "machine.toml"
    text = REAL_PARTS.replace('command = "servo"', "")
    text = text.replace('loop = { stiffness = "5 kN m/rad", damping = "20 N m s/rad" }', "")
    path.write_text(text + '[simulation]\nfidelity = "lumped"\nstep = "1 ms"\n', encoding="utf-8")
    return path


def test_check_lists_the_stiffness_of_every_part(file):
    found = CliRunner().invoke(app, ["check", str(file)])
    assert found.exit_code == 0, found.output
    out = found.stdout
    rows = {line.split()[0]: line for line in out.splitlines() if "(" in line and "%" in line}
    assert {"base_joint", "piston", "screw", "twist", "nut", "bearing", "bracket", "flange"} <= set(rows)
    assert "all in series" in out
    assert re.search(r"first frequency there, \d\d\.\d+ Hz.*base_joint: stiffness", out, flags=re.DOTALL)
    assert "782.8" in rows["nut"]  # N/um: 0.8 x 1130 x (2000 / 3080)^(1/3)


def test_a_report_says_what_the_drives_are(file, tmp_path):
    found = CliRunner().invoke(app, ["run", str(file), "--out", str(tmp_path / "out")])
    assert found.exit_code == 0, found.output
    page = next((tmp_path / "out").glob("*.html")).read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    assert "with a lead of 10 mm, fixed-fixed, the rotor held at its command" in page
    assert "give of the nuts" in page


@pytest.mark.parametrize("key", ["guide", "cylinder"])
def test_decks_refuse_what_they_do_not_have(key):
    tube = Cylinder.tube(mouth=0.6, section=Tube(diameter=0.09, inner_diameter=0.07), material=MATERIALS["steel"])
    parts = {"guide": Guide(gland=2e8, head=2e8), "cylinder": tube}
    with pytest.raises(InputError, match=r"not written in decks.*Leave it out for the deck"):
        legs_at_pose(machine(**{key: parts[key]}), kinematics.home_pose(machine()), np.zeros(6))


def test_a_deck_has_the_springs_before_the_piston():
    robot = machine(drive=SCREW, springs=(AxialSpring(name="bracket", stiffness=5e8),))
    found = legs_at_pose(robot, kinematics.home_pose(robot), np.zeros(6))[0]
    parts = fx.parts(robot).isel(leg=0)
    expected = 1 / (1 / parts.part_stiffness).sel(part=["screw", "twist", "nut", "bearing", "bracket"]).sum()
    assert found.drive_spring == pytest.approx(float(expected), rel=1e-12)
    ends = tuple(AxialSpring(name=at, stiffness=5e8, at=at) for at in ("base", "platform"))
    leg = legs_at_pose(machine(springs=ends, base_joint=SOFT), kinematics.home_pose(robot), np.zeros(6))[0]
    np.testing.assert_allclose(leg.base_springs, [150e6, 150e6, 1 / (1 / 200e6 + 1 / 5e8)])
    np.testing.assert_allclose(leg.base_gives, leg.axes.T)
    np.testing.assert_allclose((*leg.tip_springs, *leg.tip_gives[0]), (5e8, *leg.axes[:, 2]))
    with pytest.raises(InputError, match=r"leg.drive.type.*not written in decks"):
        legs_at_pose(machine(base_joint=SOFT, drive=fx.model.ForceDrive()), kinematics.home_pose(robot), np.ones(6))


def test_sweeps_vary_parts():
    given = study(machine(drive=SCREW, springs=(AxialSpring(name="bracket", stiffness=5e8),)), fidelity="lumped",
                  step=1e-3, duration=0.01)  # fmt: skip
    data = fx.sweep(given, {"vary": [{"key": "leg.springs.bracket", "values": ["500 N/um", "250 N/um"]}],
                            "keep": {"scalars": ["cause_share"]}})  # fmt: skip
    assert data.cause_share.sizes["cause"] == 8
    shares = data.cause_share.sel(cause="bracket").values.ravel()
    assert shares[1] > 1.5 * shares[0]
