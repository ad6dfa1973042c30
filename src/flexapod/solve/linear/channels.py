"""Names of inputs and outputs: groups, single channels, points of the platform, and their units."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, names_of, suggest_word
from flexapod.common.units import quantity
from flexapod.model import Robot
from flexapod.solve.linear.motions import COMPONENTS

AXES = COMPONENTS[:3]
WRENCH = ("fx", "fy", "fz", "mx", "my", "mz")
Groups = Mapping[str, object]
#: Groups and their single channels; "legs": one a leg.
INPUTS: Groups = {"wrench": WRENCH, "drive": "legs", "command": "legs", "floor": COMPONENTS, "force": AXES}
OUTPUTS: Groups = {
    "tool": COMPONENTS, "com": AXES, "tool-base": COMPONENTS, "com-base": AXES, "stroke": "legs",
    "drive-force": "legs", "joint-force": "legs axes", "force-sensor:base": "legs", "force-sensor:drive": "legs",
    "force-sensor:platform": "legs", "encoder": "legs", "accelerometer": AXES, "geophone": AXES,
}  # fmt: skip
AT_POINTS = ("force", "accelerometer", "geophone")
ON_PLATFORM = (*AT_POINTS, "wrench", "tool", "com", "tool-base", "com-base")
#: Geophone of which nothing is said: a corner of 4.5 Hz, 0.7 of critical damping, and an output that is the velocity.
USUAL = (4.5, 0.7, 1.0)
_NUMBER = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?", re.IGNORECASE)


@dataclass(frozen=True, kw_only=True)
class Geophone:
    """A proof mass on a spring: its corner ``f0`` [Hz], ``damping`` ratio and ``sensitivity`` [V s/m]."""

    f0: float
    damping: float
    sensitivity: float


@dataclass(frozen=True, kw_only=True)
class PlantChannel:
    """One channel: its ``name``, ``group``, and which ``leg`` or ``axis`` of it, from 0; ``at``: a point from the CoM.

    ``at`` (3,) [m] in platform axes.
    """

    name: str
    group: str
    leg: int = -1
    axis: int = -1
    at: Array | None = None
    geophone: Geophone | None = None


def plant_channels(names: str | Sequence[str], robot: Robot, key: str) -> list[PlantChannel]:
    """Channels by names of groups or single ones, in the order given.

    Parameters
    ----------
    names : str or sequence of str
    robot : Robot
    key : str
        What a refusal calls them: "inputs" are inputs, all others outputs.

    Raises
    ------
    InputError
        A name that nothing has, with the nearest one.
    """
    known, found = (INPUTS if key == "inputs" else OUTPUTS), {}
    for name in names_of(names, key):
        for channel in _of(name, known, robot, key):
            there = found.get(channel.name, channel)
            if there.geophone != channel.geophone:
                channel = replace(channel, name=_numbered(channel))
            found.setdefault(channel.name, channel)
    if not found:
        raise InputError("are none", key=key, allowed=_words(known))
    _tell_former(found.values(), robot)
    return list(found.values())


def _numbered(channel: PlantChannel) -> str:
    """Name of a geophone with its numbers: of a second one at a point."""
    point, _, axis = channel.name.rpartition(":")
    g = channel.geophone
    return f"{point}[{g.f0:.12g} Hz, {g.damping:.12g}, {g.sensitivity:.12g}]:{axis}" if g else channel.name


def _tell_former(channels: Iterable[PlantChannel], robot: Robot) -> None:
    """Remark on what is a force at a screw's nut under the name that results give to the torque on the screw."""
    if any(c.group == "drive-force" and robot.legs[c.leg].screw is not None for c in channels):
        warnings.warn(
            '"drive-force" of a screw is the force at its nut, in N, where drive_force of results is the torque on it: '
            'ask for "force-sensor:drive", the same force; with the next release "drive-force" goes for screws',
            FutureWarning,
            stacklevel=4,
        )


def _words(known: Groups) -> str:
    return ", ".join(f"{name}:POINT" if name in AT_POINTS else name for name in known)


