"""Ends of a leg: joints, and carriages that move its foot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.axes import axis_of, within_a_turn, word_of
from flexapod.common.tables.base import Key, Loss, Matrix6, Quantity, Vec3
from flexapod.common.tables.table import Table
from flexapod.model.leg.friction import JointFriction
from flexapod.model.leg.joint_stiffness import read_stiffness
from flexapod.model.leg.rolling import RollingLaw

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

NO_DIRECTION = 1e-9  # length of a vector below which it is none


class Joint(Table):
    """A joint at an end of a leg.

    `axis` (3,): of a revolute joint its axis, of a universal joint the direction of the axis that is fixed to the base
    (world axes) or to the platform (platform axes); None where it follows from the leg.
    `bending`, `torsion` [N m/rad]: of springs across and about the leg; None: free as the letter of the joint says,
    and rigid of a fixed joint.
    `stiffness` (6, 6) [N/m, N, N m/rad]: of a flexure, along and about the axes of base or platform, or, with
    `leg_axes`, those of the leg, z along it.
    `damping` [N m s/rad] beside `bending` and `torsion`, or `loss`, a loss factor of all springs of the joint, which is
    made viscous at home (T13.19); `stiffness_damping` [N s/m], `stiffness_loss`: of `stiffness` along the leg's axes by
    itself.
    `friction` in it. `play` [m]: free travel along the leg, from one end to the other. `eccentricity` [m]: of its
    centre from the axis of the leg. `max_angle` [rad]: how far the leg may turn there from its direction at home.
    `rolling`: the law from which `stiffness`, `leg_axes`, `stiffness_damping` and `stiffness_loss` follow.
    """

    _source: ClassVar[str] = "the law of its bearings"

    derived: ClassVar[tuple[str, ...]] = ("leg_axes", "stiffness_damping", "stiffness_loss", "rolling")

    placed: ClassVar[tuple[str, ...]] = ("at", "axis")
    spells: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "stiffness": ("stiffness", "leg_axes", "stiffness_damping", "stiffness_loss", "rolling")
    }

    axis: Annotated[Vec3 | None, Quantity("number")] = None
    bending: Annotated[
        float | None, Quantity("rotational stiffness", least=0, why="spring across the leg", usual="free; of F rigid")
    ] = None
    torsion: Annotated[
        float | None, Quantity("rotational stiffness", least=0, why="spring about the leg", usual="free; of F rigid")
    ] = None
    stiffness: Annotated[
        Matrix6 | None,
        Quantity(
            "stiffness",
            "force",
            "rotational stiffness",
            why="springs along the axes: a number, a table, three or six rows",
            usual="rigid",
        ),
    ] = None
    damping: Annotated[float | None, Quantity("rotational damping", least=0, why="of `bending` and `torsion`")] = None
    loss: Annotated[
        Loss | None,
        Key(
            "loss factor of all springs of the joint, in place of `damping`; made viscous at the first frequency "
            "at home"
        ),
    ] = None
    leg_axes: bool = False
    friction: Annotated[JointFriction | None, Key("table: friction of the joint", usual="none")] = None
    play: Annotated[
        float | None,
        Quantity(
            "length",
            least=0,
            why="free travel along the leg, from one end to the other: for `flexapod.accuracy` and `flexapod.play`",
            usual="none",
        ),
    ] = None
    eccentricity: Annotated[
        float | None,
        Quantity(
            "length",
            least=0,
            why="distance of its centre from the axis of the leg: for `flexapod.accuracy`",
            usual="none",
        ),
    ] = None
    max_angle: Annotated[
        float | None,
        Quantity("angle", above=0, why="largest angle of the leg there from its direction at home", usual="no limit"),
    ] = None
    stiffness_damping: Annotated[float | None, Quantity("damping", least=0)] = None
    stiffness_loss: Loss | None = None
    rolling: RollingLaw | None = None

    if TYPE_CHECKING:  # what follows need not be given

        def __init__(self, **fields: Any) -> None: ...

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """The springs of a law."""
        law = RollingLaw._of(fields.get("rolling"))
        if law is None:
            return {}
        across = law.radial or law.k
        springs = {"stiffness": np.diag([across, across, law.k, 0.0, 0.0, 0.0]), "leg_axes": True}
        return springs | {"stiffness_damping": law.damping, "stiffness_loss": law.loss}

    def replace(self, **changes: Any) -> Joint:
        """A copy with some fields changed; what damps the springs of a law is its own.

        Another stiffness stands in place of a law.

        Raises
        ------
        InputError
            If a field does not exist, the new value is not allowed, or it contradicts others.
        """
        law = self.rolling
        if law is None or "rolling" in changes:
            return super().replace(**changes)
        if not {"stiffness", "leg_axes"}.isdisjoint(changes):
            return super().replace(rolling=None, **changes)
        own = {"stiffness_damping": "damping", "stiffness_loss": "loss"}
        if damped := {name: changes.pop(key) for key, name in own.items() if key in changes}:
            changes["rolling"] = law.replace(**damped)
        return super().replace(**changes)

    @property
    def lossy(self) -> bool:
        """Tell whether a loss factor damps a spring of it."""
        return bool(self.loss or self.stiffness_loss)

    @property
    def loss_of_stiffness(self) -> float | None:
        """Loss factor of `stiffness`: its own, or that of the joint."""
        return self.loss if self.stiffness_loss is None else self.stiffness_loss

    @model_validator(mode="after")
    def _damps_what_is_there(self) -> Joint:
        turns = self.bending is not None or self.torsion is not None
        there = {"damping": turns, "loss": turns or self.stiffness is not None}
        for name, has in there.items():
            if getattr(self, name) and not has:
                raise InputError("damps a spring that the joint does not have", key=name, value=getattr(self, name))
        for damping, loss in (("damping", "loss"), ("stiffness_damping", "stiffness_loss")):
            if getattr(self, damping) and getattr(self, loss):
                raise InputError(f"is given together with {loss}", key=damping, allowed="either of the two")
        return self

    @model_validator(mode="after")
    def _sensible(self) -> Joint:
        _check_direction(self.axis, "axis")
        if self.max_angle is not None and self.max_angle > np.pi:
            raise InputError(
                "is more than half a turn", key="max_angle", value=self.max_angle, allowed="0 to pi rad (180 deg)"
            )
        stiffness = self.stiffness
        if stiffness is None:
            return self
        size = np.abs(stiffness).max()
        if np.abs(stiffness - stiffness.T).max() > 1e-9 * size or np.linalg.eigvalsh(stiffness)[0] < -1e-9 * size:
            raise InputError(
                "belongs to no spring",
                key="stiffness",
                value=stiffness.tolist(),
                allowed="a symmetric matrix with no negative eigenvalue",
            )
        if stiffness[3:].any() and (self.bending is not None or self.torsion is not None):
            raise InputError(
                "is given together with six rows of stiffness, which hold it",
                key="torsion" if self.bending is None else "bending",
                allowed="either of the two",
            )
        return self

    @property
    def across_and_along(self) -> tuple[float, float] | None:
        """Stiffness across and along the leg [N/m], where the joint is held by such springs alone."""
        if self.stiffness is None or self.stiffness[3:].any():
            return None
        place = self.stiffness[:3, :3]
        across, along = float(place[0, 0]), float(place[2, 2])
        plain = np.array_equal(place, np.diag([across, across, along])) and (self.leg_axes or across == along)
        return (across, along) if plain and across > 0 and along > 0 else None

    @property
    def flexes(self) -> bool:
        """Tell whether its place gives way in axes of base or platform, or together with its angles."""
        return self.stiffness is not None and self.across_and_along is None

    def si_values(self) -> dict[str, object]:
        """All that it has to say in a file: its stiffness as a number, in rows, as a table or by its law."""
        fields, stiffness = super().si_values(), self.stiffness
        if self.rolling is not None:
            return fields | {"stiffness": self.rolling}
        if stiffness is None:
            return fields
        given = {"leg_axes": self.leg_axes, "damping": self.stiffness_damping, "loss": self.stiffness_loss}
        own = {name: value for name, value in given.items() if value}
        if self.leg_axes and self.across_and_along is not None:
            across, along = self.across_and_along
            del own["leg_axes"]
            return fields | {"stiffness": {"axial": along, "radial": across, **own}}
        if own:
            rows = stiffness if stiffness[3:].any() else stiffness[:3, :3]
            return fields | {"stiffness": {"rows": rows, **own}}
        return fields if self.across_and_along is None else fields | {"stiffness": self.across_and_along[0]}

    def told_at(self, place: Array, normal: Array) -> dict[str, object]:
        """Keys at its place (3,) [m], directions in words."""
        axis = {} if self.axis is None else {"axis": word_of(self.axis, place, normal) or self.axis}
        return self.data(self.si_values() | axis)


class Travel(Table):
    """Allowed positions of a carriage [m, of a crank rad]."""

    min: Annotated[float, Quantity("length", "angle", why="smallest position")]
    max: Annotated[float, Quantity("length", "angle", why="largest position, above the smallest")]

    @model_validator(mode="after")
    def _ordered(self) -> Travel:
        if self.min >= self.max:
            raise InputError("is not above min", key="max", value=self.max, allowed=f"above {self.min:g}")
        return self


class Carriage(Table):
    """Carriage that moves the foot of a leg: a slider along `axis`, or a crank about it.

    `axis` (3,), world axes; `arm` (3,) [m], of a crank: from its axis to the base joint at angle 0, world axes;
    `mass` [kg]; of a crank `inertia` [kg m^2] about its axis and `com` [m], its centre of mass from there towards the
    base joint. Of the two positions in which a strut reaches
    the platform at home `side` takes the larger (+1) or the smaller one (-1), else it is the one next to `home`
    [m, rad] (default 0). `stroke`: allowed positions.
    """

    derived: ClassVar[tuple[str, ...]] = ("kind", "axis")

    placed: ClassVar[tuple[str, ...]] = ("slider", "crank", "arm", "radius")
    spells: ClassVar[Mapping[str, tuple[str, ...]]] = {"slider": ("axis", "kind"), "crank": ("axis", "kind")}

    kind: Literal["slider", "crank"]
    axis: Annotated[Vec3, Quantity("number")]
    arm: Annotated[
        Vec3 | None,
        Quantity(
            "length", why="from the crank's axis to the base joint at angle 0, world axes", usual="given by radius"
        ),
    ] = None
    mass: Annotated[float, Quantity("mass", least=0, why="of a slider or a crank")] = 0.0
    inertia: Annotated[float, Quantity("inertia", least=0, why="of a crank, about its axis")] = 0.0
    com: Annotated[
        float | None,
        Quantity(
            "length", why="centre of mass of a crank, from its axis towards the base joint; behind the axis below 0"
        ),
    ] = None
    home: Annotated[
        float | None, Quantity("length", "angle", why="position near which it stands at home", usual="0")
    ] = None
    side: Annotated[
        Literal[1, -1] | None,
        Key(
            "1: of its two positions at home the larger one; -1: the smaller one", usual="the position nearest to home"
        ),
    ] = None
    stroke: Annotated[Travel | None, Key("table: allowed positions", usual="no limits")] = None

    @model_validator(mode="after")
    def _complete(self) -> Carriage:
        _check_direction(self.axis, self.kind)
        if self.kind == "crank" and self.home is not None:
            within_a_turn(self.home, "home")
        if self.side is not None and self.home is not None:
            raise InputError("is given together with home", key="side", value=self.side, allowed="either of the two")
        for name in ("inertia", "com"):
            if self.kind == "slider" and getattr(self, name):
                raise InputError("belongs to a crank", key=name, value=getattr(self, name))
        if self.inertia < (least := self.mass * (self.com or 0.0) ** 2) * (1 - 1e-9):
            raise InputError(
                "is less than that of the mass at its centre", key="inertia", value=self.inertia,
                allowed=f"at least mass com^2 = {least:.4g} kg m^2",
            )  # fmt: skip
        if (self.arm is None) == (self.kind == "crank"):
            raise InputError(
                "is missing" if self.kind == "crank" else "belongs to a crank",
                key="arm",
                next_step="It is the way from the crank's axis to the base joint" if self.kind == "crank" else None,
            )
        if self.arm is not None and np.linalg.norm(np.cross(self.unit, self.arm)) < 1e-9:
            raise InputError("lies along the axis", key="arm", value=self.arm.tolist(), allowed="across the axis")
        return self

    @property
    def unit(self) -> Vec3:
        """Unit vector of the axis, (3,)."""
        return self.axis / np.linalg.norm(self.axis)

    def told_at(self, place: Array, normal: Array) -> dict[str, object]:
        """Keys at its place (3,) [m], directions in words."""
        unused = "mass" if self.kind == "crank" else "inertia"
        fields = {name: value for name, value in self.si_values().items() if name != unused or value}
        return self.data({self.kind: word_of(self.axis, place, normal) or self.axis, **fields})


def _check_direction(axis: Vec3 | None, key: str) -> None:
    if axis is not None and np.abs(axis).max() < NO_DIRECTION:
        raise InputError("has no direction", key=key, value=axis.tolist(), allowed="a non-zero vector")


def read_joint(leg: Section, name: str, place: Array, normal: Array) -> Joint | None:
    """The joint of a table [leg] under `name`, at its place (3,) [m]; None where it says nothing of it."""
    axis = leg.vector("u_axis", "number", "number", "number") if name == "base_joint" else None
    if axis is not None and np.abs(axis).max() < NO_DIRECTION:
        raise leg.error("has no direction", "u_axis", allowed="a non-zero vector")
    section = leg.section(name)
    if section is None:
        return None if axis is None else Joint(axis=np.array(axis))
    if axis is not None and "axis" in section:
        raise leg.error("is given together with base_joint.axis", "u_axis", allowed="one of the two: they are the same")

    def parts(section: Section) -> dict[str, object]:
        return {"axis": axis or section.direction("axis", place, normal), **read_stiffness(section)}

    return section.read(Joint, also=("at",), then=parts)


def read_carriage(section: Section, base: Array, normal: Array) -> Carriage:
    """Carriage that moves the foot of a leg, from its table; `base` (3,) [m]: where it is at 0."""

    def parts(section: Section) -> dict[str, object]:
        if kind not in section:
            section.require_keys("slider")
        if "crank" in section and "slider" in section:
            raise section.error("is given together with slider", "crank", allowed="one of the two")
        axis = section.direction(kind, base, normal)
        arm = section.vector("arm", "length", "length", "length")
        radius = section.number("radius", "length")
        if radius is not None:
            if arm is not None or axis is None or kind == "slider":
                raise section.error("does not fit here", "radius", allowed="of a crank, in place of arm")
            try:
                arm = arm_of(radius, axis, base, normal)
            except InputError as error:
                raise section.locate(error) from None
        return {"kind": kind, "axis": axis, "arm": arm}

    kind = "crank" if "crank" in section else "slider"
    among = ("length",) if kind == "slider" else ("angle",)
    try:
        return section.read(Carriage, among=among, also=("slider", "crank", "radius"), then=parts)
    except InputError as error:
        if error.key != section.key("axis"):
            raise
        raise section.error(error.what, kind, allowed=error.allowed) from None


def arm_of(radius: float, axis: Array, base: Array, normal: Array) -> Array:
    """Arm of a crank at angle 0: radial as far as the axis lets it, else tangential."""
    unit = axis / np.linalg.norm(axis)
    for word in ("radial", "tangential"):
        if (direction := axis_of(word, base, normal)) is not None:
            across = direction - (direction @ unit) * unit
            if (size := float(np.linalg.norm(across))) > 1e-6:
                return radius * across / size
    raise InputError("has no direction to begin in", key="radius", allowed="arm = [x, y, z] for this crank")
