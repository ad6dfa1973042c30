"""Element of a leg: table, coordinates, numbers, energies, errors, outputs of one part, in one class.

The class stands for its equations, which hold for all legs; its objects are the part in one leg.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import FunctionType, SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Self

from flexapod.common.errors import InputError
from flexapod.common.lazy_imports import lazy_attributes
from flexapod.common.tables.table import Table
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.trial import refuse_declared, source_of
from flexapod.mechanics.symbolic.vocabulary import dot, sqrt, vertcat

if TYPE_CHECKING:
    from flexapod.common.arrays import Array
    from flexapod.mechanics.elements.distribution import PistonMotion
    from flexapod.mechanics.elements.frames import Frame
    from flexapod.mechanics.elements.slot import Slot
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg, Robot, Simulation

Named = tuple[tuple[str, int], ...]


class LegContext(NamedTuple):
    """Circumstances of a leg from which its elements compute their parameters.

    ``length`` [m]: joint to joint, at home; ``per_loss`` [s]: viscous damping over stiffness of a spring of loss factor
    1; ``at_rest``: loops that sum their errors have left none; ``robot``: the one whose leg it is; ``attitude``: the
    payload fixes the attitude of its tip, not the place alone; ``axes``: of its joints ("base", "platform"), rotations
    to the axes in which they give way from those of what they stand on, and from those of the leg.
    """

    length: float
    per_loss: float
    at_rest: bool
    robot: Robot
    attitude: bool
    axes: Mapping[str, tuple[Array, Array]]


@dataclass(frozen=True)
class SeriesSprings:
    """Springs in series between a rotor and a stroke, as elements change them.

    ``softer``: their compliance over that at home; ``nut`` and ``rate``: where they end, and how fast that moves.
    """

    softer: SX | float
    nut: SX
    rate: SX | float


class Output(NamedTuple):
    """A result of an element, a number for each instant and leg.

    ``of``: gives it from parameters and coordinates by name, as the energies do; arrays over time.

    Examples
    --------
    >>> force = fx.Output("force", "N", "force of the seal along the leg", lambda p, q: p.k * q.z)
    >>> force.name, force.units
    ('force', 'N')
    """

    name: str
    units: str
    long_name: str
    of: Callable[[Any, Any], Any]


class Contribution(NamedTuple):
    """Contribution of an element to the error of a stroke, for an error budget.

    ``size`` [m], or what gives it by the length of the leg [m]: a standard deviation of ``kind`` "random", half of the
    width of "hysteretic"; ``how`` it is computed; ``stands``: a random one is the same at each approach of one machine.

    Examples
    --------
    >>> seat = fx.Contribution("seat", "hysteretic", 1e-6, "half of the seat's play")
    >>> seat.kind, seat.size, seat.stands
    ('hysteretic', 1e-06, False)
    """

    name: str
    kind: Literal["random", "hysteretic"]
    size: float | Callable[[float], float]
    how: str
    stands: bool = False


@dataclass(frozen=True, kw_only=True)
class _InLeg:
    """A leg: parameters, coordinates, rates by name (``p``, ``q``, ``v``), and all ``elements`` of the kernel."""

    p: SimpleNamespace
    q: SimpleNamespace
    v: SimpleNamespace
    elements: Sequence[Slot]

    def holds(self, kind: type[Physics]) -> bool:
        """Test whether the kernel has an element of a kind."""
        return any(element.kind is kind for element in self.elements)


@dataclass(frozen=True, kw_only=True)
class Along(_InLeg):
    """A leg along its chain, for energies that need more than its coordinates.

    ``p``, ``q``, ``v``, ``elements`` by name. ``base``: frame of a base that moves, at the origin while it is where it
    is drawn; ``foot`` and ``cylinder``: frames before and behind the base joint (`Frame`), z along the leg; ``piston``:
    its fields and what moves them. Parameters of the leg are in ``p`` as well: ``p.gravity`` (3,) [m/s^2].

    Examples
    --------
    >>> def energy_along(cls, x):  # a point beside the cylinder, by `Element.energy_along`
    ...     point = x.cylinder.moved(x.p.place, zeros(3))
    ...     return fx.Energies(gravity=point.weight(x.p.gravity, x.p.mass, zeros(3)))
    >>> fx.Along.__dataclass_fields__.keys() >= {"p", "q", "v", "base", "foot", "cylinder", "piston"}
    True
    """

    base: Frame | None
    foot: Frame
    cylinder: Frame
    piston: PistonMotion


@dataclass(frozen=True, kw_only=True)
class MovingLeg(_InLeg):
    """Leg in motion, for hooks of elements that need more than its coordinates.

    ``p``, ``q``, ``v``, ``elements`` by name. ``q_cmd`` and ``v_cmd``: what is commanded to its rotor, if it has one;
    ``foot`` and ``tip``: places of its joints in the world; ``rate``: gives the rate of an expression.
    """

    q_cmd: SX
    v_cmd: SX
    foot: SX
    tip: SX
    rate: Callable[[SX], SX]

    @property
    def distance(self) -> SX:
        """Distance between the joints of the leg [m]."""
        along = self.tip - self.foot
        return sqrt(dot(along, along))


class Physics:
    """A physical part of a leg: what it adds to the equations, to the results and to the error budget.

    Attributes
    ----------
    at : str
        NAME of its table in a leg; none of what is in other tables.
    end : {"base", "", "platform"}
        Of a leg where it stands; none of what is between. Energies are summed from base to platform.
    coordinates, parameters : tuple of (name, size)
        What it adds to the coordinates of a leg, and to the numbers that its equations read, in SI.
    absent : mapping
        Its parameters in a leg without it, beside one that has it; 0 if they are not named here.
    follows : mapping
        Its coordinates that are as others are in a leg that carries nothing: own name -> the other's.
    rubs_at : str
        Where it rubs, as results name it; by default NAME.
    outputs : tuple of Output
        Its results.
    """

    at: ClassVar[str] = ""
    end: ClassVar[Literal["base", "", "platform"]] = ""
    coordinates: ClassVar[Named] = ()
    parameters: ClassVar[Named] = ()
    absent: ClassVar[Mapping[str, Any]] = {}
    follows: ClassVar[Mapping[str, str]] = {}
    rubs_at: ClassVar[str] = ""
    outputs: ClassVar[tuple[Output, ...]] = ()

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the part in one leg; None of a leg without it."""
        return None

    @classmethod
    def all_of(cls, leg: Leg) -> tuple[Self, ...]:
        """All parts of this kind in one leg."""
        own = cls.of(leg)
        return () if own is None else (own,)

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Test whether a kernel for the legs of a robot includes this kind of element."""
        return any(cls.all_of(leg) for leg in robot.legs)

    def numbers(self, leg: Leg, standing: LegContext) -> Mapping[str, Any]:
        """Parameters of the element in one leg, by name."""
        return {}

    def without_ripple(self, leg: Leg) -> Leg:
        """Leg without periodic forces such as ripple, in whose period the position at rest is unknown."""
        return leg

    def errors(self, leg: Leg) -> Sequence[Contribution]:
        """Contributions of the element to the error of the stroke of one leg."""
        return ()

    @classmethod
    def prescribed(cls, own: Any, leg: Leg, standing: LegContext) -> Sequence[str]:
        """Coordinates that follow a table in one leg: by default those of an element that the leg does not have.

        Of a coordinate that several elements have all have to say so.
        """
        return () if own is not None else tuple(name for name, _ in cls.coordinates)

    @classmethod
    def energy(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Energies:
        """Energies of the element from parameters, coordinates and rates."""
        return Energies()

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energies of an element that needs frames of the leg or the other elements; in place of `energy`."""
        return cls.energy(x.p, x.q, x.v)

    @classmethod
    def damping_force(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Mapping[str, SX]:
        """Damping forces by coordinate without a dissipation: 0 at rest, positive at a positive rate.

        Its power is lost, as that of a dissipation.
        """
        return {}

    @classmethod
    def base_frame(cls, base: Frame | None, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Frame | None:
        """Frame of the base on the element, from the frame that carries this; None: the base stands still."""
        return base

    @classmethod
    def sliding_speed(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SX:
        """Sliding speed of the element's friction in each of its `friction_directions`.

        Its first parameter then is what `friction.bristle_friction` reads.
        """
        return vertcat()

    @classmethod
    def friction_directions(cls, has: Callable[[str], bool]) -> Sequence[str]:
        """Directions in which it slides with friction, in legs that have some coordinates, as results name them."""
        return ()

    @classmethod
    def has_friction(cls, leg: Leg) -> bool:
        """Test whether the element has friction in one leg."""
        return bool(cls.all_of(leg)) and bool(cls.friction_directions(lambda name: True))

    @classmethod
    def friction_unit(cls, leg: Leg) -> float:
        """Ratio of friction in the element's table to friction in the equations."""
        return 1.0

    @classmethod
    def in_series(cls, s: SeriesSprings, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SeriesSprings:
        """Springs in series between rotor and stroke with what the element changes in them."""
        return s

    @classmethod
    def gap_deflection(cls, x: SX, rate: SX, p: SimpleNamespace) -> tuple[SX, SX]:
        """Stretch of the springs before a stroke, and its rate, from the displacement of their ends."""
        return x, rate

    @classmethod
    def loop_force(cls, p: SimpleNamespace, q: SimpleNamespace) -> SX | None:
        """Force that a rotor's loop requests because of the element [N], beside its spring and damper; or None."""
        return None

    @classmethod
    def nonpotential_force(cls, x: MovingLeg) -> Mapping[str, SX]:
        """Nonpotential terms in the balance of coordinates, by name; forces on these are negative here."""
        return {}

    @classmethod
    def inertia(cls, p: SimpleNamespace) -> Mapping[str, tuple[SX | float, SX | float]]:
        """Mass and damper of coordinates of its own that have them without an energy, by name."""
        return {}

    @classmethod
    def input_power(cls, x: MovingLeg) -> SX | None:
        """Power that enters by the element's nonpotential forces."""
        return None


class Element(Physics, Table):
    """An element with a table of its own in a leg, ``[leg.NAME]``, or several, ``[[leg.NAME]]``; base of users' ones.

    Fields are keys of the table: ``stiffness: Annotated[float, fx.Quantity("stiffness", above=0)]``. Names of
    coordinates, parameters and results are its own; beside those of others NAME stands before them. What it has and can
    do is in `Physics`. It is known once its module is imported, or by an entry point NAME of its package in the group
    ``flexapod.elements``.

    Raises
    ------
    InputError
        A class that comes from no file, or whose names are taken.
    """

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        _take_former_hooks(cls)
        if "at" in vars(cls):
            register(cls)

    @classmethod
    def all_of(cls, leg: Leg) -> tuple[Self, ...]:
        """Elements of this class in the tables of one leg, in their order."""
        return tuple(one for one in leg.elements if type(one) is cls)


__getattr__: Callable[[str], object] = lazy_attributes(__name__, {}, {"Moving": "MovingLeg", "Standing": "LegContext"})

#: Hooks by the names of the release before, and now: both the overrides and the calls answer for one release.
FORMER_HOOKS = {
    "among": "in_kernel", "asked": "loop_force", "carries": "base_frame", "given": "input_power", "held": "prescribed",
    "past": "gap_deflection", "pushes": "nonpotential_force", "rubs": "has_friction", "slides": "sliding_speed",
    "smoothed": "without_ripple", "ways": "friction_directions",
}  # fmt: skip


def _take_former_hooks(element: type[Element]) -> None:
    """Make overrides under former names those of the hooks, with a remark."""
    for former, hook in FORMER_HOOKS.items():
        own = vars(element).get(former)
        if isinstance(own, classmethod | FunctionType) and hook not in vars(element):
            warnings.warn(
                f"flexapod.Element.{former} is {hook} now: rename it in {element.__name__}", FutureWarning, stacklevel=3
            )
            setattr(element, hook, own)


def _former_hook(former: str, hook: str) -> Any:
    """Make the attribute of a former name: the hook, or that of `Physics` for an override that calls `super()`."""

    def forward(holder: Any, *args: Any) -> Any:
        warnings.warn(f"flexapod.Element.{former} is {hook} now", FutureWarning, stacklevel=2)
        own = holder if isinstance(holder, type) else type(holder)
        above = own.__mro__[: own.__mro__.index(Element)]
        overridden = any(isinstance(vars(c).get(former), classmethod | FunctionType) for c in above)
        found: Any = super(Element, holder) if overridden else holder  # type: ignore[reportArgumentType]
        return getattr(found, hook)(*args)

    return classmethod(forward) if isinstance(vars(Physics)[hook], classmethod) else forward


for _former, _hook in FORMER_HOOKS.items():
    setattr(Element, _former, _former_hook(_former, _hook))

registered: dict[str, type[Element]] = {}


def register(element: type[Element]) -> None:
    """Make a class known by the name of its table.

    Raises
    ------
    InputError
        It comes from no file, its names are taken, or it declares what is none of its own.
    """
    name = element.at
    if source_of(element) is None:
        raise InputError(
            "is an element without a file: the equations are compiled anew when their source changes",
            value=element.__name__,
            allowed="a class in a module",
            next_step="Write it into a file of its own and import that",
        )
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise InputError("is not a name for a table", value=name, allowed="small letters, digits and _")
    refuse_declared(element)
    other = registered.get(name)
    if other is not None and (other.__module__, other.__qualname__) != (element.__module__, element.__qualname__):
        raise InputError(
            "is the table of another element", value=name, allowed=f"a name that {other.__module__} does not have"
        )
    registered[name] = element


def extra_loop_force(elements: Sequence[Slot], p: SimpleNamespace, q: SimpleNamespace) -> SX | None:
    """Sum of the forces that elements request beside a loop's spring and damper; None if none does."""
    found = [x for element in elements if (x := element.loop_force(p, q)) is not None]
    return sum(found[1:], found[0]) if found else None
