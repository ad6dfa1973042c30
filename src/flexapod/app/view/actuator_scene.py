"""A single actuator in the browser: hub, sliding beam bent in its plane, rigid ghost, path of the tip."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod import model
from flexapod.app.view.legend import LEGEND_STYLE, rgb
from flexapod.app.view.robot_parts import add_grid
from flexapod.app.view.scene import OF_RESULTS, STRAIGHT, Scene, mode_note
from flexapod.scene.geometry import (
    BEAM_POINTS,
    ActuatorMotion,
    across,
    beam_line,
    disc,
    hub_axes,
    strip,
    tube,
    tube_faces,
)
from flexapod.study.words import number, text
from flexapod.typing import Array

if TYPE_CHECKING:
    import viser
    from xarray import Dataset

    from flexapod.scene.beam_modes import BeamModes

__all__ = ["ActuatorScene"]

_BEAM, _HUB, _INSIDE, _GHOST, _TIP = rgb("#0072B2"), rgb("#4A4F57"), rgb("#B5BAC1"), rgb("#7A7A7A"), rgb("#C2185B")
_HERE = (0.0, 0.0, 0.0)
_NOTHING = np.zeros((1, 2, 3))


class ActuatorScene(Scene):
    """One user's view of a single actuator; the plane of motion X, Y stands upright, as world x, z."""

    def __init__(self, client: viser.ClientHandle) -> None:
        super().__init__(client)
        self._study: model.ActuatorStudy | None = None
        self._motion: ActuatorMotion | None = None
        self._nodes: dict[str, Any] = {}

    def show_study(self, study: model.ActuatorStudy) -> None:
        """As `Scene.show_study`."""
        with self.lock:
            if self._closed:
                return
            first, actuator = self._study is None, study.actuator
            self._study, self._motion = study, None
            with self.client.atomic():
                if first:
                    self._light()
                self._begin()
                self._nodes = self._make(actuator)
                self.show_pose((actuator.angle, actuator.free_length))
            if first:
                reach = actuator.hub_radius + actuator.length
                beside = reach * np.array([0.7, 0.0, 0.0])  # the panel covers the right of the page
                self._look(reach * np.array([0.0, -1.6, 0.2]), beside)

    def show_pose(self, pose: tuple[float, float]) -> None:
        """As `Scene.show_pose`; angle from the horizontal [rad] and length outside the hub [m]."""
        with self.lock:
            if self._study is None:
                return
            line = beam_line(self._study.actuator, pose[0], pose[1], np.linspace(0.0, 1.0, BEAM_POINTS))
            with self.client.atomic():
                self._only()
                self._draw(self._study.actuator, line, hub_axes(0.0, pose[0])[0], pose[1])
                self._draws(f"the straight beam, {text(pose[1], 'm', 4)} outside the hub", STRAIGHT)

    def set_time(self, time: float) -> None:
        """As `Scene.set_time`."""
        with self.lock:
            if self._motion is None:
                return
            self.time = float(time)
            i, bent, straight = self._motion.at(time, self.scale)
            with self.client.atomic():
                self._only(*OF_RESULTS)
                self._draw(self._motion.actuator, bent, self._motion.axes(i)[0], float(self._motion.length[i]))
                self._draw_ghost(straight)
                self._mark(straight[-1], bent[-1], float(self._motion.deflection[i]))
                self._draws("")

    def show_mode(self, modes: BeamModes, mode: int, amplitude: float, phase: float, where: str = "") -> None:
        """As `Scene.show_mode`; the size is the free length."""
        with self.lock:
            if self._study is None:
                return
            actuator, length = self._study.actuator, modes.free_length
            line = beam_line(actuator, actuator.angle, length, np.linspace(0.0, 1.0, BEAM_POINTS))
            bent = line + across(actuator.angle, amplitude * length * phase * modes.shape[mode - 1])
            with self.client.atomic():
                self._only("rigid ghost")
                self._draw(actuator, bent, hub_axes(0.0, actuator.angle)[0], length)
                self._draw_ghost(line)
                self._draws(f"mode {mode}{where and f' at {where}'}", mode_note(amplitude * length))

    def legend(self) -> str:
        """As `Scene.legend`."""
        return (
            f'<div style="{LEGEND_STYLE}"><b>The beam in its plane of motion</b> (X to the right, Y up)<br>'
            "blue: outside the hub, bent; light grey: inside the hub and behind it; grey line: as if rigid</div>"
        )

    def close(self) -> None:
        """As `Scene.close`."""
        with self.lock:
            super().close()
            self._study = self._motion = None
            self._nodes = {}

    def _make(self, actuator: model.Actuator) -> dict[str, Any]:
        scene, reach = self.client.scene, actuator.hub_radius + actuator.length
        radius = 0.008 * reach
        hub = max(actuator.hub_radius, 0.03 * reach)
        vertices, faces = disc(hub, 3 * radius)
        scene.add_mesh_simple("/hub", vertices, faces, color=_HUB, opacity=0.6, flat_shading=True)
        self._add("labels", scene.add_label("/hub_name", "hub", position=(0, 0, -1.3 * hub), anchor="top-center"))
        self._add("grid", add_grid(scene, 3 * reach, "xz", np.array([0.0, 0.05 * reach, 0.0])))
        frame = scene.add_frame("/frame", axes_length=0.15 * reach, axes_radius=0.004 * reach)
        self._add("frames", frame)
        line = {"thickness": 2.0, "thickness_units": "screen"}
        ghost = scene.add_line_segments("/ghost_beam", _NOTHING, _GHOST, **line)
        path = scene.add_line_segments("/path", _NOTHING, _TIP, **line)
        arrow = scene.add_arrows("/deflection", _NOTHING, _TIP, shaft_radius=0.004 * reach, head_radius=0.01 * reach)
        words = scene.add_label("/deflection_length", "", position=_HERE, anchor="bottom-left")
        tip_radius = 3.0 * radius if actuator.tip_mass else 1.3 * radius
        tip = scene.add_icosphere("/tip", tip_radius, color=_HUB)
        self._add("labels", scene.add_label("/tip/name", _tip_words(actuator), position=_HERE, anchor="top-left"))
        empty = np.zeros((BEAM_POINTS * 8, 3))
        inside = scene.add_mesh_simple("/beam_inside", np.zeros((16, 3)), tube_faces(2), color=_INSIDE)
        return {
            "beam": scene.add_mesh_simple("/beam", empty, tube_faces(BEAM_POINTS), color=_BEAM),
            "inside": inside,
            "tip": tip,
            "ghost": self._add("rigid ghost", ghost),
            "path": self._add("paths", path),
            "arrow": self._add("deviation arrow", arrow),
            "words": self._add("deviation arrow", words),
        }

    def _draw(self, actuator: model.Actuator, line: Array, axis: Array, length: float) -> None:
        """The beam outside the hub, and what is left of it behind the mouth along the hub's axis."""
        radius = 0.008 * (actuator.hub_radius + actuator.length)
        behind = line[0] - max(actuator.length - length, 1e-3 * actuator.length) * axis
        self._nodes["beam"].vertices = tube(line, radius)
        self._nodes["inside"].vertices = tube(np.stack([behind, line[0]]), 0.9 * radius)
        self._nodes["tip"].position = line[-1]

    def _draw_ghost(self, line: Array) -> None:
        self._nodes["ghost"].points = np.stack([line[:1], line[-1:]], axis=1)

    def _mark(self, start: Array, end: Array, deflection: float) -> None:
        """Arrow from the rigid to the drawn tip; in words the true deflection."""
        length = float(np.linalg.norm(end - start))
        self._nodes["arrow"].points = np.stack([start, end])[None]
        self._nodes["arrow"].head_length = round(min(0.06, 0.5 * length), 4)
        self._nodes["words"].text = f"deflection {text(deflection, 'm')}"
        self._nodes["words"].position = end

    def _take(self, data: Dataset | None) -> ActuatorMotion | None:
        self._motion = None if data is None or self._study is None else ActuatorMotion(self._study, data)
        return self._motion

    def _redraw_paths(self) -> None:
        if self._motion is not None:
            self._nodes["path"].points = strip(self._motion.tips(self.scale), most=1500)


def _tip_words(actuator: model.Actuator) -> str:
    return f"tip, {number(actuator.tip_mass)} kg" if actuator.tip_mass else "tip"
