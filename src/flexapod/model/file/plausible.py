"""Numbers of a file without a unit that are far beyond the robot's own size: metres where millimetres are meant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any

from flexapod.common.errors import InputError
from flexapod.common.quantities import number, text
from flexapod.common.units import to_si
from flexapod.model.motion import AXES

BEYOND = 100.0  # times the robot's size, from which a length is no length of it
WIDE = 3.0  # the same of widths
SLOW = 1e-3  # of the robot's size that it moves in a second, below which a long motion is remarked on
LONG = 100.0  # duration without a unit from which it may be meant in ms [s]
STEEL, HEAVY = 7800.0, 5.0  # density [kg/m^3]; mass over that of a block of steel as large as the robot
FEWEST = 3  # lengths that make a size
_TELLING = (  # lengths of which some are about as large as the robot
    "robot.home_height", "robot.home.position", "robot.base.radius", "robot.base.joints", "robot.platform.radius",
    "robot.platform.joints", "leg.cylinder.mouth", "leg.piston.length", "leg.stroke.min", "leg.stroke.max",
    "leg.strut.length",
)  # fmt: skip
_OPEN = ("leg.stroke.max", "payload.com", "payload.tool", "motion.pivot")  # may be far away
_WIDTHS = (
    "leg.piston.diameter", "leg.piston.inner_diameter", "leg.cylinder.diameter", "leg.cylinder.inner_diameter",
    "leg.drive.root_diameter", "leg.drive.lead", "leg.drive.bore", "leg.drive.rod",
)  # fmt: skip
_MASSES = ("payload.mass", "leg.cylinder.mass", "leg.piston.mass")
_TIMES = ("motion.duration", "motion.hold")


@dataclass(frozen=True)
class _Number:
    """A number of a file: its key, SI value, and whether it has no unit."""

    key: str
    value: float
    bare: bool


def size_remarks(tables: Mapping[str, Any], file: str | None) -> list[str]:
    """Remarks on numbers without a unit that may be meant in another; refuses lengths that are none of this robot.

    Parameters
    ----------
    tables : Mapping
        Of a study file as they were read, whatever is in them.
    file : str, optional
        Named in messages.

    Raises
    ------
    InputError
        A length a hundred times the middle one of the robot's lengths, a width three times that.
    """
    lengths = [found for key in _TELLING for found in _numbers(tables, key, "length")]
    sizes = [abs(found.value) for found in lengths if found.value]
    if len(sizes) < FEWEST:
        return []
    size = median(sizes)
    limits = {key: BEYOND for key in _TELLING} | {key: WIDE for key in _WIDTHS}
    for key, factor in limits.items():
        for found in _numbers(tables, key, "length"):
            if found.bare and abs(found.value) > factor * size and key not in _OPEN:
                raise _refusal(found, size, file)
    far = [found for key in _OPEN for found in _numbers(tables, key, "length") if abs(found.value) > BEYOND * size]
    block = STEEL * size**3
    heavy = [found for key in _MASSES for found in _numbers(tables, key, "mass") if found.value > HEAVY * block]
    return [
        *(f"{found.key} is {text(found.value, 'm', 4)}; numbers are SI: {_meant(found.value, size)}"
          for found in far if found.bare),
        *(f"{found.key} is {number(found.value, 4)} kg, and a block of steel as large as the robot has "
          f'{number(block, 2)} kg; numbers are SI: "{number(found.value, 6)} g"?' for found in heavy if found.bare),
        *_slow(tables, size),
    ]  # fmt: skip


def _refusal(found: _Number, size: float, file: str | None) -> InputError:
    return InputError(
        f"is {text(found.value, 'm', 4)}, and the robot is about {text(size, 'm', 2)} large; numbers are SI: "
        f"{_meant(found.value, size)}",
        file=file,
        key=found.key,
        value=int(found.value) if found.value.is_integer() else found.value,
        allowed="a length of this robot: in m, or text with its unit",
    )


def _meant(value: float, size: float) -> str:
    """The same number in the unit in which it is nearest to the robot's size."""
    unit = "mm" if abs(value) / 1e3 < BEYOND * size else "um"
    return f'"{number(value, 6)} {unit}"?'


def _slow(tables: Mapping[str, Any], size: float) -> Iterator[str]:
    """Durations in which the robot hardly moves, of motions along and about axes."""
    turns = [found.value for axis in AXES[3:] for found in _travels(tables, axis, "angle")]
    travel = [found.value for axis in AXES[:3] for found in _travels(tables, axis, "length")]
    moved = max((abs(x) for x in (*travel, *(size * turn for turn in turns))), default=0.0)
    for key in _TIMES:
        for found in _numbers(tables, key, "time"):
            if moved and found.bare and found.value >= LONG and moved / found.value < SLOW * size:
                yield f'{found.key} is {number(found.value, 6)} s; numbers are SI: "{number(found.value, 6)} ms"?'


def _travels(tables: Mapping[str, Any], axis: str, dimension: str) -> Iterator[_Number]:
    yield from _numbers(tables, f"motion.amplitudes.{axis}", dimension)
    motion = tables.get("motion")
    if isinstance(motion, Mapping) and motion.get("type") == axis:
        yield from _numbers(tables, "motion.amplitude", dimension)


def _numbers(tables: Mapping[str, Any], key: str, dimension: str) -> Iterator[_Number]:
    """The numbers at a key, of every leg, every row and component; what cannot be read is passed over."""
    yield from _below(tables, key.split("."), "", dimension)


def _below(value: Any, names: list[str], path: str, dimension: str) -> Iterator[_Number]:
    if isinstance(value, list):
        for i, item in enumerate(value, start=1):
            yield from _below(item, names, f"{path}[{i}]", dimension)
    elif names:
        if isinstance(value, Mapping) and names[0] in value:
            yield from _below(value[names[0]], names[1:], f"{path}.{names[0]}".removeprefix("."), dimension)
    else:
        try:
            yield _Number(path, to_si(value, dimension), bare=not isinstance(value, str))
        except InputError:  # the reader says it
            return
