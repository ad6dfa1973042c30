"""Parameters of drives whose stroke is driven through springs, in the order in which kernels read them."""

#: Of legs whose stroke is driven through springs: these at home, how their compliance grows with the length there
#: [1/m, 1/m^2], and the rotor with its servo, all by the stroke.
SERIES_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("series_stiffness", 1),  # N/m, at home
    ("series_softening", 2),
    ("series_home", 1),  # m, length at home
    ("series_damping", 1),  # N s/m
    ("rotor_mass", 1),  # kg
    ("rotor_stiffness", 1),  # N/m, between command and r
    ("rotor_damping", 1),  # N s/m
)

#: ... whose pistons turn in their cylinders and take the nut along: travel by that angle [m/rad].
TURNING_PARAMETERS: tuple[tuple[str, int], ...] = (("series_turn", 1),)
#: ... whose play is a gap in them: half of it [m].
GAP_PARAMETERS: tuple[tuple[str, int], ...] = (("half_play", 1),)
#: ... whose motor has a ripple: angle of its first harmonic by travel [rad/m], energies of all [J].
RIPPLE_PARAMETERS: tuple[tuple[str, int], ...] = (("ripple_wave", 1), ("ripple", 4))
#: ... whose loop sums its error.
INTEGRAL_PARAMETERS: tuple[tuple[str, int], ...] = (("rotor_integral", 1),)  # N/(m s)
#: ... whose motor lags, or whose loop is closed about another place: gains [N/m, N s/m], the time by which it
#: lags [s], 1 where it comes at once, the shares of stroke and distance of the joints in what is measured, and 1 where
#: the rate is that of the rotor.
LOOP_PARAMETERS: tuple[tuple[str, int], ...] = (
    ("loop_stiffness", 1),
    ("loop_damping", 1),
    ("loop_lag", 1),
    ("loop_at_once", 1),
    ("loop_at", 2),
    ("loop_rate_at_rotor", 1),
)
#: ... of which some are columns of oil: their share in the compliance of these at home; of the two columns the share of
#: the pushing one in their stiffness there, and one over their lengths [1/m].
OIL_PARAMETERS: tuple[tuple[str, int], ...] = (("oil", 4),)
#: Of drives with friction along their travel, see `elements.friction`; 1 where it acts on the stroke, else, of a rotor,
#: the share of its shaft's twist in what springs before the stroke give way, at home, and what a longer leg adds [1/m].
DRIVE_FRICTION: tuple[tuple[str, int], ...] = (
    ("drive_friction", 8),
    ("drive_friction_at_stroke", 1),
    ("drive_friction_twist", 2),
)
