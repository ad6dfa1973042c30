"""Values of a sweep: along ranges, of hypercubes and of draws, in SI."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.key_paths import Step, key_text
from flexapod.common.units import to_si
from flexapod.design.sweeps.plan import Draws, Hypercube, Spaced


def dimension_of(key: tuple[Step, ...], dimensions: Mapping[str, str]) -> str | None:
    """Dimension of a number, or of those of a list or of all legs; None of a choice or a whole number."""
    text = key_text(key)
    first_leg = "leg[1]" + text[3:] if text.startswith("leg.") else text
    for candidate in (text, first_leg):
        for inner in ("", "[1]", "[1][1]"):
            if candidate + inner in dimensions:
                return dimensions[candidate + inner]
    return None


def number(value: object, key: tuple[Step, ...], dimensions: Mapping[str, str]) -> float:
    """A value of a key in SI.

    Raises
    ------
    InputError
        It is not a number of the key's dimension, or the key holds none.
    """
    dimension = dimension_of(key, dimensions)
    if dimension is not None:
        return to_si(value, dimension, key=key_text(key))
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError("is not a number", key=key_text(key), value=value, allowed="a list of values for such a key")
    return value


def spaced_values(spaced: Spaced, key: tuple[Step, ...], dimensions: Mapping[str, str]) -> tuple[float, ...]:
    """The values from start to stop; whole numbers stay whole where the key takes no others.

    Raises
    ------
    InputError
        No numbers; whole numbers that do not fall on whole ones; logarithms of what is not above 0.
    """
    start, stop = (number(value, key, dimensions) for value in (spaced.start, spaced.stop))
    if spaced.logarithmic and min(start, stop) <= 0:
        raise InputError("cannot be spaced by logarithms", key=key_text(key), value=min(start, stop), allowed="above 0")
    made = (np.geomspace if spaced.logarithmic else np.linspace)(start, stop, spaced.count)
    if dimension_of(key, dimensions) is not None:
        return tuple(made.tolist())
    if not np.allclose(made, np.rint(made), rtol=0, atol=1e-9):
        raise InputError(
            "takes whole numbers only", key=key_text(key), value=made.tolist(), next_step="Choose another count"
        )
    return tuple(int(x) for x in np.rint(made))


def hypercube_values(cube: Hypercube, dimensions: Mapping[str, str]) -> Array:
    """Samples of the Latin hypercube, (count, ranges), SI.

    Raises
    ------
    InputError
        A range that is none, or of a key that takes whole numbers or choices.
    """
    from scipy.stats.qmc import LatinHypercube

    for entry in cube.ranges:
        if dimension_of(entry.key, dimensions) is None:
            raise InputError(
                "takes no number between two others", key=key_text(entry.key), next_step="Vary it with [[vary]]"
            )
    limits = np.array([[number(x, entry.key, dimensions) for x in (entry.low, entry.high)] for entry in cube.ranges])
    for entry, (low, high) in zip(cube.ranges, limits, strict=True):
        if low >= high:
            raise InputError(
                "is not a range", key=key_text(entry.key), value=[entry.low, entry.high], allowed="lowest, then highest"
            )
    unit = LatinHypercube(len(limits), seed=cube.seed).random(cube.count)  # pyright: ignore  (renamed in SciPy 1.15)
    return limits[:, 0] + unit * (limits[:, 1] - limits[:, 0])


def standard_draws(draws: Draws, sizes: tuple[int, ...]) -> tuple[Array, ...]:
    """Draws of every tolerance, (count, size): standard normal, or uniform between -1 and 1.

    Every tolerance has a stream of its own, so that adding one leaves the others as they were.
    """
    found = []
    for position, (tolerance, size) in enumerate(zip(draws.tolerances, sizes, strict=True)):
        stream = np.random.default_rng([draws.seed, position])
        shape = (draws.count, size)
        found.append(stream.standard_normal(shape) if tolerance.law == "normal" else stream.uniform(-1.0, 1.0, shape))
    return tuple(found)
