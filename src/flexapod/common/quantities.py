"""Quantities in words, in the unit in which a number reads well."""

from __future__ import annotations

import re
from string import Formatter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array

_SENTENCE = re.compile(r"\. (?=[A-Z])")
NOTHING = 1e-12  # length that is rounding [m]
ROUNDING = 1e-6  # of the largest axis: what is smaller is shown as 0
UNSAID = 1e-4  # of a displacement: components below it go unsaid
_PREFIXES = {
    "m": ((1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")),
    "N": ((1e-6, "MN"), (1e-3, "kN"), (1.0, "N"), (1e3, "mN"), (1e6, "µN")),
    "N m": ((1e-3, "kN m"), (1.0, "N m"), (1e3, "mN m")),
    "N m/rad": ((1e-6, "MN m/rad"), (1e-3, "kN m/rad"), (1.0, "N m/rad")),
    "N/m": ((1e-6, "N/µm"), (1e-3, "N/mm"), (1.0, "N/m")),
    "Pa": ((1e-9, "GPa"), (1e-6, "MPa"), (1e-3, "kPa"), (1.0, "Pa")),
    "J": ((1e-3, "kJ"), (1.0, "J"), (1e3, "mJ"), (1e6, "µJ"), (1e9, "nJ")),
    "s": ((1.0, "s"), (1e3, "ms")),
    "rad": ((180 / np.pi, "deg"), (1e3, "mrad"), (1e6, "µrad")),
    "m/s": ((1.0, "m/s"), (1e3, "mm/s")),
    "m/s²": ((1.0, "m/s²"), (1e3, "mm/s²")),
    "rad/s": ((180 / np.pi, "deg/s"),),
    "rad/s²": ((180 / np.pi, "deg/s²"),),
}


class Scale:
    """Factor from SI to the unit `name` in which a quantity reads well."""

    def __init__(self, factor: float, name: str) -> None:
        self.factor: float = factor
        self.name: str = name

    def __call__(self, values: ArrayLike) -> Array:
        """Values in that unit."""
        return np.asarray(values, dtype=float) * self.factor

    def text(self, value: float, digits: int = 3) -> str:
        """A number with its unit."""
        return f"{number(value * self.factor, digits)} {self.name}"


def scale(values: ArrayLike, unit: str) -> Scale:
    """Choose the unit in which the largest of `values` (SI, `unit`) lies between 1 and 1000, if there is one.

    Parameters
    ----------
    values : array_like
        In SI units; NaN are ignored.
    unit : str
        SI unit: m, N, J, rad, m/s, rad/s, ...; others stay as they are.
    """
    finite = np.abs(np.asarray(values, dtype=float))
    finite = finite[np.isfinite(finite)]
    largest = float(finite.max()) if finite.size else 0.0
    choices = [Scale(factor, name) for factor, name in _PREFIXES.get(unit, ((1.0, unit),))]
    if largest == 0:
        return Scale(1.0, unit) if unit != "rad" else choices[0]
    for choice in choices:
        if largest * choice.factor >= 1:
            return choice
    return choices[-1]


def text(value: float, unit: str, digits: int = 3) -> str:
    """A number with the unit in which it reads well: ``text(1.93e-5, "m")`` is "19.3 µm"."""
    return scale(value, unit).text(value, digits)


class _Numbers(Formatter):
    """Fields with a tilde are numbers of so many digits, in the unit that follows; others as Python formats them."""

    def format_field(self, value: Any, format_spec: str) -> str:
        if not format_spec.startswith("~"):
            return super().format_field(value, format_spec)
        digits, _, unit = format_spec[1:].partition(" ")
        return text(value, unit, int(digits)) if unit else number(value, int(digits))


def fill_template(template: str, **numbers: object) -> str:
    """A sentence with its numbers put in, as `number` has them, and as `text`, or as the fields say themselves.

    Examples
    --------
    >>> fill_template("{what} swings by {way:~3 m} at {frequency:~4} Hz, {share:.1%} of it", what="a leg", way=2e-5,
    ...        frequency=31.4, share=0.1)
    'a leg swings by 20 µm at 31.4 Hz, 10.0% of it'
    """
    return _Numbers().vformat(template, (), numbers)


def rounded_up(value: float) -> float:
    """The next of 1, 2, 5 and 10 times a power of ten: what a number is at most whose digits are rounding."""
    power = 10.0 ** np.floor(np.log10(value)) if value > 0 else 0.0
    return float(next((k * power for k in (1, 2, 5) if k * power >= value), 10 * power))


def along_axes(values: ArrayLike, *, signed: bool = False) -> str:
    """Lengths [m] along x, y, z in words, in a unit each; what is nothing has none: "x 1.2 µm, y 0, z 19.3 µm".

    With signs on request, and then without the axes along which there is nothing.
    """
    shown = [(axis, float(value)) for axis, value in zip("xyz", np.asarray(values, dtype=float).tolist(), strict=False)]
    if signed:
        return ", ".join(f"{axis} {'+' if v > 0 else ''}{text(v, 'm')}" for axis, v in shown if v) or "0"
    return ", ".join(f"{axis} {text(value, 'm') if value else '0'}" for axis, value in shown)


def number(value: float, digits: int = 3) -> str:
    """A number of `digits` significant digits without powers of ten, where it has at most nine figures."""
    shown = f"{value:.{digits}g}"
    return f"{float(shown):.0f}" if "e" in shown and 1 <= abs(value) < 1e9 else shown


def column(values: ArrayLike, unit: str, digits: int = 4) -> tuple[str, list[str]]:
    """Unit and numbers of a column: one unit and as many decimals for all, so that they align; NaN is "n/a".

    Parameters
    ----------
    values : array_like, shape (n,)
        In SI units.
    unit : str
        SI unit.
    digits : int
        Of the largest.

    Examples
    --------
    >>> column([4.33e-6, 1.929e-5], "m")
    ('µm', ['4.33', '19.29'])
    """
    chosen = scale(values, unit)
    shown = chosen(values)
    finite = np.abs(shown[np.isfinite(shown)])
    largest = float(finite.max(initial=0.0))
    decimals = max(0, digits - 1 - int(np.floor(np.log10(largest)))) if largest > 0 else 0
    return chosen.name, [
        f"{round(value, decimals) + 0.0:.{decimals}f}" if np.isfinite(value) else "n/a" for value in shown
    ]


def columns(unit: str, *values: ArrayLike, digits: int = 4) -> list[Any]:
    """The unit, and the numbers of several columns in that one: ``columns("m", [1.0], [0.5])``; see `column`."""
    parts = [np.atleast_1d(np.asarray(part, dtype=float)) for part in values]
    name, flat = column(np.concatenate(parts), unit, digits)
    ends = np.cumsum([len(part) for part in parts])
    return [name, *(flat[end - len(part) : end] for part, end in zip(parts, ends, strict=True))]


def capital(words: str) -> str:
    """Words with a capital letter."""
    return f"{words[0].upper()}{words[1:]}"


def sentence(words: str) -> str:
    """Words with a capital letter and a full stop."""
    return f"{capital(words)}."


def zero_rounding(values: ArrayLike, largest: float) -> Array:
    """Values of one axis to show beside the others: 0 throughout where all are rounding beside the largest axis."""
    given = np.asarray(values, dtype=float)
    return given * (np.abs(given).max(initial=0.0) > ROUNDING * abs(largest))


def zero_rounding_lines(lines: Array) -> Array:
    """Lines (lines, T) to show together: each that is rounding beside the largest of all is 0 throughout."""
    largest = float(np.abs(lines).max(initial=0.0))
    return np.stack([zero_rounding(line, largest) for line in lines])


def brief(remark: str) -> tuple[str, str]:
    """The first sentence of a remark, which says it, and the others, which explain it."""
    first, _, rest = _SENTENCE.sub("\n", remark, count=1).partition("\n")
    return first, rest


def length(value: float) -> str:
    """A computed length of which what is below a picometre is rounding, in words."""
    return text(value if abs(value) >= NOTHING else 0.0, "m")


def signed_components(moved: Array, beside: Array | None = None) -> str:
    """Components (3,) [m] with signs: "x -1.2 µm, z +18.5 µm"; without those that are nothing beside a displacement."""
    size = float(np.linalg.norm(moved if beside is None else beside))
    return along_axes(np.where(np.abs(moved) > max(UNSAID * size, NOTHING), moved, 0.0), signed=True)
