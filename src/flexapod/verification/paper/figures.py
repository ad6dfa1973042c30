"""Figures of the paper's study in the order of the paper, with the actuator and the leg as solids (Fig. 2).

The actuator is drawn in a rigid hub, beside the leg of the robot that it stands for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Polygon, Rectangle

from flexapod import model
from flexapod.analysis.results.time_history import Report
from flexapod.common.quantities import number, text
from flexapod.output import figures
from flexapod.output.figures.robot3d import CYLINDER, PLATFORM
from flexapod.output.figures.style import NOTE, PAGE, figure, house_style
from flexapod.output.report.figures import StoredFigure, store_figure
from flexapod.output.scene.style import LEG_COLORS
from flexapod.verification.paper import clamped_legs, engine_figures, outlook_figures, printed_figures
from flexapod.verification.paper.claim import HEIGHT, PAPER_DEVIATION, WIDTH, force_gaps
from flexapod.verification.paper.claims_actuator import LINEAR
from flexapod.verification.paper.study import PaperStudy

_Plan = tuple[str, str, str, Callable[[], Figure]]
ACTUATOR, ROBOT, VARIANTS = "Single actuator", "Robot", "What the deviation depends on"
OUTLOOK = "What the paper asks for next"
ENGINE = "Independent engine"


def paper_figures(
    result: PaperStudy, folder: Path, formats: Sequence[str], progress: Report | None = None
) -> dict[str, list[StoredFigure]]:
    """Draw all figures of the paper's study, by group."""
    plans = [*_actuator(result), *_robot(result), *_outlook(result), *_variants(result), *_engine(result)]
    drawn: dict[str, list[StoredFigure]] = {}
    for i, (group, name, title, make) in enumerate(plans):
        if progress is not None:
            progress(f"figure {i + 1} of {len(plans)}", i / len(plans))
        drawn.setdefault(group, []).append(store_figure(make(), title, folder / name, formats))
    if progress is not None:
        progress("report", 1.0)
    return drawn


def _actuator(result: PaperStudy) -> Iterator[_Plan]:
    series = result.actuator
    finest = series[max(series)]
    title = (
        "Figs. 1 and 2, not to scale: a rigid hub of inertia J_h and radius R_h, turned by the torque T; a beam (EI, "
        "rho, whole length L_t) that slides through it without friction, L(t) of it outside, and stays straight "
        "behind; its deflection u(x, t) in the axes x, y of the hub; a tip body (m_e, J)"
    )
    yield ACTUATOR, "actuator-symbols", title, printed_figures.actuator_symbols
    beam, robot = model.preset("paper-actuator").actuator, model.preset("paper-robot").robot
    title = (
        "Fig. 2: the actuator as a solid beam that slides through a rigid hub (A; 0.5 m of hub are ours), and the leg "
        "of the robot that it stands for (B; the cylinder is ours), to scale but for the beam's depth"
    )
    yield (
        ACTUATOR,
        "actuator-solid",
        title,
        lambda: actuator_solid(beam, robot.legs[0], float(robot.home_lengths[0])),
    )
    title = (
        "Fig. 4 of the paper, its analytic curve: tip of the single actuator with 1 to 5 shapes. The values that the "
        "paper leaves open are ours, so size and phase are not to be laid over the printed curve"
    )
    yield ACTUATOR, "actuator-response", title, lambda: figures.actuator_response(series)
    meshes = {f"{letter}, {kind}": result[f"actuator-solid-{name}"]
              for kind, pair in LINEAR.items() for letter, name in zip("AB", pair, strict=True)}  # fmt: skip
    title = (
        "Fig. 3: solid elements, coarse (A, 50 mm) and fine (B, 5 mm), by the kinds of linear hexahedra that programs "
        "offer: full integration locks in bending, reduced integration is too soft, incompatible modes are right"
    )
    yield ACTUATOR, "actuator-solid-meshes", title, lambda: figures.solid_meshes(meshes, result["actuator-fine"])
    title = (
        "Fig. 4, two readings of its velocities: held, or given at the start to a beam that is then free on a hub "
        "without friction and inertia. It comes out ever faster, as the turning throws it out, and slows the hub"
    )
    readings = {"held": series[3], "given at the start": result["actuator-free"]}
    yield ACTUATOR, "actuator-free", title, lambda: printed_figures.actuator_free(readings)
    title = "Fig. 4: assumed modes (8 shapes) against beam and solid finite elements, with their differences"
    others = {"beam elements": result["actuator-beam"], "solid elements": result["actuator-solid-quadratic"]}
    yield ACTUATOR, "actuator-comparison", title, lambda: figures.solid_comparison(others, result["actuator-fine"])
    title = "Amplitudes of the shapes with 5 of them; quick ones as the band that they fill, with their first swings"
    yield ACTUATOR, "actuator-amplitudes", title, lambda: figures.actuator_modes(finest)


