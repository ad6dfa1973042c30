"""Beam of a leg: shapes of piston and cylinder, and parameters of sections, bushings and bending cylinders.

Parameters are in the order in which kernels read them.
"""

from __future__ import annotations

from dataclasses import dataclass

from flexapod.mechanics.shapes import AxialBasis, LateralBasis, lateral_basis

#: Of pistons in two bushings: the part between them and the springs there, across the leg, at gland and head.
GUIDE_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("guide_reach", 1),  # m, length of the leg at which the head meets the mouth; of legs without guide beyond all
    ("guide_rhoA", 1),  # kg/m, 0 without guide
    ("guide_EI", 1),  # N m^2, 0 without guide
    ("guide_stiffness", 2),  # N/m
    ("guide_damping", 2),  # N s/m
)
#: Of cylinders that bend, and of what is mounted on them.
CYLINDER_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("cylinder_length", 1),  # m, from the base joint to the mouth; 1 where it is rigid
    ("cylinder_EI", 1),  # N m^2
    ("cylinder_rhoA", 1),  # kg/m
    ("cylinder_turning", 1),  # kg m, rotary inertia of a section
    ("mounted_mass", 1),  # kg
    ("mounted_com", 1),  # m, from the base joint
    ("mounted_inertia", 1),  # kg m^2, transverse, about its CoM
)

POWERS = 5  # of a section that tapers: its EI is of fourth order


@dataclass(frozen=True, kw_only=True)
class LegBeam:
    """Bases of a leg, and the make of its piston; of legs that differ what any of them has.

    Attributes
    ----------
    a, b : LateralBasis
        Shapes along leg x and y; a planar leg bends in a only.
    axial : AxialBasis
    guide : LateralBasis, optional
        Shapes of the piston between two bushings, which give way across the leg; None: clamped at the mouth.
    cylinder : LateralBasis, optional
        Shapes of a cylinder that bends; with a guide there is one more, with a kink at the head.
    sections : int
        Of the pistons; 0: all are uniform.
    strips : bool
        Their two bending stiffnesses are different.
    tapers : bool
        Sections of theirs may taper.
    shear : bool
        They shear, and their sections have rotary inertia.
    """

    a: LateralBasis
    b: LateralBasis
    axial: AxialBasis
    guide: LateralBasis | None = None
    cylinder: LateralBasis | None = None
    sections: int = 0
    strips: bool = False
    tapers: bool = False
    shear: bool = False

    @property
    def bases(self) -> list[AxialBasis | LateralBasis]:
        """All bases of the leg: of bending, stretch, inner part and cylinder."""
        return [x for x in (self.a, self.b, self.axial, self.guide, self.cylinder) if x is not None]

    @property
    def made_of(self) -> tuple[int, ...]:
        """Number of sections, and whether they are strips, taper and shear."""
        return self.sections, self.strips, self.tapers, self.shear

    @property
    def shear_basis(self) -> LateralBasis | None:
        """Shapes by whose forces pistons shear: those without a moment at the tip, whose forces are independent."""
        return lateral_basis("tip-load", self.b.count) if self.shear else None

    @property
    def planes(self) -> tuple[str, ...]:
        """Directions in which sections have a bending stiffness of their own."""
        return ("a", "b") if self.strips and self.a.count else ("b",)

    @property
    def amplitudes(self) -> tuple[tuple[str, int], ...]:
        """Amplitudes of stretch and of bending in both planes, with their numbers."""
        return ("c", self.axial.count), ("a", self.a.count), ("b", self.b.count)

    @property
    def inside(self) -> tuple[tuple[str, int], ...]:
        """Amplitudes of shear, and at the mouth and inwards of it: displacement and slope, inner part, cylinder."""
        sheared = tuple((f"shear_{way}", count) for way, count in self.amplitudes[1:] if self.shear and count)
        guide = () if self.guide is None else (("g", 2), ("h", self.guide.count))
        kinked = self.guide is not None  # one shape more, by the head's force
        bend = () if self.cylinder is None else (("k", self.cylinder.count + kinked),)
        return sheared + tuple((f"{name}{way}", size) for name, size in (*guide, *bend) for way in "ab")

    @property
    def section_parameters(self) -> tuple[tuple[str, int], ...]:
        """Parameters of pistons of several sections, or that shear, from the tip to the driven end.

        Of what tapers along with a section the powers of the distance from its end at the tip follow each other, up to
        the fourth, else the value alone.
        """
        if not self.sections:
            return ()
        sections, axial, powers = self.sections, self.axial.count, POWERS if self.tapers else 1
        coordinates = len(self.planes) * self.b.count * (1 + self.shear)
        thick = (
            ("section_shear", sections * powers),  # kappa G A [N]
            *((f"section_turning_{plane}", sections * powers) for plane in self.planes),  # rotary inertia rho I [kg m]
            ("piston_turning", 2),  # of the whole along leg x and y [kg m^2]
        )
        own = (
            ("section_cuts", sections - 1),  # m, ends of the sections from the tip, ascending; 0: not there
            ("gland", 1),  # m, length within which the mouth takes a cut up
            ("section_rhoA", sections * powers),  # kg/m
            ("section_load", sections * powers),  # rhoA over its mean, of few shapes its mean on a section alone
            *((f"section_EI_{plane}", sections * powers) for plane in self.planes),  # N m^2
            ("section_place", sections),  # tau at their tip ends: share of the compliance from the driven end
            ("section_shrink", sections),  # 1/m, how it falls from there
            ("piston_moments", 2),  # int (X - inner end)^k dm / mass, k = 1, 2 [m, m^2]
            ("axial_first", axial),  # int psi dm [kg]
            ("axial_moment", axial),  # int (X - inner end) psi dm [kg m]
            ("axial_mass", axial * axial),  # int psi psi^T dm [kg]
            ("axial_damping", axial * axial),  # N s/m
            ("lateral_damping", coordinates**2),  # N s, over the free length
        )
        return own + thick * self.shear + self._inner_parameters

    @property
    def _inner_parameters(self) -> tuple[tuple[str, int], ...]:
        """Parameters of guided pistons for the part inwards of the mouth, sections from its end there."""
        if self.guide is None:
            return ()
        sections, powers = self.sections, POWERS if self.tapers else 1
        return (
            ("inner_there", 1),  # 1 of guided legs, 0 of others
            ("inner_cuts", sections - 1),
            ("inner_rhoA", sections * powers),
            ("inner_load", sections),
            *((f"inner_EI_{plane}", sections * powers) for plane in self.planes),
            ("inner_place", sections),
            ("inner_shrink", sections),
            ("inner_damping", (len(self.planes) * self.guide.count) ** 2),
        )

    @property
    def guide_parameters(self) -> tuple[tuple[str, int], ...]:
        """Parameters of pistons in bushings, and of cylinders that bend."""
        guide, cylinder = self.guide is not None, self.cylinder is not None
        return GUIDE_PARAMETERS * guide + CYLINDER_PARAMETERS * cylinder
