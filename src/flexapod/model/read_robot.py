"""From the tables [robot], [payload], [leg] of a study file to a Robot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from flexapod.errors import InputError
from flexapod.model.chain import chains_of
from flexapod.model.circle import read_places
from flexapod.model.geometry import Geometry
from flexapod.model.heat import Heat
from flexapod.model.home import read_home
from flexapod.model.leg import Leg, read_leg
from flexapod.model.mount import BaseMotion, Mount
from flexapod.model.payload import Payload
from flexapod.model.robot import Robot
from flexapod.model.tolerances import Tolerances
from flexapod.schema.axes import Plane, normal_of
from flexapod.schema.section import Section
from flexapod.schema.table import Table
from flexapod.schema.written import Written

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
    base, platform = (read_places(section, end, tables, kind) for end in _ENDS)
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
        home=read_home(section, fixed),
        gravity=section.vector("gravity", *("acceleration",) * 3) or (0.0, 0.0, -9.81),
        payload=None if payload is None else payload.read(Payload),
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


def _tables(section: Section, kinds: Mapping[str, type[Table]]) -> dict[str, Table | None]:
    found = {name: section.section(name) for name in kinds}
    return {name: None if table is None else kinds[name].from_table(table) for name, table in found.items()}


def _turns(leg: Section) -> bool:
    """Whether the leg has directions that depend on where it stands."""
    tables = [leg.data.get(name) for name in ("base_joint", "platform_joint", "carriage")]
    return any(isinstance(table, Mapping) and {"slider", "crank", "axis"} & table.keys() for table in tables)


def _columns(leg: Leg) -> bool:
    """Whether a table has a column for each leg."""
    return getattr(leg.drive, "time", None) is not None