def _robot(result: PaperStudy) -> Iterator[_Plan]:
    data, rigid, modes = result["robot"], result["robot-rigid"], result["modes"]
    bending = [int(m) for m, kind in zip(modes.mode.values, modes.kind.values, strict=True) if "bending" in str(kind)]
    yield (ROBOT, "robot-home", "Fig. 5: the robot at home", lambda: figures.robot_3d(data, 0.0))
    yield (ROBOT, "roll-law", "Fig. 6: the roll about X, quintic", lambda: figures.motion_law(data))
    yield (
        ROBOT,
        "robot-end",
        "Fig. 7: the robot at the end of the roll; pale: at home",
        lambda: figures.robot_3d(data),
    )
    yield (
        ROBOT,
        "leg-lengths",
        "Leg lengths, and how far the flexible legs are off",
        lambda: figures.leg_lengths(data),
    )
    title = (
        "Fig. 8: drive forces of the rigid robot, Newton-Euler against the multibody model, and their difference. Its "
        f"spikes, up to {text(force_gaps(rigid)[1], 'N', 2)}, are those of a fixed step of "
        f"{text(rigid.attrs['step'], 's')} after the quintic's jerk has jumped; they fall with the step"
    )
    yield (ROBOT, "forces-rigid", title, lambda: printed_figures.forces_rigid(rigid))
    title = "Fig. 8 as the paper draws it: all forces in one panel, the two models over each other"
    yield (ROBOT, "forces-overlaid", title, lambda: printed_figures.forces_overlaid(rigid))
    title = (
        "Drive forces of the robot with flexible legs against those of the rigid one. What swings too often to be "
        "drawn is the band that it fills"
    )
    yield (ROBOT, "forces-flexible", title, lambda: figures.actuator_forces(data))
    title = "Fig. 9: path of the centre of mass in Y and Z, rigid against flexible; the deviation needs its own scale"
    yield (ROBOT, "com-path", title, lambda: figures.com_path(data))
    title = "Fig. 9 with the printed deviation of 5 and 10 mm to scale: ours is a line in its middle"
    yield (ROBOT, "com-path-bands", title, lambda: printed_figures.path_bands(data, PAPER_DEVIATION))
    title = "The deviation by cause and by leg: stretch of the pistons is all of it"
    yield (ROBOT, "deviation-by-cause", title, lambda: figures.deviation_by_cause(data))
    title = "Fig. 10: the first bending modes of the legs at the largest roll, drives locked; magnified, size arbitrary"
    yield (ROBOT, "modes-bending", title, lambda: figures.modes_3d(modes, bending[:3]))
    if bending:
        title = "Fig. 10 B: one piston alone in the first bending mode of the legs, at the largest roll; size arbitrary"
        yield (ROBOT, "piston-mode", title, lambda: printed_figures.piston_mode(modes, bending[0]))
    others = [int(m) for m in modes.mode.values if int(m) not in bending[:3]]
    title = "The lowest modes of the robot at the largest roll besides those of Fig. 10; magnified, size arbitrary"
    yield (ROBOT, "modes-lowest", title, lambda: figures.modes_3d(modes, others[:6]))
    yield (ROBOT, "tip-deflections", "Tips of the pistons across their legs", lambda: figures.tip_deflections(data))
    title = (
        "Energies, and how well their balance closes. Its burst at the start is the error of the drives' work in the "
        f"first steps, within the tolerance of {number(data.attrs.get('tolerance', np.nan), 2)}, with which it falls"
    )
    yield (ROBOT, "energies", title, lambda: figures.energies(data))


def _outlook(result: PaperStudy) -> Iterator[_Plan]:
    """Plans of the figures of sections 4.3 and 4.4."""
    title = (
        "Section 4.4, compensation: commands ahead of time that make up for more and more of what is known beforehand"
    )
    yield OUTLOOK, "commands-ahead", title, lambda: outlook_figures.commands_ahead(result["ahead"])
    title = "Section 4.4, vibration: what the roll leaves, as it is and shaped for the lowest modes"
    yield OUTLOOK, "shaped-roll", title, lambda: outlook_figures.shaped_roll(result["shaped"])
    title = "Section 4.4, feedback: drives as stiff as the pistons that give way to the integral of their own force"
    yield OUTLOOK, "force-feedback", title, lambda: outlook_figures.force_feedback(result["feedback"])
    title = "Section 4.3, friction: plain joints at both ends of the legs"
    yield OUTLOOK, "joint-friction", title, lambda: outlook_figures.joint_friction(result["friction"])
    title = "Section 4.3, imperfections and disturbances: whose microns they are, with tolerances, friction and a floor"
    yield OUTLOOK, "error-budget", title, lambda: figures.budget(result["budget"])


