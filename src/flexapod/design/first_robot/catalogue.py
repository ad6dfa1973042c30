"""A small catalogue: ball screws with nut and support bearing, hydraulic cylinders, motors.

What was read in a maker's catalogue is said to be; all else is ours, with the reason.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from flexapod.model.leg.rolling import RollingLaw

UM = 1e6  # N/m of an N/um
DOUBLE = 1.33  # rigidity of a double nut over that of a single one: R32-10K5, R25-05K4 and R32-05K4, -FDC over -FSC
OF_ONE = f"ours: {DOUBLE:g} times that of the single nut, as between R32-10K5-FDC and -FSC"


@dataclass(frozen=True, kw_only=True)
class Screw:
    """A ball screw with its nut and its support bearing, SI.

    `nominal`, `lead`, `root` diameter [m]; `rigidity` [N/m] of the nut at a preload of a tenth of the `dynamic_load`
    [N]; `bearing` stiffness [N/m] and the thrust that it takes, `bears` [N]; `bore` [m] of the bearings of a universal
    joint beside it. `shaft`, `nut`, `support`: where the numbers are from.
    """

    nominal: float
    lead: float
    root: float
    rigidity: float
    dynamic_load: float
    bearing: float
    bears: float
    bore: float
    shaft: str
    nut: str
    support: str

    @property
    def name(self) -> str:
        """Diameter and lead in millimetres."""
        return f"{1e3 * self.nominal:g} x {1e3 * self.lead:g}"


def _size(
    diameter: float, lead: float, root: float, rigidity: float, load: float, bearing: float, bears: float, bore: float,
    words: tuple[str, str, str],
) -> Screw:  # fmt: skip
    """A row: mm, N/um, kN."""
    shaft, nut, support = words
    return Screw(
        nominal=1e-3 * diameter, lead=1e-3 * lead, root=1e-3 * root, rigidity=UM * rigidity, dynamic_load=1e3 * load,
        bearing=UM * bearing, bears=1e3 * bears, bore=1e-3 * bore, shaft=shaft, nut=nut, support=support,
    )  # fmt: skip


def _thk(unit: str) -> str:
    return f"THK General Catalogue, support unit {unit}: rigidity and permissible load"


def _ibc(bore: str, preload: str) -> str:
    return (
        f"IBC Ball screw support bearings, p. 9, 60 degrees, bore {bore} mm, preload {preload}: linear to 2.83 times it"
    )


def _hiwin(article: str, rigidity: str = "") -> tuple[str, str]:
    return f"HIWIN Ballscrews BS-08-2-EN-1704-K (2017), {article}", f"HIWIN, load rating of {article}; rigidity: " + (
        rigidity or "HIWIN"
    )


#: Smallest first. THK's and HIWIN's catalogues and IBC's page were read; the rows say what is ours.
SCREWS = (
    _size(6, 1, 5.3, 75, 0.54, 29, 1.24, 5, (
        "ours: miniature screws of 6 mm", "ours: those of the 10 x 2 by its section, rigidity by its diameter",
        _thk("EK5"),
    )),
    _size(10, 2, 9, 125, 1.5, 49, 2.15, 8, (
        "THK General Catalogue, MDK 1002",
        "THK, MDK 1002-3, load rating; rigidity ours: three quarters of the 170 N/um of HIWIN's smallest, R16-16K2",
        _thk("EK8"),
    )),
    _size(16, 16, 13.12, DOUBLE * 170, 6.8, 88, 3.25, 12, (*_hiwin("R16-16K2-FSC", OF_ONE), _thk("EK12"))),
    _size(20, 5, 17.32, DOUBLE * 420, 14.9, 580, 4.95, 17, (*_hiwin("R20-05K4-FSC", OF_ONE), _ibc("17", "1750 N"))),
    _size(25, 5, 22.324, 650, 16.5, 580, 4.95, 20, (*_hiwin("R25-05K4-FDC"), _ibc("20", "1750 N"))),
    _size(32, 10, 28.744, 1130, 30.8, 830, 6.36, 30, (*_hiwin("R32-10K5-FDC"), _ibc("25", "2250 N"))),
    _size(40, 10, 34.91, DOUBLE * 1060, 63.4, 990, 9.62, 35, (*_hiwin("R40-10K5-FSC", OF_ONE), _ibc("30", "3400 N"))),
    _size(50, 10, 44.91, DOUBLE * 1250, 70.5, 1390, 18.1, 40, (*_hiwin("R50-10K5-FSC", OF_ONE), _ibc("35", "6400 N"))),
    _size(63, 10, 57.91, DOUBLE * 1440, 77.2, 1760, 36.2, 50, (*_hiwin("R63-10K5-FSC", OF_ONE), _ibc("35", "12.8 kN"))),
)  # fmt: skip

FASTEST = 3000 / 60 * 2 * math.pi  # of a servo motor [rad/s]
DN = 70.0 / 60 * 2 * math.pi  # speed times diameter of a nut whose balls return inside [m rad/s]: 70,000 mm rpm
BORE = 1e-3  # step of a tube's inner diameter [m]

#: Rated torques of servo motors [N m], as makers step them.
MOTORS = (0.02, 0.05, 0.1, 0.2, 0.32, 0.64, 1.3, 2.4, 3.5, 5.0, 7.5, 11.0, 15.0, 22.0, 30.0, 48.0, 70.0)
#: Bore and rod of hydraulic cylinders [m]: the usual pairs, whose rod takes half of the area.
CYLINDERS = tuple((1e-3 * bore, 1e-3 * rod) for bore, rod in (
    (16, 11), (20, 14), (25, 18), (32, 22), (40, 28), (50, 36), (63, 45), (80, 56), (100, 70), (125, 90), (160, 110),
    (200, 140), (250, 180), (320, 220), (400, 280),
))  # fmt: skip

_TORQUE, _INERTIA, _MASS = 3.5, 0.8e-3, 10.0  # of machine-hexapod's motor with brake and coupling [N m, kg m^2, kg]


def motor_inertia(torque: float) -> float:
    """Inertia [kg m^2] of a motor of a rated torque with brake and coupling: of like shape, torque^(10/7)."""
    return _INERTIA * (torque / _TORQUE) ** (10 / 7)


def motor_mass(torque: float) -> float:
    """Mass [kg] of a motor of a rated torque with its brake: of like shape, torque^(6/7)."""
    return _MASS * (torque / _TORQUE) ** (6 / 7)


def speed_limit(screw: Screw) -> float:
    """Speed that motor and nut allow [rad/s]; the shaft's critical speed apart."""
    return min(FASTEST, DN / screw.nominal)


def joint_stiffness(bore: float, load: float) -> tuple[float, float]:
    """Stiffness along the leg [N/m] of a joint's needle bearings by their law (T15.36), and of the whole joint.

    Pins, forks and bolts give way as much as the bearings, as in machine-hexapod.
    """
    k = RollingLaw(series="NA49", bore=bore, load=load, of="secant").k
    return k, k / 2
