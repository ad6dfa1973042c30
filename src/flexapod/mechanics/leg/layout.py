"""Order of coordinates and parameters of a leg and of the payload, as kernels read them. No casadi here."""

from dataclasses import dataclass
from functools import cached_property

from flexapod.mechanics.elements.element import Physics
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.leg.leg_beam import LegBeam
from flexapod.mechanics.leg.leg_chain import POSE_PARAMETERS, LegChain

#: Physical parameters of one leg, in the order in which kernels read them (name, size). SI; vectors in the world frame.
LEG_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("rhoA", 1),  # kg/m
    ("EI", 1),  # N m^2
    ("EA", 1),  # N
    ("Lp", 1),  # m, whole piston
    ("mouth", 1),  # m, cylinder's mouth from the U joint
    ("piston_axial_inertia", 1),  # kg m^2
    ("cylinder_mass", 1),  # kg
    ("cylinder_com", 1),  # m, from the U joint
    ("cylinder_inertia", 1),  # kg m^2, transverse, about its CoM
    ("cylinder_axial_inertia", 1),  # kg m^2
    ("zeta", 1),  # modal damping ratio
    ("damping_time", 1),  # s, damping matrix over stiffness matrix
    ("drive_stiffness", 1),  # N/m, between command and stroke
    ("drive_damping", 1),  # N s/m
    ("gravity", 3),  # m/s^2
    ("base", 3),  # m, U joint
    ("R0", 9),  # leg home frame to world, column by column
    ("tip_mass", 1),  # kg
    ("tip_inertia", 1),  # kg m^2, transverse
)

PLATFORM_JOINT: tuple[tuple[str, int], ...] = (("joint", 3),)  # of legs with a ball, as in `POSE_PARAMETERS`

#: Physical parameters of the payload in kernel order (name, size); tool from the CoM, in platform axes.
PAYLOAD_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("mass", 1),  # kg
    ("inertia", 9),  # kg m^2 about the CoM, platform axes, column by column
    ("gravity", 3),  # m/s^2
    ("tool", 3),  # m
)
#: ... of one on a mount: the plate below it.
PLATE_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("plate_mass", 1),  # kg
    ("plate_weighs", 1),  # kg, of it
    ("plate_inertia", 9),  # kg m^2, about its centre of mass
    ("plate_at", 3),  # m, this point, where the mount is, from the payload's CoM
)

#: Coordinates of elements that stand beside those of piston and drive, in this order; of others behind all but frames'.
DRIVE = ("t", "r", "w", "j")
#: ... and of frames that move, last.
FRAMES = ("g", "m", "f")

#: Parameters of elements that stand before those of the joint at the payload.
PISTON = ("GJ", "tip_axial_inertia")

#: Commands that the spring of a drive reads: place and rate.
COMMAND_SIZE = 2

#: Load on a tip without payload: force and moment in the world's axes, force and moment that follow the tip's axes.
LOAD_SIZE = 12


def columns(layout: tuple[tuple[str, int], ...], name: str) -> slice:
    """Columns of a parameter in the flat vectors of a layout."""
    names = [key for key, _ in layout]
    start = sum(size for _, size in layout[: names.index(name)])
    return slice(start, start + dict(layout)[name])