def _variants(result: PaperStudy) -> Iterator[_Plan]:
    title = "Fig. 9 with the circles read as radii, roll of 30 deg"
    yield (VARIANTS, "com-path-radii", title, lambda: figures.com_path(result["robot-radii"]))
    sweeps = {"Circles as diameters": result["half-angles"], "Circles as radii": result["half-angles-radii"]}
    title = "Half-angles of the joint pairs: the road to the architecture singularity at 30 deg"
    yield (VARIANTS, "half-angles", title, lambda: engine_figures.half_angles(sweeps))
    title = "Section 1: lighter pistons, hollow or thinner, deviate and vibrate more; the heaviest is the paper's"
    yield (VARIANTS, "light-pistons", title, lambda: engine_figures.light_pistons(result["light"]))
    title = (
        "Ball joints that carry moments, at rest: roll and place of the centre of mass at which each of the three "
        "printed figures is reached. Stresses are those of d = 373 mm; steel yields at 0.6 GPa"
    )
    yield (VARIANTS, "welded", title, lambda: clamped_legs.clamped_legs_figure(result["welded"]))
    title = "A 3-RPS of the same pistons under the same roll, by cause: bending is all of it"
    yield (VARIANTS, "tripod-by-cause", title, lambda: figures.deviation_by_cause(result["tripod"]))
    title = "The 3-RPS at the end of the roll; pale: at home"
    yield (VARIANTS, "tripod-end", title, lambda: figures.robot_3d(result["tripod"]))
    title = "A start and a stop at full rate against the quintic"
    yield (VARIANTS, "velocity-jump", title, lambda: engine_figures.start_jump(result["robot"], result["jump"]))


def _engine(result: PaperStudy) -> Iterator[_Plan]:
    """Plans of the figures of those parts that the engine was asked for and computed."""
    model, engine = "multibody model", "Exudyn"
    if "robot-exudyn-rigid" in result.parts:
        rigid = {model: result["robot-rigid-same-step"], engine: result["robot-exudyn-rigid"]}
        title = (
            "Fig. 8 with an independent engine: drive forces of the rigid robot by Newton-Euler, our multibody model "
            "and Exudyn. The quintic's jerk jumps at start and end of the roll: there both programs, which share "
            "integrator and step, ring about Newton-Euler for some 20 ms, the less the shorter the step"
        )
        yield ENGINE, "engine-forces-rigid", title, lambda: engine_figures.engine_forces(rigid)
    if "robot-exudyn" in result.parts:
        flexible = {model: result["robot-undamped"], engine: result["robot-exudyn"]}
        title = (
            "The same with flexible, undamped legs: below, what their vibration adds to the forces by our model (pale) "
            "and how far Exudyn is from that (dark)"
        )
        yield ENGINE, "engine-forces-flexible", title, lambda: engine_figures.engine_forces(flexible)
        title = (
            "Fig. 9 with an independent engine: path of the centre of mass, rigid and flexible, without damping. The "
            "difference grows as the frequencies differ: the guide of Exudyn's pistons is softer than our clamp"
        )
        yield ENGINE, "engine-com-path", title, lambda: engine_figures.engine_path(flexible)


COARSE = 0.05  # of the paper's coarse mesh [m]; 5 mm would be black
HUB = 0.5  # ours, as the paper gives no hub: length of its shell [m]
TUBE = 1.6  # ours, as the paper gives no cylinder: its width over the piston's
WIDE, DEEP = 2.0, 10.0  # how many times its width and its depth the beam is drawn wide and deep
SLANT = np.array([0.35, 0.5])  # where a metre of width goes in the picture
SHELL = 0.04  # distance of the shell from what is in it, as drawn [m]
EDGE = "#4A4F57"


@house_style
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
    for label, place in (("rigid hub, a shell", -HUB / 2), ("deformable beam", 0.55 * outside)):
        axes.annotate(label, (place, top), fontsize=NOTE, ha="center", va="bottom")
    axes.set(xlim=(inner - 0.1, outside + 0.3), ylim=(-2 * SHELL, top + 0.2))


def _box(
    axes: Any, along: np.ndarray, across: np.ndarray, up: np.ndarray, color: str, alpha: float, edges: str
) -> None:
    """Draw the visible faces of a box, seen from the front, above and the right, cut at the given places."""

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
    for place, label in ((0.0, "universal joint"), (home, "spherical joint")):
        axes.plot(place, 0, "o", color="#333333", markersize=7)
        axes.annotate(label, (place, -1.2 * width), fontsize=NOTE, ha="center", va="top")
    for place, label in ((mouth / 2, "cylinder"), (0.5 * (mouth + home), f"piston of {1e3 * width:.0f} mm")):
        axes.annotate(label, (place, 1.2 * width), fontsize=NOTE, ha="center", va="bottom")
    axes.set(xlim=(-3 * width, home + 3 * width), ylim=(-3 * width, 3 * width))
