"""Friction of joints, screws and strokes, with what bends before it slides, Eqs. (T19.9)-(T19.11)."""

from __future__ import annotations

from typing import Annotated

from pydantic import model_validator

from flexapod.common.errors import InputError
from flexapod.common.quantities import number
from flexapod.common.tables.base import Key, Quantity
from flexapod.common.tables.table import Table

SHORTEST, LEAST = 1e-10, 1e-8  # m, less than an atom; rad, that on a radius of 10 mm
STICKIEST = 2.0  # coefficient of friction: plain joints have 0.02 to 0.25


class TurningStribeck(Table):
    """More friction at low rates: the `moment` [N m] of breaking away, and the `rate` [rad/s] at which it is lost."""

    moment: Annotated[float, Quantity("torque", above=0)]
    rate: Annotated[float, Quantity("angular rate", above=0, why="at which more than half of the excess is lost")]


class SlidingStribeck(Table):
    """More friction at low rates: the `force` [N] of breaking away, and the `rate` [m/s] at which it is lost."""

    force: Annotated[float, Quantity("force", above=0, why="to break away, at least that of sliding")]
    rate: Annotated[float, Quantity("velocity", above=0, why="at which more than half of the excess is lost")]


class JointFriction(Table):
    """Friction in a joint, about each of its axes; of a ball about that about which it turns.

    `moment` [N m]; or `mu`, the coefficient of a plain joint of mean `diameter` [m]; or of a rolling one `M0` [N m]
    and `f1` times load times `diameter`. `viscous` [N m s/rad]; `presliding` [rad]: angle over which it builds up;
    `damping_time` [s]: damping over stiffness of what bends before it slides.
    """

    moment: Annotated[
        float | None, Quantity("torque", above=0, why="about each axis, whatever the load", usual="given by mu or M0")
    ] = None
    mu: Annotated[
        float | None,
        Quantity(
            "number", above=0, why="coefficient of friction of a plain joint, with diameter", usual="given by moment"
        ),
    ] = None
    M0: Annotated[
        float | None, Quantity("torque", least=0, why="moment of a rolling joint without load", usual="given by moment")
    ] = None
    f1: Annotated[
        float | None, Quantity("number", least=0, why="moment of a rolling joint over load and diameter", usual="0")
    ] = None
    diameter: Annotated[
        float | None, Quantity("length", above=0, why="mean diameter at which it rubs or rolls", usual="none")
    ] = None
    viscous: Annotated[float, Quantity("rotational damping", least=0, why="moment by rate")] = 0.0
    stribeck: Annotated[TurningStribeck | None, Key("table: more friction at low rates", usual="none")] = None
    presliding: Annotated[
        float, Quantity("angle", above=0, why="angle over which friction builds up before anything slides")
    ] = 1e-3  # defaults: see T19
    damping_time: Annotated[
        float, Quantity("time", least=0, why="damping over stiffness of what bends before it slides")
    ] = 0.0

    @model_validator(mode="after")
    def _one_law(self) -> JointFriction:
        given = [name for name in ("moment", "mu", "M0") if getattr(self, name) is not None]
        if len(given) != 1:
            raise InputError(
                "is given together with " + given[0] if given else "is missing",
                key=given[1] if given else "moment",
                allowed="one of moment; mu and diameter; M0, with or without f1 and diameter",
            )
        if self.f1 is not None and given != ["M0"]:
            raise InputError("belongs to M0", key="f1", value=self.f1, allowed="M0, f1 and diameter of a rolling joint")
        needed = self.mu is not None or bool(self.f1)
        if needed != (self.diameter is not None):
            what = "is missing: with it the moment grows with the load" if needed else "is of no use without mu or f1"
            raise InputError(what, key="diameter", value=self.diameter)
        if given == ["M0"] and not (self.M0 or self.f1):
            raise InputError("and f1 leave no friction", key="M0", value=self.M0, allowed="one of them above 0")
        if self.mu is not None and self.mu > STICKIEST:
            raise InputError(
                "is more than what slides has", key="mu", value=self.mu,
                allowed=f"at most {STICKIEST:g}; plain joints have 0.02 to 0.25",
            )  # fmt: skip
        _bends(self.presliding, LEAST, "rad")
        if self.stribeck is not None and self.moment is None:
            raise InputError("belongs to a constant moment", key="stribeck", allowed="together with moment")
        _breaks_away(self.moment, self.stribeck and self.stribeck.moment, "moment", "N m")
        return self

    @property
    def constant(self) -> float:
        """Moment without load [N m]."""
        return self.moment or self.M0 or 0.0

    @property
    def arm(self) -> float:
        """Moment by load [m], Eqs. (T19.9)-(T19.10)."""
        if self.mu is not None:
            return 0.5 * self.mu * (self.diameter or 0.0)  # (T19.9)
        return (self.f1 or 0.0) * (self.diameter or 0.0)  # (T19.10)

    @property
    def numbers(self) -> tuple[float, ...]:
        """Numbers that the equations read, see `elements.friction.bristle_friction`; by angles."""
        return _numbers(self, self.constant, self.arm, self.stribeck and self.stribeck.moment)


