"""Text with units to SI floats: the only module that knows pint, and only where a text has an unusual unit."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from numbers import Real
from typing import TYPE_CHECKING, Any

from flexapod.common.errors import InputError

if TYPE_CHECKING:
    from pint import UnitRegistry


@dataclass(frozen=True, kw_only=True)
class Dimension:
    """A physical dimension: its SI unit, an example for messages, whether its unit carries an angle.

    `least` and `most` bound the size of what is computed with, in SI: beyond every machine by orders of magnitude, and
    near enough to 1 that squares and products neither overflow nor vanish.
    """

    unit: str
    example: str
    least: float
    most: float
    angle: bool = False


DIMENSIONS = {
    "acceleration": Dimension(unit="m/s^2", example="9.81 m/s^2", least=1e-9, most=1e6),
    "acceleration spectrum": Dimension(unit="(m/s^2)^2/Hz", example="1e-8 (m/s^2)^2/Hz", least=1e-30, most=1e12),
    "angle": Dimension(unit="rad", example="20 deg", least=1e-12, most=1e6, angle=True),
    "angular acceleration": Dimension(unit="rad/s^2", example="10 deg/s^2", least=1e-12, most=1e6, angle=True),
    "angular rate": Dimension(unit="rad/s", example="45 deg/s", least=1e-12, most=1e6, angle=True),
    "axial stiffness": Dimension(unit="N", example="115 MN", least=1e-6, most=1e18),
    "bending stiffness": Dimension(unit="N m^2", example="756.65 N m^2", least=1e-18, most=1e18),
    "damping": Dimension(unit="N s/m", example="2 kN s/m", least=1e-12, most=1e15),
    "displacement spectrum": Dimension(unit="m^2/Hz", example="1e-18 m^2/Hz", least=1e-40, most=1e6),
    "density": Dimension(unit="kg/m^3", example="7800 kg/m^3", least=1e-12, most=1e9),
    "expansion": Dimension(unit="1/K", example="11.7e-6 1/K", least=1e-12, most=10.0),
    "flow": Dimension(unit="m^3/s", example="100 l/min", least=1e-15, most=1e6),
    "force": Dimension(unit="N", example="120 N", least=1e-12, most=1e12),
    "force spectrum": Dimension(unit="N^2/Hz", example="1e-4 N^2/Hz", least=1e-30, most=1e18),
    "frequency": Dimension(unit="Hz", example="5 Hz", least=1e-9, most=1e9),
    "impulse": Dimension(unit="N s", example="10 N s", least=1e-12, most=1e15),
    "inertia": Dimension(unit="kg m^2", example="17.88 kg m^2", least=1e-18, most=1e15),
    "integral gain": Dimension(unit="N m/(rad s)", example="500 N m/(rad s)", least=1e-12, most=1e15, angle=True),
    "integral stiffness": Dimension(unit="N/(m s)", example="2 kN/(m s)", least=1e-9, most=1e18),
    "leakage": Dimension(unit="m^3/(s Pa)", example="1e-12 m^3/(s Pa)", least=1e-20, most=10.0),
    "length": Dimension(unit="m", example="27 mm", least=1e-9, most=1e6),
    "line density": Dimension(unit="kg/m", example="4.02 kg/m", least=1e-15, most=1e9),
    "mass": Dimension(unit="kg", example="100 kg", least=1e-15, most=1e12),
    "number": Dimension(unit="", example="0.005", least=1e-15, most=1e15),
    "rotational damping": Dimension(unit="N m s/rad", example="2 N m s/rad", least=1e-12, most=1e15, angle=True),
    "rotational stiffness": Dimension(unit="N m/rad", example="15 N m/rad", least=1e-12, most=1e15, angle=True),
    "stiffness": Dimension(unit="N/m", example="50 N/um", least=1e-9, most=1e18),
    "stress": Dimension(unit="Pa", example="200 GPa", least=1e-3, most=1e18),
    "temperature": Dimension(unit="degC", example="25 degC", least=1e-9, most=1e6),
    "temperature difference": Dimension(unit="K", example="1 K", least=1e-9, most=1e6),
    "time": Dimension(unit="s", example="0.5 ms", least=1e-9, most=1e9),
    "torque": Dimension(unit="N m", example="12 N m", least=1e-12, most=1e12),
    "torque constant": Dimension(unit="N m/A", example="0.5 N m/A", least=1e-9, most=1e9),
    "torque spectrum": Dimension(unit="(N m)^2/Hz", example="1e-6 (N m)^2/Hz", least=1e-30, most=1e18),
    "velocity": Dimension(unit="m/s", example="0.1 m/s", least=1e-12, most=1e6),
    "velocity spectrum": Dimension(unit="(m/s)^2/Hz", example="1e-12 (m/s)^2/Hz", least=1e-35, most=1e12),
    "volume": Dimension(unit="m^3", example="0.4 l", least=1e-15, most=1e6),
}

#: Factors of the units that most study files use: reading these needs no pint, whose import takes a third of a second.
COMMON_UNITS = {
    "acceleration": {"m/s^2": 1.0},
    "acceleration spectrum": {"(m/s^2)^2/Hz": 1.0},
    "angle": {"rad": 1.0, "deg": math.pi / 180},
    "angular acceleration": {"rad/s^2": 1.0, "deg/s^2": math.pi / 180},
    "angular rate": {"rad/s": 1.0, "deg/s": math.pi / 180, "rpm": math.pi / 30},
    "bending stiffness": {"N m^2": 1.0},
    "damping": {"N s/m": 1.0, "kN s/m": 1e3},
    "density": {"kg/m^3": 1.0},
    "displacement spectrum": {"m^2/Hz": 1.0},
    "expansion": {"1/K": 1.0},
    "flow": {"m^3/s": 1.0},
    "force": {"N": 1.0, "kN": 1e3},
    "force spectrum": {"N^2/Hz": 1.0},
    "frequency": {"Hz": 1.0},
    "impulse": {"N s": 1.0},
    "inertia": {"kg m^2": 1.0},
    "integral gain": {"N m/(rad s)": 1.0},
    "integral stiffness": {"N/(m s)": 1.0, "kN/(m s)": 1e3},
    "leakage": {"m^3/(s Pa)": 1.0},
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6},
    "line density": {"kg/m": 1.0},
    "mass": {"kg": 1.0, "g": 1e-3},
    "rotational damping": {"N m s/rad": 1.0},
    "rotational stiffness": {"N m/rad": 1.0},
    "stiffness": {"N/m": 1.0, "N/um": 1e6},
    "stress": {"Pa": 1.0, "bar": 1e5, "MPa": 1e6, "GPa": 1e9},
    "temperature": {"degC": 1.0, "°C": 1.0},
    "temperature difference": {"K": 1.0},
    "time": {"s": 1.0, "ms": 1e-3},
    "torque": {"N m": 1.0},
    "torque constant": {"N m/A": 1.0},
    "torque spectrum": {"(N m)^2/Hz": 1.0},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3},
    "velocity spectrum": {"(m/s)^2/Hz": 1.0},
    "volume": {"m^3": 1.0, "l": 1e-3, "cm^3": 1e-6},
}

_TEXT = re.compile(r"^\s*([-+]?(?:\d+(?:\.\d*|,\d+)?|[.,]\d+)(?:[eE][-+]?\d+)?)(?![\d.,'])\s*(.*?)\s*$")
_NONE = ("inf", "infinity", "nan")  # what no quantity is, and Python reads
_TWO_READINGS = re.compile(r"^\s*[-+]?[1-9]\d{0,2},\d{3}(?!\d)")  # a thousand, or one with three decimals
_NO_COMMA = "Write the number without a comma, with a point before decimals"
_ANGLES = ("radian", "degree", "arcminute", "arcsecond", "turn", "revolution", "gradian", "grade")


def number_and_unit(text: str) -> tuple[str, str] | None:
    """The number of a text, with a decimal point, and its unit, "" where it has none.

    None where the text cannot be read, or in two ways: "27,5 mm" is 27.5 mm, "1,000 kg" one kilogram or a thousand.
    """
    match = None if _TWO_READINGS.match(text) else _TEXT.match(text)
    return (match[1].replace(",", "."), match[2]) if match else None


def to_si(value: object, dimension: str, *, key: str | None = None) -> float:
    """A number in SI units from a number (already SI) or a text with a unit.

    Parameters
    ----------
    value : object
        ``0.027`` or ``"27 mm"``.
    dimension : str
        A key of `DIMENSIONS`.
    key : str, optional
        Key path for messages.

    Returns
    -------
    float
        The value in the dimension's SI unit.

    Raises
    ------
    InputError
        If it is not a finite number, or its unit belongs to something else.
    """
    if isinstance(value, str):
        number = _from_text(value, dimension, key)
    elif isinstance(value, bool) or not isinstance(value, Real):
        raise _refuse("is not a number", value, dimension, key)
    elif isinstance(value, int):
        number = math.inf if abs(int(value)) > sys.float_info.max else float(value)
    else:
        number = float(value)
    if not math.isfinite(number):
        raise _refuse("is not finite", value, dimension, key)
    return number


def quantity(value: object, dimension: str, *, key: str | None = None) -> float:
    """A number in SI units from what is typed on a command line or given to a call.

    A number without a unit is in SI units, typed as well: ``5e-4``, ``"5e-4"`` and ``"0.5 ms"`` are one time. Texts of
    study files need a unit: there numbers are written as numbers. Arguments and errors as of `to_si`.
    """
    if isinstance(value, str):
        read = number_and_unit(value)
        if (read is not None and not read[1]) or value.strip().lstrip("+-").lower() in _NONE:
            value = float(read[0] if read else value)
    return to_si(value, dimension, key=key)


def quantities(values: Any, dimension: str, *, key: str | None = None, deep: int = 4) -> Any:
    """A quantity as `quantity` reads it, or rows of them, `deep` in each other: texts as SI numbers, else untouched.

    In rows texts need a unit: one of bare numbers is read from somewhere else, and may be in any.
    """
    if isinstance(values, str):
        return quantity(values, dimension, key=key)
    if getattr(getattr(values, "dtype", None), "kind", "") in "UO" and getattr(values, "ndim", 0):
        values = values.tolist()
    if type(values) in (list, tuple) and deep:
        each = (
            to_si(x, dimension, key=key) if isinstance(x, str) else quantities(x, dimension, key=key, deep=deep - 1)
            for x in values
        )
        return type(values)(each)
    return values


def _from_text(text: str, dimension: str, key: str | None) -> float:
    read = number_and_unit(text)
    if read is None:
        if _TWO_READINGS.match(text):
            raise _refuse(
                "has a comma that may be a decimal mark or set thousands apart", text, dimension, key, _NO_COMMA
            )
        raise _refuse("is not a number with a unit", text, dimension, key)
    number, unit = read
    if not unit:
        if dimension == "number":
            return float(number)
        raise _refuse("has no unit", text, dimension, key)
    factor = _factor(unit, dimension)
    if isinstance(factor, str):
        raise _refuse(factor, text, dimension, key)
    return _times(number, factor)


@cache
def _factor(unit: str, dimension: str) -> float | str:
    """Factor to SI, or what is wrong with the unit."""
    if (known := COMMON_UNITS.get(dimension, {}).get(unit)) is not None:
        return known
    registry, wanted = _registry(), DIMENSIONS[dimension]
    try:
        given = registry.Unit(unit.replace("²", "^2").replace("³", "^3"))
        fits = given.is_compatible_with(registry.Unit(wanted.unit))
    except Exception:  # pint lets errors of any kind out of its parser, AssertionError among them
        return f"has an unknown unit ({unit})"
    if dimension.startswith("temperature") and given != registry.Unit(wanted.unit):  # others count from another zero
        return f"is not in {'kelvin' if wanted.unit == 'K' else 'degrees Celsius'} ({unit})"
    has_angle = any(name.endswith(_ANGLES) or name.startswith("revolution") for name in given._units)
    if not fits or has_angle != wanted.angle:
        return f"is not {_article(dimension)}: {unit} does not measure one"
    return float(registry.Quantity(1.0, given).to(wanted.unit).magnitude)


def _times(number: str, factor: float) -> float:
    """Exact for powers of ten, so that "315.18 mm" is the same float as 0.31518."""
    power = round(math.log10(factor))
    if math.isclose(factor, 10.0**power, rel_tol=1e-12):
        return float(Decimal(number).scaleb(power))
    return float(number) * factor


@cache
def _registry() -> UnitRegistry:
    import pint

    return pint.UnitRegistry()


def _article(dimension: str) -> str:
    return f"an {dimension}" if dimension[0] in "aeiou" else f"a {dimension}"


def _refuse(what: str, value: object, dimension: str, key: str | None, next_step: str | None = None) -> InputError:
    wanted = DIMENSIONS[dimension]
    unit = f"in {wanted.unit} or " if wanted.unit else "or "
    allowed = f'{_article(dimension)}: a number {unit}text such as "{wanted.example}"'
    return InputError(what, key=key, value=value, allowed=allowed, next_step=next_step)
