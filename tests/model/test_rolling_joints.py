"""Joints on rolling bearings: the catalogue's law, its tangent, limits, study files, refusals, remarks."""

from typing import get_args

import numpy as np
import pytest
from tests.helpers.machines import machine, study

import flexapod as fx
from flexapod.analysis.description.robot_description import describe
from flexapod.common.errors import InputError
from flexapod.model import RollingLaw, to_toml
from flexapod.model.leg import rolling
from flexapod.model.leg.joint import Joint

pytestmark = pytest.mark.unit

UM = 1e6


def law(**more):
    return RollingLaw(**{"series": "NA49", "bore": 0.02, "load": 300.0, **more})


@pytest.mark.parametrize(("bore", "stiffness"), [(12, 263), (15, 305), (20, 367), (30, 478)])
def test_secant_of_a_cross_on_needle_bearings(bore, stiffness):
    # Schaeffler HR 1, pp. 52-53, two yokes, 300 N: computed by hand of 2 (150^0.84 / (23.5 d^0.65)) um, to a unit.
    found = law(bore=1e-3 * bore, of="secant")
    assert found.k / UM == pytest.approx(stiffness, abs=0.6)
    assert law(bore=1e-3 * bore).k == pytest.approx(found.k / 0.84, rel=1e-12)


def test_secant_of_bearings_by_their_width():
    # NKI of 16 mm on 20 mm, same pages: K_c = 4.4 x 16^0.8 / 20^0.2 = 22.21, c_s = 22.21 x 20^0.65 = 155.7,
    # 2 x 150^0.84 / 155.7 = 0.864 um under 300 N; of another width as its power of 0.8.
    found = law(series="NKI", width=0.016, of="secant").k / UM
    assert found == pytest.approx(347.0, abs=0.6)
    assert law(series="NKI", width=0.032, of="secant").k / UM == pytest.approx(2**0.8 * found, rel=1e-12)


@pytest.mark.parametrize(
    "more",
    [{}, {"series": "NKI", "width": 0.016}, {"series": "BK", "width": 0.012, "yokes": 1}, {"series": "K893"},
     {"series": "K811", "preload": 800.0}, {"series": "K812", "preload": 100.0, "yokes": 3}],
)  # fmt: skip
def test_the_tangent_is_the_derivative_of_the_law(more):
    low, high = (law(load=load, **more).shift for load in (299.0, 301.0))
    assert law(**more).k == pytest.approx(2.0 / (high - low), rel=1e-5)
    assert law(**more, of="secant").k == pytest.approx(300.0 / law(**more).shift, rel=1e-12)


def test_limits_of_the_law():
    # Load to zero under a preload: secant and tangent are one. Clearance: half of it in each yoke. 0.16 of the load.
    thrust = {"series": "K811", "preload": 500.0}
    assert law(**thrust, load=1e-3, of="secant").k == pytest.approx(law(**thrust, load=0.0).k, rel=1e-5)
    tight, loose = (law(of="secant", clearance=s) for s in (0.0, 4e-6))
    assert loose.shift - tight.shift == pytest.approx(4e-6, rel=1e-12)
    assert law(load=600.0).k / law().k == pytest.approx(2**0.16, rel=1e-12)
    assert {*rolling._FIXED, *rolling._BY_WIDTH} == {*get_args(rolling.Series)}


def test_a_study_file_with_a_law_is_the_robot_with_its_springs():
    given = Joint(rolling=law(loss=0.02, radial=1e8))
    k = law().k
    springs = Joint(stiffness=np.diag([1e8, 1e8, k, 0, 0, 0]), leg_axes=True, stiffness_loss=0.02)
    ours, theirs = (fx.stiffness(machine(base_joint=x), fidelity="lumped").stiffness for x in (given, springs))
    np.testing.assert_array_equal(ours, theirs)
    text = to_toml(study(machine(base_joint=given)))
    assert 'law = "rolling"' in text
    assert fx.loads(text).robot.legs[0].base_joint == given
    assert given.replace(play=1e-6).across_and_along == (1e8, k)
    parts = fx.parts(machine(base_joint=given)).part_stiffness.sel(part="base_joint")
    np.testing.assert_allclose(parts, k, rtol=1e-12)


@pytest.mark.parametrize(
    ("more", "key"),
    [({"series": "NKI"}, "width"), ({"width": 0.01}, "width"), ({"preload": 100.0}, "preload"), ({"load": 0.0}, "load"),
     ({"clearance": 4e-6}, "clearance"), ({"series": "K811", "of": "secant", "clearance": 4e-6}, "clearance"),
     ({"series": "K811", "load": 0.0, "preload": 10.0, "of": "secant"}, "load"),
     ({"loss": 0.1, "damping": 1.0}, "damping")],
)  # fmt: skip
def test_refusals(more, key):
    with pytest.raises(InputError) as caught:
        law(**more)
    assert caught.value.key == key


def test_a_load_far_from_that_of_the_law_is_remarked_on():
    # A ton on six legs: some 1.9 kN each.
    far, near = (study(machine(base_joint=Joint(rolling=law(load=load)))) for load in (300.0, 1900.0))
    assert any("base joint bears" in line and "300 N" in line for line in describe(far).remarks)
    assert not any("base joint bears" in line for line in describe(near).remarks)
