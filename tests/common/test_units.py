"""Text with units to SI."""

import math

import pytest

from flexapod.common import units
from flexapod.common.errors import InputError
from flexapod.common.units import COMMON_UNITS, DIMENSIONS, to_si

pytestmark = pytest.mark.unit


@pytest.mark.parametrize(
    ("text", "dimension", "expected"),
    [
        ("27 mm", "length", 0.027),
        ("315.18 mm", "length", 0.31518),
        ("26.6 deg", "angle", math.radians(26.6)),
        ("200 GPa", "stress", 200e9),
        ("756.65 N m^2", "bending stiffness", 756.65),
        ("12 N*m", "torque", 12.0),
        ("0.5 ms", "time", 0.0005),
        ("60 rpm", "angular rate", 2 * math.pi),
        ("5 Hz", "frequency", 5.0),
        ("-1.5e3 N", "force", -1500.0),
        ("1 in", "length", 0.0254),
        ("50 N/um", "stiffness", 5e7),
        ("0.5 %", "number", 0.005),
        ("0.005", "number", 0.005),
        ("7.8 g/cm^3", "density", 7800.0),
        ("27,5 mm", "length", 0.0275),
        ("0,005 kg", "mass", 0.005),
        ("1234,567 kg", "mass", 1234.567),
        (",5 s", "time", 0.5),
        ("2,1e11 Pa", "stress", 2.1e11),
    ],
)
def test_text_becomes_si(text, dimension, expected):
    # One rounding of the product at most.
    assert to_si(text, dimension) == pytest.approx(expected, rel=3e-16)


def test_decimal_prefixes_round_like_the_si_number():
    assert [to_si(f"{v} mm", "length") for v in ("157.5", "359.26", "0.1")] == [0.1575, 0.35926, 0.0001]


def test_numbers_are_si_already():
    assert to_si(3, "length") == 3.0
    assert isinstance(to_si(3, "length"), float)


@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_every_example_in_a_message_is_itself_allowed(dimension):
    assert math.isfinite(to_si(DIMENSIONS[dimension].example, dimension))


@pytest.mark.parametrize(
    ("value", "dimension", "what"),
    [
        ("27 kg", "length", "is not a length: kg does not measure one"),
        ("27 deg", "length", "is not a length"),
        ("3 m", "angle", "is not an angle"),
        ("20 %", "angle", "is not an angle"),
        ("5 rad/s", "frequency", "is not a frequency"),
        ("5 Hz", "angular rate", "is not an angular rate"),
        ("27", "length", "has no unit"),
        ("1,000 kg", "mass", "has a comma that may be a decimal mark or set thousands apart"),
        ("-27,500 mm", "length", "has a comma that may be a decimal mark or set thousands apart"),
        ("1,000,000 N", "force", "has a comma that may be a decimal mark or set thousands apart"),
        ("1,000.5 N", "force", "has a comma that may be a decimal mark or set thousands apart"),
        ("1.000,5 N", "force", "is not a number with a unit"),
        ("1'000 N", "force", "is not a number with a unit"),
        ("2e", "mass", "is not a mass"),
        ("27 foo", "length", "unknown unit (foo)"),
        ("27 m +", "length", "has an unknown unit"),
        ("about 3 m", "length", "is not a number with a unit"),
        (True, "length", "is not a number"),
        (None, "length", "is not a number"),
        ([1.0], "length", "is not a number"),
        (math.nan, "length", "is not finite"),
        (math.inf, "mass", "is not finite"),
        ("1e999 m", "length", "is not finite"),
    ],
)
def test_anything_else_is_refused(value, dimension, what):
    with pytest.raises(InputError) as caught:
        to_si(value, dimension, key="leg.piston.length")
    message = str(caught.value)
    assert what in message
    assert "leg.piston.length" in message
    assert DIMENSIONS[dimension].example in message
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(("dimension", "unit"), [(d, unit) for d, units in COMMON_UNITS.items() for unit in units])
def test_common_units_are_those_of_pint(dimension, unit, monkeypatch):
    found = to_si(f"12.5 {unit}", dimension)
    monkeypatch.setattr(units, "COMMON_UNITS", {})
    monkeypatch.setattr(units, "_factor", units._factor.__wrapped__)
    assert to_si(f"12.5 {unit}", dimension) == found
