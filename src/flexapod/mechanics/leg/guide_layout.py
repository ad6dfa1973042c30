"""Parameters of pistons in bushings and of cylinders that bend, in the order in which kernels read them."""

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