class ScrewFriction(Table):
    """Friction of a screw at its nut, by the screw's angle, whatever the thrust: preload, seals, bearing.

    `torque` [N m]; `viscous` [N m s/rad]; `presliding` [rad]; `damping_time` [s] as of a joint.
    """

    torque: Annotated[float, Quantity("torque", above=0, why="of a screw, at its nut, whatever the thrust")]
    viscous: Annotated[float, Quantity("rotational damping", least=0, why="by rate")] = 0.0
    stribeck: Annotated[TurningStribeck | None, Key("table: more friction at low rates", usual="none")] = None
    presliding: Annotated[
        float,
        Quantity(
            "angle", above=0, why="angle of the screw, or travel, over which friction builds up before anything slides"
        ),
    ] = 0.01
    damping_time: Annotated[
        float, Quantity("time", least=0, why="damping over stiffness of what bends before it slides")
    ] = 0.0

    @model_validator(mode="after")
    def _sensible(self) -> ScrewFriction:
        _bends(self.presliding, LEAST, "rad")
        _breaks_away(self.torque, self.stribeck and self.stribeck.moment, "moment", "N m")
        return self

    @property
    def numbers(self) -> tuple[float, ...]:
        """Numbers that the equations read, by the screw's angle."""
        return _numbers(self, self.torque, 0.0, self.stribeck and self.stribeck.moment)

    @property
    def static(self) -> float:
        """Torque of breaking away [N m]."""
        return self.torque if self.stribeck is None else self.stribeck.moment


class StrokeFriction(Table):
    """Friction of a stroke, along it: seals, guide.

    `force` [N]; `viscous` [N s/m]; `presliding` [m]; `damping_time` [s] as of a joint.
    """

    force: Annotated[float, Quantity("force", above=0, why="along the stroke")]
    viscous: Annotated[float, Quantity("damping", least=0, why="by rate")] = 0.0
    stribeck: Annotated[SlidingStribeck | None, Key("table: more friction at low rates", usual="none")] = None
    presliding: Annotated[
        float,
        Quantity(
            "length", above=0, why="angle of the screw, or travel, over which friction builds up before anything slides"
        ),
    ] = 1e-5
    damping_time: Annotated[
        float, Quantity("time", least=0, why="damping over stiffness of what bends before it slides")
    ] = 0.0

    @model_validator(mode="after")
    def _sensible(self) -> StrokeFriction:
        _bends(self.presliding, SHORTEST, "m")
        _breaks_away(self.force, self.stribeck and self.stribeck.force, "force", "N")
        return self

    @property
    def numbers(self) -> tuple[float, ...]:
        """Numbers that the equations read, along the stroke."""
        return _numbers(self, self.force, 0.0, self.stribeck and self.stribeck.force)

    @property
    def static(self) -> float:
        """Force of breaking away [N]."""
        return self.force if self.stribeck is None else self.stribeck.force


#: What drives have of it.
Rubs = Annotated[StrokeFriction | None, Key("table: friction of the stroke, of a screw at its nut", usual="none")]


def _numbers(
    friction: JointFriction | ScrewFriction | StrokeFriction, sliding: float, arm: float, static: float | None
) -> tuple[float, ...]:
    excess, slower = 0.0, 0.0
    if static is not None and friction.stribeck is not None:
        excess, slower = static / sliding - 1, 1 / friction.stribeck.rate  # (T19.11)
    return sliding, arm, friction.presliding, excess, slower, friction.viscous, friction.damping_time


def _bends(presliding: float, least: float, unit: str) -> None:
    """Raise InputError if what bends before it slides is shorter than an atom."""
    if presliding < least:
        raise InputError(
            "is less than an atom, as a way: contacts bend by micrometres before they slide",
            key="presliding",
            value=presliding,
            allowed=f"at least {least:g} {unit}",
            next_step="Leave it out, or take a tenth of the smallest motion that matters",
        )


def _breaks_away(sliding: float | None, static: float | None, key: str, unit: str) -> None:
    """Raise InputError if what breaks away is less than what slides."""
    if sliding is not None and static is not None and static < sliding:
        raise InputError(
            "is less than what it falls to when sliding",
            key=f"stribeck.{key}",
            value=static,
            allowed=f"at least {number(sliding)} {unit}",
        )
