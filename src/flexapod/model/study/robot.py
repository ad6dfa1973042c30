"""The parallel robot: joints, home, payload, legs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, cast

import numpy as np
from pydantic import Field, WrapValidator, computed_field, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import number, text
from flexapod.common.tables.axes import Plane, axis_of, diagonal, normal_of
from flexapod.common.tables.base import Joints, Quantity, Vec3
from flexapod.common.tables.table import Table, to_plain_data
from flexapod.common.tables.toml import SourceTable
from flexapod.model.heat import Heat
from flexapod.model.leg.chain import chains_of
from flexapod.model.leg.circle import read_places
from flexapod.model.leg.geometry import Geometry
from flexapod.model.leg.leg import Leg, read_leg
from flexapod.model.moved_legs import moved_legs
from flexapod.model.study.home import Home, carriage_home, foot, read_home
from flexapod.model.study.mount import BaseMotion, Mount
from flexapod.model.study.payload import Payload, millimetres
from flexapod.model.study.robot_checks import (
    check_built,
    check_counts,
    check_leg,
    check_mounts,
    check_plane,
    check_spread,
    check_springs,
    check_tolerances,
)
from flexapod.model.study.tolerances import Tolerances

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

_ENDS = ("base", "platform")
_BUILT: Mapping[str, type[Table]] = {"geometry": Geometry, "heat": Heat, "tolerances": Tolerances}
_MOUNTS: Mapping[str, type[Table]] = {"base_mount": Mount, "platform_mount": Mount, "base_motion": BaseMotion}
_BESIDE = ("payload", "leg", *_BUILT)
_NUMBERS = "none one two three four five six seven eight nine ten eleven twelve".split()
_OR_NONE = WrapValidator(lambda value, check: None if value is None else check(value))


class Robot(Table):
    """A platform on legs; six of "UPS" unless `type` names others: "3-RPS", "3-UPS+UP".

    `base_joints` (n, 3) [m] in world axes, for a leg with a carriage where that is at 0 (slider) or its axis (crank);
    `platform_joints` (n, 3) [m] in the platform frame; `home`: pose of that frame at home, for which `home_height`
    [m] alone stands where the frame is then above the origin and parallel to the world; `gravity` (3,) [m/s^2] in world
    axes; `plane`: all moves in it; `platform_fixed`: the platform is held, and `payload` may be None; `geometry`,
    `heat`: how it differs from all this as it is built and warm, `tolerances`: as it may; `base_mount`,
    `platform_mount`: springs on which base and payload stand, `base_motion`: how the base is moved.
    """

    spells: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "base": ("base_joints", "type", "plane"),
        "platform": ("platform_joints", "platform_fixed", "type", "plane"),
        "home_height": ("home",),
        "home": ("home", "plane"),
        "payload": ("payload", "plane"),
        "leg": ("legs", "base_joints", "platform_joints", "type", "plane"),
    }

    type: str = "6-UPS"
    base_joints: Annotated[Joints, Quantity("length")]
    platform_joints: Annotated[Joints, Quantity("length")]
    home: Home
    gravity: Annotated[Vec3, Quantity("acceleration")]
    payload: Annotated[Payload, _OR_NONE] = Field(default=cast(Payload, None))
    legs: tuple[Leg, ...]
    plane: Plane | None = None
    platform_fixed: bool = False
    geometry: Geometry | None = None
    heat: Heat | None = None
    tolerances: Tolerances | None = None
    base_mount: Mount | None = None
    platform_mount: Mount | None = None
    base_motion: BaseMotion | None = None

    def __init__(self, **fields: Any) -> None:
        if (height := fields.pop("home_height", None)) is not None:
            home = fields.get("home")
            fields["home"] = _at_height(height, home)
        super().__init__(**fields)

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed; directions that were given by words follow their joints.

        Raises
        ------
        InputError
            If a field does not exist, the new value is not allowed, or a word means nothing at the new place.
        """
        if not {"base_joints", "platform_joints", "plane"}.isdisjoint(changes):
            changes["legs"] = moved_legs(**{**self._given, **changes})
        return super().replace(**changes)

    @model_validator(mode="after")
    def _fits(self) -> Robot:
        check_counts(self)
        check_spread(self)
        check_plane(self)
        for i, length in enumerate(self.home_lengths, start=1):
            check_leg(i, self.legs[i - 1], float(length))
        check_built(self)
        check_springs(self)
        check_tolerances(self)
        check_mounts(self)
        return self

    def _shown(self) -> dict[str, str]:
        lengths = self.home_lengths
        span = text(lengths.min(), "m", 4) + (f" to {text(lengths.max(), 'm', 4)}" if np.ptp(lengths) > 1e-9 else "")
        drives = ", ".join(dict.fromkeys(leg.drive.type for leg in self.legs if leg.driven))
        many = _NUMBERS[self.count] if self.count < len(_NUMBERS) else str(self.count)
        payload = self.payload
        return {
            "type": self.type + (f" in plane {self.plane}" if self.plane else ""),
            "home height": text(self.home_height, "m", 4),
            "legs": f"{f'{many} alike' if self.alike else 'of several kinds'}, {span} long at home, drives {drives}",
            "payload": "none, the platform is fixed"
            if payload is None
            else f"{number(payload.mass, 4)} kg, centre of mass at {millimetres(payload.com)}",
        }

    def is_unchanged(self, key: str) -> bool:
        """Tell whether the text of a key still holds; joints beside which legs have places only with these."""
        return super().is_unchanged(key) and (
            key not in ("base", "platform") or self.is_unchanged("leg") or not self._places
        )

    @property
    def _places(self) -> bool:
        """Tell whether a leg was written with places of its own."""
        legs = self.source_table.data["leg"] if self.source_table is not None else []
        tables = legs if isinstance(legs, list) else [legs]
        return any("at" in leg.get(f"{end}_joint", {}) for leg in tables for end in ("base", "platform"))

    @property
    def count(self) -> int:
        """Number of legs."""
        return len(self.legs)

    @property
    def alike(self) -> bool:
        """Tell whether the legs are alike, each seen in directions that turn with its place."""
        if all(leg is self.legs[0] for leg in self.legs):
            return True
        joints = zip(self.legs, self.base_joints, self.platform_joints, strict=True)
        first, *others = (_own_view(leg, base, platform, self.normal) for leg, base, platform in joints)
        return all(leg == first for leg in others)

    @computed_field
    @property
    def home_height(self) -> float:
        """Height of the platform frame at home [m]."""
        return float(self.home.position[2])

    @property
    def com(self) -> Array:
        """Centre of mass of the payload, (3,) [m], platform axes; without a payload the platform frame's origin."""
        return np.zeros(3) if self.payload is None else self.payload.com

    @property
    def tool(self) -> Array:
        """Tool, (3,) [m], platform axes; without a payload the platform frame's origin."""
        return np.zeros(3) if self.payload is None else self.payload.tool

    @property
    def home_position(self) -> Array:
        """Origin of the platform frame at home, (3,) [m], world axes."""
        return self.home.position

    @property
    def home_rotation(self) -> Array:
        """Platform axes to world axes at home, (3, 3)."""
        return self.home.matrix

    @property
    def home_tips(self) -> Array:
        """Platform joints at home, (n, 3) [m], world axes."""
        return self.platform_joints @ self.home_rotation.T + self.home_position

    @property
    def home_carriages(self) -> Array:
        """Positions of the carriages at home, (n,) [m, of a crank rad]; 0 of a leg that has none."""
        places = zip(self.legs, self.base_joints, self.home_tips, strict=True)
        return np.array([_carriage(leg, base, tip) for leg, base, tip in places])

    @property
    def home_bases(self) -> Array:
        """Base joints at home, (n, 3) [m], world axes: where the carriages are then."""
        places = zip(self.base_joints, self.legs, self.home_carriages, strict=True)
        return np.array([foot(base, leg.carriage, position) for base, leg, position in places])

    @property
    def home_vectors(self) -> Array:
        """Vectors from base to platform joint of every leg at home, (n, 3) [m], world axes."""
        return self.home_tips - self.home_bases

    @property
    def home_lengths(self) -> Array:
        """Joint-to-joint lengths at home, (n,) [m]."""
        return np.linalg.norm(self.home_vectors, axis=1)

    @property
    def normal(self) -> Array:
        """Axis z, or the normal of the plane of a planar robot, (3,)."""
        return normal_of(self.plane)

    def tables(self) -> dict[str, Any]:
        """Tables as they stand in a file, by name: as they were written where that still holds, else in SI."""
        home, fixed = self.home, {"fixed": True} if self.platform_fixed else {}
        above = not (home.rotation.any() or home.position[:2].any())
        places = zip(self.legs, self.base_joints, self.platform_joints, strict=True)
        legs = [to_plain_data(leg.told_at(base, platform, self.normal)) for leg, base, platform in places]
        alike = all(leg == legs[0] for leg in legs) and len({leg.chain for leg in self.legs}) == 1
        geometry = {
            "type": self.type,
            **({"plane": self.plane} if self.plane else {}),
            "base": {"joints": self.base_joints},
            "platform": {"joints": self.platform_joints, **fixed},
            **({"home_height": self.home_height} if above else {"home": home}),
            "gravity": self.gravity,
            **{name: mount for name, mount in _told_mounts(self)},
        }
        beside = {
            "payload": self.payload and self.payload.data(),
            "leg": legs[0] if alike else legs,
            **{name: part for name in ("geometry", "heat", "tolerances") if (part := getattr(self, name)) is not None},
        }
        found = self.data(geometry | {name: part for name, part in beside.items() if part is not None})
        tables = {name: to_plain_data(found[name]) for name in found if name in beside}
        return {"robot": to_plain_data({name: found[name] for name in found if name not in beside}), **tables}


