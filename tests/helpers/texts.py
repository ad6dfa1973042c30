"""Texts of study files with pieces replaced."""


def replaced(text: str, *pairs: tuple[str, str]) -> str:
    """The text with each old piece, which must be there once, as the new one: no test passes by accident."""
    for old, new in pairs:
        assert text.count(old) == 1, f"{old!r} is {text.count(old)} times in the text"
        text = text.replace(old, new)
    return text


REAL_PARTS = """
[robot]
type = "6-UPS"
base = { radius = "700 mm", half_angle = "10 deg" }
platform = { radius = "400 mm", half_angle = "10 deg" }
home_height = "1 m"
[payload]
mass = "1000 kg"
inertia = [120, 120, 180]
com = [0, 0, 0.15]
[leg]
cylinder = { mass = "28 kg", com = "300 mm", inertia = 2.1, mouth = "600 mm" }
piston = { diameter = "60 mm", inner_diameter = "40 mm", length = "750 mm", material = "steel" }
base_joint = { stiffness = { axial = "200 N/um", radial = "150 N/um", loss = 0.01 } }
springs = { bracket = "500 N/um", flange = { stiffness = "900 N/um", at = "base", damping = "2 kN s/m" } }
[leg.drive]
type = "screw"
lead = "10 mm"
root_diameter = "28.74 mm"
length = "900 mm"
material = "steel"
mounting = "fixed-fixed"
bearing = { stiffness = "780 N/um", position = "60 mm" }
nut = { rigidity = "1130 N/um", preload = "2 kN", dynamic_load = "30.8 kN" }
rotor = { inertia = "2e-3 kg m^2", ratio = 2 }
command = "servo"
loop = { stiffness = "5 kN m/rad", damping = "20 N m s/rad" }
[motion]
type = "heave"
amplitude = "20 mm"
duration = "0.1 s"
"""


#: One response as the format has it: of real numbers and complex ones, single and double, evenly spaced and not.
UNIVERSAL = """\
    -1
    58
{title}
NONE
NONE
NONE
NONE
    4         0    0         0       NONE         4  -2       NONE         1   0
{kind:10d}{count:10d}{even:10d}{start:13.5E}{step:13.5E}{zero:13.5E}
        18    0    0    0 NONE                 NONE
         8    0    0    0 NONE                 {top}
        13    0    0    0 NONE                 {bottom}
         0    0    0    0 NONE                 NONE
{rows}
    -1
"""
