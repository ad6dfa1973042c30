"""A single actuator in the browser: hub, sliding beam bent in one plane or two, rigid ghost, path of the tip."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import viser

from flexapod import kinematics, model
from flexapod.app.browser.legend import LEGEND_STYLE, rgb
from flexapod.app.browser.robot_parts import add_grid
from flexapod.app.browser.scene import OF_RESULTS, STRAIGHT, PageScene, mode_note
from flexapod.common.arrays import Array
from flexapod.common.quantities import number, text
from flexapod.model.laws import MotionLaw
from flexapod.output.scene.geometry import (
    BEAM_POINTS,
    BeamMotion,
    beam_frame,
    disc,
    path_segments,
    straight_beam,
    tube,
    tube_faces,
)

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.output.scene.robot_scene import BeamModes

_BEAM, _HUB, _INSIDE, _GHOST, _TIP = rgb("#0072B2"), rgb("#4A4F57"), rgb("#B5BAC1"), rgb("#7A7A7A"), rgb("#C2185B")
_STRIPE = rgb("#F0E442")
TURN = 10.0  # rad per share of the free length: as far as what twists is turned in a mode
TWISTS = "A mode has no size of its own: the stripe shows how the beam turns about its axis."
INSTANTS = 49  # of a motion, at which the picture has to hold the beam
_HERE = (0.0, 0.0, 0.0)
_NOTHING = np.zeros((1, 2, 3))


class ActuatorScene(PageScene):
    """One user's view of a single actuator; a plane of motion X, Y stands upright, as world x, z."""

    def __init__(self, client: viser.ClientHandle) -> None:
        super().__init__(client)
        self._study: model.ActuatorStudy | None = None
        self._actuator: model.Actuator
        self._motion: BeamMotion | None = None
        self._nodes: dict[str, Any] = {}

    def show_study(self, study: model.ActuatorStudy) -> None:
        """Draw the actuator of a study undeformed at its free length; no result is shown any more."""
        with self.lock:
            if self._closed:
                return
            first, actuator = self._study is None, study.actuator
            self._study, self._actuator, self._motion = study, actuator, None
            with self.client.atomic():
                if first:
                    self._light()
                self._begin()
                self._nodes = self._make(actuator)
                self.show_pose(actuator.free_length)
            if first:
                self._look(np.array([0.5, -1.4, 0.7] if actuator.space else [0.0, -1.6, 0.2]))

    def show_pose(self, pose: float) -> None:
        """Draw the straight beam at a length outside the hub [m], the hub as at t = 0."""
        with self.lock:
            if self._study is None:
                return
            axes, line = self._straight(pose)
            with self.client.atomic():
                self._only()
                self._draw(line, axes, pose)
                self._draws(f"the straight beam, {text(pose, 'm', 4)} outside the hub", STRAIGHT)

    def set_time(self, time: float) -> None:
        """Draw beam, rigid ghost and deflection at the stored instant nearest to `time` [s]."""
        with self.lock:
            if self._motion is None:
                return
            self.time: float = float(time)
            i, bent, straight = self._motion.frame_at(time, self.scale)
            length, twist = float(self._motion.length[i]), self.scale * self._motion.twist[i]
            with self.client.atomic():
                self._only(*OF_RESULTS)
                self._draw(bent, self._motion.axes[i], length, twist * self._eta(length))
                self._draw_ghost(straight)
                self._mark(straight[-1], bent[-1], float(self._motion.deflection[i]))
                self._draws("")

    def show_mode(self, modes: BeamModes, mode: int, amplitude: float, phase: float, where: str = "") -> None:
        """Draw a mode, `amplitude` as a share of the free length; a twisting one turns by ten times the share [rad]."""
        with self.lock:
            if self._study is None:
                return
            length = modes.free_length
            axes, line = self._straight(length)
            bent = line + amplitude * length * phase * modes.shape[mode - 1] @ axes
            with self.client.atomic():
                self._only("rigid ghost")
                self._draw(bent, axes, length, TURN * amplitude * phase * modes.twist[mode - 1])
                self._draw_ghost(line)
                turning = modes.kind[mode - 1] == "twisting"
                note = TWISTS if turning else mode_note(amplitude * length)
                self._draws(f"mode {mode}, {modes.kind[mode - 1]}{where and f' at {where}'}", note)

    def _whole(self) -> tuple[Array, Array]:
        """Both ends of the beam at instants, (n, 3) [m] each; an axis that is free may turn to any angle."""
        if self._study is None:
            return _NOTHING[0, :0], _NOTHING[0, :0]
        study, actuator = self._study, self._actuator
        time = np.linspace(0.0, study.duration, INSTANTS)

        def displacement(law: MotionLaw | None, start: float, free: Array) -> Array:
            return free if law is None else start + kinematics.motion_law(law, time)[0]

        turn = np.linspace(0.0, 2 * np.pi, INSTANTS)
        angle = displacement(study.motion.rotation, actuator.angle, turn)
        elevation = displacement(study.motion.elevation, actuator.elevation, turn)
        length = displacement(study.motion.extension, actuator.free_length, np.full(INSTANTS, actuator.length))
        along = beam_frame(actuator, angle, elevation)[:, 0]
        tip = actuator.hub_radius + length
        return (tip - actuator.length)[:, None] * along, tip[:, None] * along

    def _straight(self, length: float) -> tuple[Array, Array]:
        """Axes of the beam at t = 0, and its straight line."""
        actuator = self._actuator
        axes = beam_frame(actuator, actuator.angle, actuator.elevation)
        return axes, straight_beam(actuator, axes, length, np.linspace(0.0, 1.0, BEAM_POINTS))

    def _eta(self, length: float) -> Array:
        """Places of the drawn points on the whole beam, from its inner end (0) to the tip (1)."""
        return 1 - (1 - np.linspace(0.0, 1.0, BEAM_POINTS)) * length / self._actuator.length

    def legend(self) -> str:
        """Legend of the beam as HTML: its axes, and the meaning of the colours."""
        space = self._study is not None and self._study.actuator.space
        title = "<b>The beam</b> (Z up)" if space else "<b>The beam in its plane of motion</b> (X to the right, Y up)"
        return (
            f'<div style="{LEGEND_STYLE}">{title}<br>'
            "blue: outside the hub, bent; light grey: inside the hub and behind it; grey line: as if rigid</div>"
        )

    def close(self) -> None:
        """Drop study, result and nodes; nothing is drawn any more."""
        with self.lock:
            super().close()
            self._study = self._motion = None
            self._nodes = {}

    def _make(self, actuator: model.Actuator) -> dict[str, Any]:
        scene, reach = self.client.scene, actuator.hub_radius + actuator.length
        radius = 0.008 * reach
        hub = max(actuator.hub_radius, 0.03 * reach)
        if actuator.space:  # it turns about two axes
            scene.add_icosphere("/hub", hub, color=_HUB, opacity=0.6)
        else:
            vertices, faces = disc(hub, 3 * radius)
            scene.add_mesh_simple("/hub", vertices, faces, color=_HUB, opacity=0.6, flat_shading=True)
        self._add("labels", scene.add_label("/hub_name", "hub", position=(0, 0, -1.3 * hub), anchor="top-center"))
        plane, place = ("xy", [0.0, 0.0, -reach]) if actuator.space else ("xz", [0.0, 0.05 * reach, 0.0])
        self._add("grid", add_grid(scene, 3 * reach, plane, np.array(place)))
        frame = scene.add_frame("/frame", axes_length=0.15 * reach, axes_radius=0.004 * reach)
        self._add("frames", frame)
        line = {"thickness": 2.0, "thickness_units": "screen"}
        ghost = scene.add_line_segments("/ghost_beam", _NOTHING, _GHOST, **line)
        path = scene.add_line_segments("/path", _NOTHING, _TIP, **line)
        arrow = scene.add_arrows("/deflection", _NOTHING, _TIP, shaft_radius=0.004 * reach, head_radius=0.01 * reach)
        words = scene.add_label("/deflection_length", "", position=_HERE, anchor="bottom-left")
        tip_radius = 3.0 * radius if actuator.tip_mass else 1.3 * radius
        tip = scene.add_icosphere("/tip", tip_radius, color=_HUB)
        self._add(
            "labels",
            scene.add_label(
                "/tip/name",
                f"tip, {number(actuator.tip_mass)} kg" if actuator.tip_mass else "tip",
                position=_HERE,
                anchor="top-left",
            ),
        )
        empty = np.zeros((BEAM_POINTS * 8, 3))
        inside = scene.add_mesh_simple("/beam_inside", np.zeros((16, 3)), tube_faces(2), color=_INSIDE)
        return {
            "beam": scene.add_mesh_simple("/beam", empty, tube_faces(BEAM_POINTS), color=_BEAM),
            "inside": inside,
            "tip": tip,
            "stripe": scene.add_line_segments("/stripe", _NOTHING, _STRIPE, **line),
            "ghost": self._add("rigid ghost", ghost),
            "path": self._add("paths", path),
            "arrow": self._add("deviation arrow", arrow),
            "words": self._add("deviation arrow", words),
        }

    def _draw(self, line: Array, axes: Array, length: float, twist: Array | float = 0.0) -> None:
        """The beam outside the hub, a stripe along it that shows its twist [rad], and what is behind the mouth."""
        actuator = self._actuator
        radius = 0.008 * (actuator.hub_radius + actuator.length)
        behind = line[0] - max(actuator.length - length, 1e-3 * actuator.length) * axes[0]
        turn = np.broadcast_to(twist, len(line))[:, None]
        stripe = line + 1.1 * radius * (np.cos(turn) * axes[2] - np.sin(turn) * axes[1])
        self._nodes["beam"].vertices = tube(line, radius)
        self._nodes["inside"].vertices = tube(np.stack([behind, line[0]]), 0.9 * radius)
        self._nodes["tip"].position = line[-1]
        if actuator.GJ is not None:
            self._nodes["stripe"].points = np.stack([stripe[:-1], stripe[1:]], axis=1)

    def _draw_ghost(self, line: Array) -> None:
        self._nodes["ghost"].points = np.stack([line[:1], line[-1:]], axis=1)

    def _mark(self, start: Array, end: Array, deflection: float) -> None:
        """Arrow from the rigid to the drawn tip; in words the true deflection."""
        length = float(np.linalg.norm(end - start))
        self._nodes["arrow"].points = np.stack([start, end])[None]
        self._nodes["arrow"].head_length = round(min(0.06, 0.5 * length), 4)
        self._nodes["words"].text = f"deflection {text(deflection, 'm')}"
        self._nodes["words"].position = end

    def _take(self, data: Dataset | None) -> BeamMotion | None:
        self._motion = None if data is None or self._study is None else BeamMotion(self._study, data)
        return self._motion

    def _redraw_paths(self) -> None:
        if self._motion is not None:
            self._nodes["path"].points = path_segments(self._motion.tips(self.scale), most=1500)