def _at_height(height: Any, home: Home | None) -> Home:
    """Home at a height, else as it was: parallel to the world above the origin if there was none."""
    try:
        return Home(position=np.array([0.0, 0.0, height])) if home is None else home.raised(height)
    except InputError as error:
        raise InputError(error.what, key="robot.home_height", value=height, allowed=error.allowed) from None


def _carriage(leg: Leg, base: Array, tip: Array) -> float:
    """Position of the carriage of a leg at home [m, rad]; nan where its strut does not reach."""
    if leg.carriage is None:
        return 0.0
    if leg.strut is None:
        return leg.carriage.home or 0.0
    found = carriage_home(base, leg.carriage, tip, leg.strut.length)
    return math.nan if found is None else found


def _own_view(leg: Leg, base: Array, platform: Array, normal: Array) -> Leg:
    """The leg with its directions as seen from its own joints, along radial, tangential, normal: for comparisons."""
    changes: dict[str, object] = {}
    for name, joint, place in (("base_joint", leg.base_joint, base), ("platform_joint", leg.platform_joint, platform)):
        if joint.axis is not None:
            changes[name] = joint.replace(axis=_seen(joint.axis, place, normal))
    if (carriage := leg.carriage) is not None:
        arm = {} if carriage.arm is None else {"arm": _seen(carriage.arm, base, normal)}
        changes["carriage"] = carriage.replace(axis=_seen(carriage.axis, base, normal), **arm)
    return leg.replace(**changes) if changes else leg


