"""What a kernel reads of pistons of several sections, or that shear."""

POWERS = 5  # of a section that tapers: its EI is of fourth order


def inner_parameters(
    sections: int, planes: tuple[str, ...], count: int, *, tapers: bool
) -> tuple[tuple[str, int], ...]:
    """The same of guided pistons for the part inwards of the mouth, sections from its end there; ``count`` shapes."""
    powers = POWERS if tapers else 1
    return (
        ("inner_there", 1),  # 1 of guided legs, 0 of others
        ("inner_cuts", sections - 1),
        ("inner_rhoA", sections * powers),
        ("inner_load", sections),
        *((f"inner_EI_{plane}", sections * powers) for plane in planes),
        ("inner_place", sections),
        ("inner_shrink", sections),
        ("inner_damping", (len(planes) * count) ** 2),
    )


def section_parameters(
    sections: int, planes: tuple[str, ...], lateral: int, axial: int, *, shear: bool, tapers: bool
) -> tuple[tuple[str, int], ...]:
    """Parameters of a leg (name, size), sections from the tip to the driven end.

    `rhoA`, `EI`, `EA` are then those of the whole. ``lateral``, ``axial``: shapes of a plane and along the leg;
    ``planes``: directions that bend in their own way. Of what tapers along with a section the powers of the distance
    from its end at the tip follow each other, ``tapers``: up to the fourth, else the value alone.
    """
    powers = POWERS if tapers else 1
    coordinates = len(planes) * lateral * (1 + shear)
    thick = (
        ("section_shear", sections * powers),  # kappa G A [N]
        *((f"section_turning_{plane}", sections * powers) for plane in planes),  # rotary inertia rho I [kg m]
        ("piston_turning", 2),  # of the whole along leg x and y [kg m^2]
    )
    return (
        ("section_cuts", sections - 1),  # m, ends of the sections from the tip, ascending; 0: not there
        ("gland", 1),  # m, length within which the mouth takes a cut up
        ("section_rhoA", sections * powers),  # kg/m
        ("section_load", sections * powers),  # rhoA over its mean, of few shapes its mean on a section alone
        *((f"section_EI_{plane}", sections * powers) for plane in planes),  # N m^2
        ("section_place", sections),  # tau at their tip ends: share of the compliance from the driven end
        ("section_shrink", sections),  # 1/m, how it falls from there
        ("piston_moments", 2),  # int (X - inner end)^k dm / mass, k = 1, 2 [m, m^2]
        ("axial_first", axial),  # int psi dm [kg]
        ("axial_moment", axial),  # int (X - inner end) psi dm [kg m]
        ("axial_mass", axial * axial),  # int psi psi^T dm [kg]
        ("axial_damping", axial * axial),  # N s/m
        ("lateral_damping", coordinates**2),  # N s, over the free length
        *(thick if shear else ()),
    )
