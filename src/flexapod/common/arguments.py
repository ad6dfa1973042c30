"""Numbers that calls are given: what is none, or out of range, is refused in words."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.common.units import DIMENSIONS, quantities, quantity


def number(
    given: object, key: str, dimension: str = "number", *, least: float = -np.inf, above: float = -np.inf,
    most: float = np.inf,
) -> float:  # fmt: skip
    """One number in SI units, of a text too, from `least` on or `above`, up to `most`.

    Raises
    ------
    InputError
        Something else.
    """
    try:  # an array without axes is a number, too
        one = given if isinstance(given, str) or np.ndim(given) else np.asarray(given).item()  # type: ignore[arg-type]
    except (TypeError, ValueError):
        one = given
    found = quantity(one, dimension, key=key)
    if not (least <= found <= most and found > above):
        begin = f"above {above:g}" if np.isfinite(above) else f"{least:g} or more" if np.isfinite(least) else ""
        words = [begin, f"at most {most:g}" if np.isfinite(most) else ""]
        raise InputError("is out of range", key=key, value=given, allowed=", ".join(filter(None, words)))
    return found


def flag(given: object, key: str) -> bool:
    """True or False; a text would count as True whatever it says."""
    if not isinstance(given, bool | np.bool_):
        raise InputError("is neither True nor False", key=key, value=given)
    return bool(given)


def matrix(given: ArrayLike, key: str, shape: str) -> Array:
    """A matrix of finite numbers; what has fewer axes is a row of one."""
    try:
        found = np.atleast_2d(floats(given))
    except ValueError:
        found = np.full((1, 1), np.nan)
    if found.ndim != 2 or not np.isfinite(found).all():
        raise InputError("is no matrix of finite numbers", key=key, value=given, allowed=shape)
    return found


def integer(given: object, key: str, least: int, most: int) -> int:
    """A whole number between two others, these included."""
    if isinstance(given, bool) or not isinstance(given, int | np.integer) or not least <= given <= most:
        raise InputError("is not in range", key=key, value=given, allowed=f"a whole number from {least} to {most}")
    return int(given)


def numbers(given: ArrayLike, key: str, allowed: str) -> Array:
    """Finite numbers, one or several, (n,).

    Raises
    ------
    InputError
        Something else, or in rows and columns.
    """
    try:
        found = np.asarray(given)
        found = np.atleast_1d(floats(given)) if found.dtype.kind in "iufO" else np.full(1, np.nan)
    except (TypeError, ValueError):
        found = np.full(1, np.nan)
    if found.ndim != 1 or not np.isfinite(found).all():
        raise InputError("are no finite numbers in a row", key=key, value=given, allowed=allowed)
    return found


def frequencies(hz: ArrayLike) -> Array:
    """Frequencies [Hz], (f,)."""
    hz = quantities([hz] if isinstance(hz, str) else hz, "frequency", key="hz")
    found, most = (
        numbers(hz, "hz", "frequencies [Hz], for example numpy.geomspace(1, 1000, 400)"),
        DIMENSIONS["frequency"].most,
    )
    if np.abs(found).max(initial=0.0) > most:
        raise InputError("are beyond every machine", key="hz", value=hz, allowed=f"at most {most:g} Hz")
    return found