@dataclass(frozen=True, kw_only=True)
class Shapes:
    """Composition of one kernel: the beam, the joints and the elements of a leg.

    Attributes
    ----------
    beam : LegBeam
        Its bases, and what its piston is made of.
    chain : LegChain
        Joints of a leg.
    elements : tuple of Slot
        What else its legs have, see `elements.known`.
    """

    beam: LegBeam
    chain: LegChain
    elements: tuple[Slot, ...] = ()

    @cached_property
    def layout(self) -> tuple[tuple[str, int], ...]:
        """Coordinates q of the leg (name, size); a planar leg has no alpha and no direction b."""
        own = {name: size for element in self.elements for name, size in element.coordinates}
        ends = {f"{end}{k}": 1 for end in "ue" for k in (1, 2, 3) if f"{end}{k}" in own}
        drive = tuple((name, own[name]) for name in DRIVE if name in own)
        others = tuple((name, size) for name, size in own.items() if name not in (*DRIVE, *ends, *FRAMES))
        frames = tuple((name, own[name]) for name in FRAMES if name in own)
        base, more, platform = (_one_each(names) for names in (self.chain.base, self.chain.more, self.chain.platform))
        first = (*base, *self.beam.amplitudes, *more)
        return (*first, *drive, *platform, *ends.items(), *self.beam.inside, *others, *frames)

    @cached_property
    def size(self) -> int:
        """Number of coordinates of the leg."""
        return sum(size for _, size in self.layout)

    @property
    def rows(self) -> int:
        """Rows of the closure: 0, 3 or 6."""
        return self.chain.rows

    @property
    def shared_coordinates(self) -> tuple[int, ...]:
        """Positions of the coordinates that all legs share: those of the plates on mounts, the payload's first."""
        return tuple(self.index(name) + k for name in ("m", "f") if self.has(name) for k in range(6))

    @property
    def plate(self) -> int:
        """Number of shared coordinates that the payload's functions read."""
        return 6 * self.has("m")

    @property
    def reads_pose(self) -> bool:
        """True where the functions of a leg read the payload's pose; else those of a ball on the payload do."""
        return self.has("gamma1") or self.has("m")

    @cached_property
    def pivots(self) -> tuple[int, ...]:
        """Positions of the coordinates that the closure determines, one for each of its rows."""
        return tuple(self.index(name) for name in self.chain.pivots)

    @property
    def drives(self) -> tuple[tuple[str, str], ...]:
        """Coordinates on which drives have springs, and how their parameters are called."""
        more = (("chi", "carriage", self.has("chi")), ("r", "rotor", self.has("r")))
        return (("l", "drive"), *((name, called) for name, called, there in more if there))

    @property
    def commands(self) -> int:
        """Number of commands that these springs read."""
        return COMMAND_SIZE * len(self.drives)

    @property
    def has_tip_load(self) -> bool:
        """True where a load acts on the tip, in space without a payload."""
        return self.chain.has_tip_load

    @property
    def friction_elements(self) -> tuple[tuple[Slot, int], ...]:
        """Elements with friction, and in how many directions they slide: a bristle for each."""
        found = ((slot, len(slot.kind.friction_directions(self.has))) for slot in self.elements)
        return tuple((slot, count) for slot, count in found if count)

    @property
    def friction_parameters(self) -> tuple[tuple[str, int], ...]:
        """Number of sliding directions of each element with friction, by the name of its parameters."""
        return tuple((slot.parameters[0][0], count) for slot, count in self.friction_elements)

    @cached_property
    def bristles(self) -> int:
        """Number of bristles of the leg."""
        return sum(count for _, count in self.friction_parameters)

    @property
    def l_index(self) -> int:
        """Position of the reference length l in q."""
        return self.index("l")

    def holds(self, kind: type[Physics]) -> bool:
        """Test whether the leg has an element of a kind."""
        return any(element.kind is kind for element in self.elements)

    def has(self, name: str) -> bool:
        """Test whether the leg has a coordinate of this name."""
        return name in self._first

    def index(self, name: str) -> int:
        """Position of a coordinate in q; of amplitudes that of the first."""
        return self._first[name]

    @cached_property
    def _first(self) -> dict[str, int]:
        return {name: columns(self.layout, name).start for name, _ in self.layout}


def _one_each(names: tuple[str, ...]) -> tuple[tuple[str, int], ...]:
    return tuple((name, 1) for name in names)


def leg_parameters(shapes: Shapes) -> tuple[tuple[str, int], ...]:
    """Physical parameters of one leg in kernel order (name, size)."""
    own = [item for element in shapes.elements for item in element.parameters]
    parts = (
        (True, LEG_PARAMETERS),
        (True, shapes.chain.parameters),
        (True, tuple(item for item in own if item[0] in PISTON)),
        (shapes.has("gamma1"), POSE_PARAMETERS),
        (True, tuple(item for item in own if item[0] not in PISTON)),
        (True, shapes.beam.section_parameters),
        (shapes.has("m") and not shapes.has("gamma1"), PLATFORM_JOINT),
        (True, shapes.beam.guide_parameters),
    )
    return tuple(item for there, table in parts if there for item in table)


def payload_parameters(shapes: Shapes) -> tuple[tuple[str, int], ...]:
    """Physical parameters of the payload in kernel order (name, size)."""
    return PAYLOAD_PARAMETERS + PLATE_PARAMETERS * shapes.has("m")
