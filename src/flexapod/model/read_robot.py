"""From the tables [robot], [payload], [leg] of a study file to a Robot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

import numpy as np

from flexapod.errors import InputError
from flexapod.model.chain import chains_of
from flexapod.model.circle import Circle
from flexapod.model.geometry import Geometry
from flexapod.model.heat import Heat
from flexapod.model.home import Home
from flexapod.model.leg import Leg, read_leg
from flexapod.model.mount import BaseMotion, Mount
from flexapod.model.payload import Payload
from flexapod.model.robot import Robot
from flexapod.model.tolerances import Tolerances
from flexapod.schema.axes import Plane, normal_of
from flexapod.schema.section import Section
from flexapod.schema.table import Table
from flexapod.schema.written import Written
from flexapod.typing import Array

_LENGTHS = ("length", "length", "length")
_INERTIAS = ("inertia", "inertia", "inertia")
_ENDS = ("base", "platform")
_BUILT: Mapping[str, type[Table]] = {"geometry": Geometry, "heat": Heat, "tolerances": Tolerances}
_MOUNTS: Mapping[str, type[Table]] = {"base_mount": Mount, "platform_mount": Mount, "base_motion": BaseMotion}
_BESIDE = ("payload", "leg", *_BUILT)


def read_robot(top: Section) -> Robot:
    """The robot of a study file, from its whole-file section."""
    fixed = platform_fixed(top)
    top.need("robot", *(() if fixed else ("payload",)), "leg")
    section = top.child(top.data["robot"], "robot")
    section.only("type", "plane", "base", "platform", "home_height", "home", "gravity", *_MOUNTS)
    section.need(*_ENDS)
    plane = top.plane = section.plane = section.text("plane", ("xy", "yz", "zx"))
    kind = section.text("type")
    kind = "6-UPS" if kind is None else kind
    try:
        chains = chains_of(kind)
    except InputError as error:
        raise error.located(file=top.file, prefix="robot.type") from None
    top.leg = (1, len(chains))
    tables = _leg_tables(top, chains, kind)
    base, platform = (_places(section, end, tables, kind) for end in _ENDS)
    legs: list[Leg] = []
    for i, table in enumerate(tables):
        same = i > 0 and table is tables[i - 1] and not _turns(table) and not _columns(legs[-1])
        places = (base[i], platform[i], normal_of(plane))
        legs.append(legs[-1] if same else read_leg(table, i + 1, len(chains), chains[i], places))
    payload = top.section("payload")
    robot = top.build(
        Robot,
        type=kind,
        base_joints=base,
        platform_joints=platform,
        home=_home(section, fixed),
        gravity=section.vector("gravity", *("acceleration",) * 3) or (0.0, 0.0, -9.81),
        payload=None if payload is None else payload.read(Payload, then=_inertia),
        legs=tuple(legs),
        plane=cast("Plane | None", plane),
        platform_fixed=fixed,
        **_tables(top, _BUILT),
        **_tables(section, _MOUNTS),
    )
    beside = {name: top.data[name] for name in _BESIDE if name in top}
    return robot.keep(Written({**section.data, **beside}))


def platform_fixed(top: Section) -> bool:
    """Whether a study file says that the platform is held."""
    robot = top.data.get("robot")
    platform = robot.get("platform") if isinstance(robot, Mapping) else None
    if not isinstance(robot, Mapping) or not isinstance(platform, Mapping):
        return False
    return bool(top.child(robot, "robot").child(platform, "platform").flag("fixed"))


def _leg_tables(top: Section, chains: tuple[str, ...], kind: str) -> list[Section]:
    """The table of every leg; the same one for legs that share it."""
    value, count = top.data["leg"], len(chains)
    single = not isinstance(value, list)
    sections = [top.child(value, "leg")] if single else [top.child(leg, f"leg[{i}]") for i, leg in enumerate(value, 1)]
    counts = [section.whole("count") or (count if single else 1) for section in sections]
    if min(counts, default=0) < 1 or sum(counts) != count:
        legs = "1 leg" if count == 1 else f"{count} legs"
        times = "appears once" if len(sections) == 1 else f"appears {len(sections)} times"
        raise InputError(
            times if counts == [1] * len(sections) else f"{times}, for {sum(counts)} legs together",
            file=top.file,
            key="leg" if single else "[[leg]]",
            allowed=f"{legs} ({kind}): [leg] once for all alike, or [[leg]] with count = .. for each kind",
        )
    tables = [section for section, number in zip(sections, counts, strict=True) for _ in range(number)]
    for section in sections:
        covered = {chain for chain, table in zip(chains, tables, strict=True) if table is section}
        if len(covered) > 1:
            raise InputError(
                f"stands for legs of several kinds ({', '.join(sorted(covered))})",
                file=top.file,
                key=section.path,
                allowed=f"[[leg]] with count = .. for each kind of {kind}, in its order",
            )
    return tables


def _places(robot: Section, end: str, tables: list[Section], kind: str) -> Array:
    """Joints of all legs at one end, (n, 3); a leg may have its own place, the others share a circle or rows."""
    joints = [table.section(f"{end}_joint") for table in tables]
    own = [None if joint is None else joint.vector("at", *_LENGTHS) for joint in joints]
    shared = iter(_shared(robot.child(robot.data[end], end), end, own.count(None), kind))
    return np.array([next(shared) if place is None else place for place in own])


def _shared(section: Section, end: str, count: int, kind: str) -> Array | list[list[float]]:
    fixed = ("fixed",) if end == "platform" else ()
    for name, what in (("joints", "rows"), ("angles", "angles")):
        given = section.data.get(name)
        if isinstance(given, list) and len(given) != count:
            raise section.malformed(
                f"places {len(given)} joint{'s' * (len(given) != 1)}",
                name,
                allowed=f"{count} {what}, one for each leg of {kind} that has no {end}_joint.at",
            )
    if "joints" in section:
        section.only("joints", *fixed)
        return section.rows("joints", *(_LENGTHS,) * count)
    circle = section.read(Circle, also=("joints", *fixed), then=lambda s: _angles(s, count))
    return circle.joints(end, section.plane)


def _angles(section: Section, count: int) -> dict[str, object]:
    if "half_angle" in section and (count != 6 or section.plane):
        odd = "an odd number of joints has no pairs" if count % 2 else "pairs at 0, 120 and 240 deg are six joints"
        raise section.error(
            f"does not place {count} joints{f' in the plane {section.plane}' if section.plane else ''}: {odd}",
            "half_angle",
            allowed=f"angles, a list of {count}",
            next_step=f"For example: angles = {[f'{360 * i // max(count, 1)} deg' for i in range(count)]}",
        )
    if "angles" not in section:
        section.need("radius", "half_angle" if count == 6 and not section.plane else "angles")
        return {"angles": None}
    if "half_angle" in section:
        raise section.error("is given together with angles", "half_angle", allowed="one of the two")
    return {"angles": section.vector("angles", *("angle",) * count)}


def _tables(section: Section, kinds: Mapping[str, type[Table]]) -> dict[str, Table | None]:
    found = {name: section.section(name) for name in kinds}
    return {name: None if table is None else kinds[name].from_table(table) for name, table in found.items()}


def _home(robot: Section, fixed: bool) -> Home:
    home = robot.section("home")
    if home is None:
        height = robot.number("home_height", "length")
        if height is None and not (robot.plane or fixed):
            robot.need("home_height")
        try:
            return Home(position=np.array([0.0, 0.0, height or 0.0]))
        except InputError as error:
            raise robot.locate(InputError(error.what, key="home_height", allowed=error.allowed)) from None
    if "home_height" in robot:
        raise robot.error("is given together with home", "home_height", allowed="one of the two")
    return home.read(Home, then=_turn if robot.plane else None)


def _turn(home: Section) -> dict[str, object]:
    """Rotation of a planar robot: a number, about the normal."""
    if isinstance(home.data.get("rotation"), list):
        return {}
    angle = home.number("rotation", "angle")
    return {} if angle is None else {"rotation": angle * normal_of(home.plane)}


def _inertia(section: Section) -> dict[str, object]:
    value = section.data.get("inertia")
    if isinstance(value, list) and any(isinstance(row, list) for row in value):
        return {"inertia": section.rows("inertia", *(_INERTIAS,) * 3)}
    if section.plane is None or isinstance(value, list):
        return {"inertia": section.vector("inertia", *_INERTIAS)}
    number = section.number("inertia", "inertia")  # of a flat plate in that plane
    return {} if number is None else {"inertia": number * (1 + normal_of(section.plane)) / 2}


def _turns(leg: Section) -> bool:
    """Whether the leg has directions that depend on where it stands."""
    tables = [leg.data.get(name) for name in ("base_joint", "platform_joint", "carriage")]
    return any(isinstance(table, Mapping) and {"slider", "crank", "axis"} & table.keys() for table in tables)


def _columns(leg: Leg) -> bool:
    """Whether a table has a column for each leg."""
    return getattr(leg.drive, "time", None) is not None
