"""What kernels read and in which order: coordinates and parameters of a leg and of the payload. No casadi here."""

from dataclasses import dataclass

from flexapod.bases import AxialBasis, LateralBasis

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

#: Physical parameters of the payload in kernel order (name, size); joints and tool from the CoM, in platform axes.
PAYLOAD_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("mass", 1),  # kg
    ("inertia", 9),  # kg m^2 about the CoM, platform axes, column by column
    ("gravity", 3),  # m/s^2
    ("tool", 3),  # m
    ("joints", 18),  # m, spherical joints of legs 1..6
)

#: Commands of one leg: commanded length l_cmd and its rate, force along the leg, torque about beta (planar leg).
COMMAND_SIZE = 4


def columns(layout: tuple[tuple[str, int], ...], name: str) -> slice:
    """Columns of a parameter in the flat vectors of a layout."""
    names = [key for key, _ in layout]
    start = sum(size for _, size in layout[: names.index(name)])
    return slice(start, start + dict(layout)[name])


@dataclass(frozen=True, kw_only=True)
class Shapes:
    """Bases of one leg: lateral directions a and b, axial. A planar leg bends in a only and may carry a tip body."""

    a: LateralBasis
    b: LateralBasis
    axial: AxialBasis
    planar: bool = False

    @property
    def layout(self) -> tuple[tuple[str, int], ...]:
        """Coordinates q of the leg (name, size); a planar leg has no alpha and no direction b."""
        angles = (("beta", 1),) if self.planar else (("alpha", 1), ("beta", 1))
        return (*angles, ("l", 1), ("c", self.axial.count), ("a", self.a.count), ("b", self.b.count))

    @property
    def size(self) -> int:
        """Number of coordinates of the leg."""
        return sum(size for _, size in self.layout)

    @property
    def l_index(self) -> int:
        """Position of the reference length l in q."""
        return 1 if self.planar else 2