def _of(name: str, known: Groups, robot: Robot, key: str) -> list[PlantChannel]:
    group = next((g for g in sorted(known, key=len, reverse=True) if name == g or name.startswith(f"{g}:")), None)
    if group is None:
        raise InputError(
            "is not a channel", key=key, value=name, allowed=_words(known),
            next_step=suggest_word(name, [*known, *(f"{g}:POINT" for g in AT_POINTS if g in known)]),
        )  # fmt: skip
    if robot.platform_fixed and group in ON_PLATFORM:
        raise InputError(
            "has no meaning: the platform is fixed", key=key, value=name,
            allowed=_words({g: x for g, x in known.items() if g not in ON_PLATFORM}),
        )  # fmt: skip
    rest = name[len(group) + 1 :]
    plain = re.sub(r"\s*\[.*\]", "", name) if group == "geophone" else name
    every = _at_point(group, rest, robot, key) if group in AT_POINTS else _members(group, known[group], robot)
    chosen = [x for x in every if plain in (group, x.name) or x.name.startswith(f"{plain}:")] or (
        every if group in AT_POINTS and rest and not any(rest.endswith(f":{axis}") for axis in AXES) else []
    )
    if not chosen:
        raise InputError(
            "is not a channel", key=key, value=name, allowed=f"{every[0].name} to {every[-1].name}",
            next_step=suggest_word(name, [x.name for x in every]),
        )  # fmt: skip
    return chosen


def _members(group: str, members: object, robot: Robot) -> list[PlantChannel]:
    legs = range(len(robot.legs))
    if members == "legs axes":
        return [
            PlantChannel(name=f"{group}:{i + 1}:{axis}", group=group, leg=i, axis=k)
            for i in legs
            for k, axis in enumerate(AXES)
        ]
    if group == "floor" and robot.plane is not None:
        members = AXES  # a base that turns is known of robots in space
    if members != "legs":
        return [PlantChannel(name=f"{group}:{axis}", group=group, axis=k) for k, axis in enumerate(members)]  # type: ignore[arg-type]
    driven = [
        i
        for i in legs
        if group not in ("drive", "command", "drive-force", "force-sensor:drive") or robot.legs[i].driven
    ]
    return [PlantChannel(name=f"{group}:{i + 1}", group=group, leg=i) for i in driven]


def _at_point(group: str, rest: str, robot: Robot, key: str) -> list[PlantChannel]:
    """Along the world's axes at a point."""
    point, _, last = rest.rpartition(":")
    point = point if last in AXES else rest
    base, sensor = point, None
    if group == "geophone":
        base, sensor = _sensor(point, key)
    at = _point(base, robot, f"{group}:{rest}" if rest else group, key)
    return [
        PlantChannel(name=f"{group}:{base}:{axis}", group=group, axis=k, at=at, geophone=sensor)
        for k, axis in enumerate(AXES)
    ]


def _point(text: str, robot: Robot, name: str, key: str) -> Array:
    """A point of the platform from the payload's centre of mass, platform axes (3,)."""
    points = {"tool": robot.tool, "com": robot.com, "payload": robot.com, "platform": np.zeros(3)}
    points |= {f"joint-{i + 1}": at for i, at in enumerate(robot.platform_joints)}
    if text in points:
        return np.asarray(points[text] - robot.com, dtype=float)
    numbers = [part.strip() for part in text.strip("()").split(",")]
    try:
        if len(numbers) == 3:
            return np.array([quantity(x, "length") for x in numbers]) - robot.com
    except (InputError, ValueError):
        pass
    raise InputError(
        "has no such point", key=key, value=name,
        allowed=f"{', '.join([*list(points)[:4], 'joint-1'])} to joint-{len(robot.legs)}, or a place in platform axes "
        "as (0.1 m, 0, 50 mm)",
        next_step=suggest_word(text, points),
    )  # fmt: skip


def _sensor(text: str, key: str) -> tuple[str, Geophone]:
    """Name of the point, and the geophone behind it: "tool[4.5 Hz, 0.7, 28.8]"."""
    found = re.fullmatch(r"(.*?)\s*\[(.*)\]", text)
    numbers = list(USUAL)
    if found is not None:
        text = found[1]
        for k, part in enumerate(filter(None, (p.strip() for p in found[2].split(",")))):
            try:
                numbers[k] = float(re.sub(r"\s*(Hz|V.*)$", "", part))
            except (ValueError, IndexError):
                numbers[0] = -1.0
    if not (np.isfinite(numbers).all() and min(numbers[0], numbers[1]) > 0):
        raise InputError(
            "is no geophone", key=key, value=text if found is None else found[0],
            allowed="corner [Hz], damping ratio and sensitivity [V s/m], as geophone:tool[4.5 Hz, 0.7, 28.8]",
        )  # fmt: skip
    return text, Geophone(f0=numbers[0], damping=numbers[1], sensitivity=numbers[2])
