"""The actuator as a solid in a rigid hub, and the leg of the robot that it stands for (Fig. 2 of the paper)."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Polygon, Rectangle

from flexapod import model
from flexapod.output.figures.robot3d import CYLINDER, PLATFORM
from flexapod.output.figures.style import NOTE, PAGE, figure, styled
from flexapod.output.scene.colours import LEG_COLORS
from flexapod.verification.paper.claim import HEIGHT, WIDTH

COARSE = 0.05  # of the paper's coarse mesh [m]; 5 mm would be black
HUB = 0.5  # ours, as the paper gives no hub: length of its shell [m]
TUBE = 1.6  # ours, as the paper gives no cylinder: its width over the piston's
WIDE, DEEP = 2.0, 10.0  # how many times its width and its depth the beam is drawn wide and deep
SLANT = np.array([0.35, 0.5])  # where a metre of width goes in the picture
SHELL = 0.04  # distance of the shell from what is in it, as drawn [m]
EDGE = "#4A4F57"


@styled
def actuator_solid(actuator: model.Actuator, leg: model.Leg, home: float) -> Figure:
    """A: the beam as hexahedra that slide through a rigid shell. B: a leg of the robot, piston in cylinder, to scale.

    Parameters
    ----------
    actuator : Actuator
        Its whole length and its length outside of the hub are drawn to scale, its section is that of Table 2.
    leg : Leg
        A round piston and its cylinder.
    home : float
        Length of the leg, joint to joint [m].
    """
    fig = figure(PAGE, 2.8)
    above, below = fig.subplots(2, 1, height_ratios=(1.7, 1))
    for axes in (above, below):
        axes.set_aspect("equal")
        axes.axis("off")
    _beam(above, actuator)
    _leg(below, leg, home)
    words = f"A: hexahedra of {1e3 * COARSE:.0f} mm in a rigid shell"
    above.set_title(f"{words}; width drawn {WIDE:g} times, depth {DEEP:g}")
    below.set_title("B: a leg of the robot at home, piston in cylinder")
    return fig


def _beam(axes: Any, actuator: model.Actuator) -> None:
    outside, inner = actuator.free_length, actuator.free_length - actuator.length
    along = np.append(np.arange(inner, outside, COARSE), outside)
    across = WIDE * np.append(np.arange(0.0, WIDTH, COARSE), WIDTH)
    _box(axes, along, across, np.array([0.0, DEEP * HEIGHT]), PLATFORM, 0.9, "#FFFFFF")
    sides = np.array([across[0] - SHELL, across[-1] + SHELL])
    _box(axes, np.array([-HUB, 0.0]), sides, np.array([-SHELL, DEEP * HEIGHT + SHELL]), CYLINDER, 0.55, EDGE)
    top = float(SLANT[1] * sides[1] + DEEP * HEIGHT + 2.5 * SHELL)
    for text, place in (("rigid hub, a shell", -HUB / 2), ("deformable beam", 0.55 * outside)):
        axes.annotate(text, (place, top), fontsize=NOTE, ha="center", va="bottom")
    axes.set(xlim=(inner - 0.1, outside + 0.3), ylim=(-2 * SHELL, top + 0.2))


def _box(
    axes: Any, along: np.ndarray, across: np.ndarray, up: np.ndarray, color: str, alpha: float, edges: str
) -> None:
    """What is seen of a box from the front, above and the right: its faces, cut at the given places."""

    def face(corners: list[tuple[float, float, float]]) -> None:
        points = [np.array([x, z]) + y * SLANT for x, y, z in corners]
        axes.add_patch(Polygon(points, facecolor=color, edgecolor=edges, linewidth=0.3, alpha=alpha))

    low, high = up
    for c, d in reversed(list(pairwise(across))):
        for a, b in pairwise(along):
            face([(a, c, high), (b, c, high), (b, d, high), (a, d, high)])
        face([(along[-1], c, low), (along[-1], d, low), (along[-1], d, high), (along[-1], c, high)])
    for a, b in pairwise(along):
        face([(a, across[0], low), (b, across[0], low), (b, across[0], high), (a, across[0], high)])


def _leg(axes: Any, leg: model.Leg, home: float) -> None:
    width, mouth = leg.piston.diameter or 0.0, leg.cylinder.mouth
    inner = home - leg.piston.length
    for start, end, size, color in ((inner, home, width, LEG_COLORS[0]), (0.0, mouth, TUBE * width, CYLINDER)):
        axes.add_patch(Rectangle((start, -size / 2), end - start, size, facecolor=color, edgecolor=EDGE, linewidth=0.6))
        axes.add_patch(Ellipse((end, 0), 0.3 * size, size, facecolor=color, edgecolor=EDGE, linewidth=0.6))
    axes.add_patch(Rectangle((mouth, -width / 2), width, width, facecolor=LEG_COLORS[0]))
    axes.plot([inner, mouth], [0, 0], color="#333333", linewidth=0.8, linestyle=(0, (4, 3)))
    for place, text in ((0.0, "universal joint"), (home, "spherical joint")):
        axes.plot(place, 0, "o", color="#333333", markersize=7)
        axes.annotate(text, (place, -1.2 * width), fontsize=NOTE, ha="center", va="top")
    for place, text in ((mouth / 2, "cylinder"), (0.5 * (mouth + home), f"piston of {1e3 * width:.0f} mm")):
        axes.annotate(text, (place, 1.2 * width), fontsize=NOTE, ha="center", va="bottom")
    axes.set(xlim=(-3 * width, home + 3 * width), ylim=(-3 * width, 3 * width))
