"""Joints and coordinates of a leg from its base to the payload, and what kernels read of them."""

from dataclasses import dataclass
from typing import Literal

#: Of legs with a carriage; axis and arms in the world frame, where chi = 0.
CARRIAGE_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("carriage_mass", 1),  # kg
    ("carriage_axis", 3),  # unit vector along a slider's rail or a crank's shaft
    ("carriage_stiffness", 1),  # N/m or N m/rad, between command and chi
    ("carriage_damping", 1),  # N s/m or N m s/rad
)
#: ... of a crank.
CRANK_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("carriage_inertia", 1),  # kg m^2 about the shaft
    ("carriage_com", 3),  # m, from the shaft
    ("carriage_arm", 3),  # m, from the shaft to the base joint; `base` is the base joint
)
#: ... of legs that turn about their axis at the base joint; 1: with the cylinder (S, F), 0: the piston alone (C).
SPIN_PARAMETERS: tuple[tuple[str, int], ...] = (("cylinder_spins", 1),)
#: ... of legs that meet the payload with place and attitude, Q = F_P^T R^T R_tip F_L Gamma = 1.
POSE_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("joint", 3),  # m, platform joint from the payload's CoM, platform axes
    ("platform_frame", 9),  # F_P, joint frame in platform axes, column by column
    ("leg_frame", 9),  # F_L, joint frame in the axes of the leg's tip, column by column
    ("L_c", 1),  # m, length that makes rotations comparable with displacements
    ("base_stiffness", 3),  # N m/rad, springs on alpha, beta, spin
    ("base_home", 3),  # rad, where they are slack
    ("gamma_stiffness", 3),  # N m/rad, springs on gamma1..3
    ("gamma_home", 3),  # rad
    ("base_damping", 3),  # N m s/rad, dampers beside these springs
    ("gamma_damping", 3),  # N m s/rad
)


@dataclass(frozen=True, kw_only=True)
class LegChain:
    """The mechanism of a leg: its joints one after the other; of legs that differ those that any of them has.

    Attributes
    ----------
    carriage : {"", "slider", "crank"}
        What moves the base joint, by chi.
    spin : bool
        Rotation about the leg's axis at the base joint.
    planar : bool
        The single actuator in its plane: beta alone, no alpha.
    closure : {"none", "point", "pose"}
        What the payload fixes at the tip: nothing, its place (an ideal ball) or its place and attitude, behind three
        angles of the platform joint.
    pivot_spin : bool
        A free spin takes the place of gamma3 among the coordinates that the closure determines.
    """

    carriage: Literal["", "slider", "crank"] = ""
    spin: bool = False
    planar: bool = False
    closure: Literal["none", "point", "pose"] = "point"
    pivot_spin: bool = False

    @property
    def base(self) -> tuple[str, ...]:
        """Angles of the base joint across the leg, and the leg's length."""
        return ("beta", "l") if self.planar else ("alpha", "beta", "l")

    @property
    def more(self) -> tuple[str, ...]:
        """Coordinates that only some chains have at their base: of the carriage, about the leg."""
        return ("chi",) * bool(self.carriage) + ("spin",) * self.spin

    @property
    def platform(self) -> tuple[str, ...]:
        """Angles of the platform joint; those of a ball are no coordinates."""
        return ("gamma1", "gamma2", "gamma3") if self.closure == "pose" else ()

    @property
    def rows(self) -> int:
        """Rows of the closure: 0, 3 or 6."""
        return {"none": 0, "point": 3, "pose": 6}[self.closure]

    @property
    def pivots(self) -> tuple[str, ...]:
        """Coordinates that the closure determines, one for each of its rows."""
        last = "spin" if self.pivot_spin else "gamma3"
        return ("alpha", "beta", "l", "gamma1", "gamma2", last)[: self.rows]

    @property
    def has_tip_load(self) -> bool:
        """True where a load acts on the tip, in space without a payload."""
        return self.closure == "none" and not self.planar

    @property
    def parameters(self) -> tuple[tuple[str, int], ...]:
        """Parameters of the leg's base beside those of every leg: of carriage, crank and spin."""
        crank = CRANK_PARAMETERS if self.carriage == "crank" else ()
        return CARRIAGE_PARAMETERS * bool(self.carriage) + crank + SPIN_PARAMETERS * self.spin