def _seen(vector: Array, place: Array, normal: Array) -> Array:
    radial = axis_of("radial", place, normal)
    if radial is None:
        return vector
    return np.round(np.array([radial, np.cross(normal, radial), normal]) @ vector, 12)


def _told_mounts(robot: Robot) -> Iterator[tuple[str, object]]:
    for name in ("base_mount", "platform_mount"):
        if (mount := getattr(robot, name)) is not None:
            short = {key: diagonal(value) for key, value in mount.si_values().items()}
            given = {key: value for key, value in short.items() if key == "loss" or np.asarray(value).any()}
            yield name, mount.data(given)
    if robot.base_motion is not None:
        yield "base_motion", robot.base_motion


def read_robot(top: Section) -> Robot:
    """The robot of a study file, from its whole-file section."""
    fixed = platform_fixed(top)
    top.require_keys("robot", *(() if fixed else ("payload",)), "leg")
    section = top.child(top.data["robot"], "robot")
    section.check_keys("type", "plane", "base", "platform", "home_height", "home", "gravity", *_MOUNTS)
    section.require_keys(*_ENDS)
    plane = top.plane = section.plane = section.text("plane", ("xy", "yz", "zx"))
    kind = section.text("type")
    kind = "6-UPS" if kind is None else kind
    try:
        chains = chains_of(kind)
    except InputError as error:
        raise error.with_location(file=top.file, prefix="robot.type") from None
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
    return robot.attach_source(SourceTable({**section.data, **beside}))


def platform_fixed(top: Section) -> bool:
    """Tell whether a study file says that the platform is held."""
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
    counts = [section.integer("count") or (count if single else 1) for section in sections]
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
    """Tell whether the leg has directions that depend on where it stands."""
    tables = [leg.data.get(name) for name in ("base_joint", "platform_joint", "carriage")]
    return any(isinstance(table, Mapping) and {"slider", "crank", "axis"} & table.keys() for table in tables)


def _columns(leg: Leg) -> bool:
    """Tell whether a table has a column for each leg."""
    return getattr(leg.drive, "time", None) is not None
