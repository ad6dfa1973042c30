"""The paper's robot on welded legs, as geometrically exact rods."""

import numpy as np
from tests.oracles import welded
from tests.oracles.mechanism_cases import ring

E, WIDTH = 200e9, 0.027
STEEL = {
    "EI": E * np.pi * WIDTH**4 / 64,
    "EA": E * np.pi * WIDTH**2 / 4,
    "GJ": E * np.pi * WIDTH**4 / 32 / 2.6,
    "rhoA": 7800 * np.pi * WIDTH**2 / 4,
}


def robot(base=0.5, platform=0.3, mouth=0.35926, half=10, com=0.373, **changed):
    """The paper's robot with its circles read as radii, or another reading."""
    outer = ring(base, np.array([-half, half, 120 - half, 120 + half, 240 - half, 240 + half]))
    inner = ring(platform, np.array([half - 60, 60 - half, half + 60, 180 - half, half + 180, 300 - half]))
    parts = {"mouth": mouth, "piston": 0.75, "mass": 100.0, "cylinder": (3.0, mouth / 2)} | STEEL | changed
    return welded.Robot(base=outer, tips=inner, home=np.array([0, 0, 0.9]), com=np.array([0, com, 0]), **parts)


def deviation(robot, degrees):
    """Displacement of the centre of mass [mm], and the rest, at the last of some rolls."""
    *_, (_, moved, found) = welded.rolled(robot, np.deg2rad(np.linspace(0, degrees, 8)))
    return 1e3 * moved, found
