"""A robot in the browser: legs with their bent pistons, payload, rigid ghost, paths, deviation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import viser

from flexapod import kinematics, model
from flexapod.analysis.results.arguments import PoseLike, as_pose
from flexapod.app.browser.legend import QUANTITIES, LegColors, leg_colors, plain_legend, rgb
from flexapod.app.browser.robot_parts import LABELS, Deviation, Ghost, RobotParts, SceneNodes
from flexapod.app.browser.scene import OF_RESULTS, STRAIGHT, PageScene, mode_note
from flexapod.common.arrays import Array
from flexapod.common.quantities import number
from flexapod.output.scene.geometry import RobotMotion
from flexapod.output.scene.robot_scene import mode_scene
from flexapod.output.scene.skeleton import Skeleton
from flexapod.output.scene.style import colors_of_legs

if TYPE_CHECKING:
    from xarray import Dataset


#: From which directions robots in space and in a plane are seen.
_EYES = {None: (1.1, -0.95, 0.35), "xy": (0.1, -0.6, 1.4), "yz": (1.4, -0.6, 0.3), "zx": (0.6, -1.4, 0.3)}
_NOWHERE = np.zeros((0, 3))
INSTANTS = 17  # of a motion, at which the picture has to hold the robot


@dataclass(frozen=True, kw_only=True)
class _Drawn:
    """A study with the nodes that show it."""

    study: model.Study
    skeleton: Skeleton
    robot: RobotParts
    ghost: Ghost
    deviation: Deviation


class RobotScene(PageScene):
    """One user's view of a robot."""

    quantities: tuple[str, ...] = QUANTITIES

    def __init__(self, client: viser.ClientHandle) -> None:
        super().__init__(client)
        self._drawn: _Drawn | None = None
        self._motion: RobotMotion | None = None
        self._colors: LegColors | None = None
        self._names: frozenset[str] = frozenset()  # of the nodes that the robot before had
        self._at_rest: Dataset | None = None  # the modes whose equilibrium the ghost shows

    @property
    def points(self) -> tuple[str, ...]:
        """Points whose deviation the result has: "tool" first where it is apart, and "com"."""
        return ("tool", "com") if self._motion is not None and self._motion.tool_apart else ("com",)

    @property
    def _plain(self) -> Array:
        """Colours of the legs by their number."""
        count = 6 if self._drawn is None else len(self._drawn.study.robot.legs)
        return np.array([rgb(color) for color in colors_of_legs(count)])

    def show_study(self, study: model.Study) -> None:
        """Draw the rigid robot of a study at the instant that was shown; no result is shown any more."""
        with self.lock:
            if self._closed:
                return
            first = self._drawn is None
            self._motion = self._colors = self._at_rest = None
            with self.client.atomic():
                if first:
                    self._light()
                self._begin()
                api = SceneNodes(self.client.scene)
                robot = Skeleton(study.robot)
                drawn = self._drawn = _Drawn(
                    study=study,
                    skeleton=robot,
                    robot=RobotParts(api, self._add, robot),
                    ghost=Ghost(api, self._add, robot),
                    deviation=Deviation(api, self._add, robot.size),
                )
                self._names = api.replaces(self._names)
                self._only()
                start = kinematics.poses(study.robot, study.motion, [self.time])
                drawn.robot.draw(robot.scene_at(start.position[0], start.rotation[0]), self._plain)
                self._draws(f"the rigid robot at {number(self.time, 4)} s; no result yet", STRAIGHT)
            if first:
                self._look(np.array(_EYES[study.robot.plane]))

    def show_pose(self, pose: PoseLike) -> None:
        """Draw the undeformed robot at a pose as for `flexapod.modes`, in reach or not; InputError for no pose."""
        with self.lock:
            if self._drawn is None:
                return
            path = as_pose(self._drawn.study.robot, pose, check=False)
            points = self._drawn.skeleton.scene_at(path.position[0], path.rotation[0])
            with self.client.atomic():
                self._only()
                self._drawn.robot.draw(points, self._plain)
                self._draws(f"the undeformed robot at {pose_words(pose)}", STRAIGHT)

    def set_time(self, time: float) -> None:
        """Draw robot, rigid ghost and deviation at the stored instant nearest to `time` [s]."""
        with self.lock:
            if self._drawn is None or self._motion is None:
                return
            self.time: float = float(time)
            now = self._motion.instant_at(time, self.scale, self.point)
            with self.client.atomic():
                self._only(*OF_RESULTS)
                self._drawn.robot.draw(now.flexible, self._leg_colors(now.index))
                self._drawn.ghost.draw(now.rigid)
                self._at_rest = None
                self._drawn.deviation.draw(now)
                self._draws("")

    def show_mode(self, modes: Dataset, mode: int, amplitude: float, phase: float, where: str = "") -> None:
        """Draw a mode of the robot, `amplitude` as a share of the robot's size."""
        with self.lock:
            if self._drawn is None:
                return
            size = amplitude * self._drawn.skeleton.size
            with self.client.atomic():
                self._only("rigid ghost")
                self._drawn.robot.draw(mode_scene(modes, mode, size, phase), self._plain)
                if modes is not self._at_rest:
                    self._drawn.ghost.draw(mode_scene(modes, mode, size, 0.0))
                    self._at_rest = modes
                self._draws(f"mode {mode}{where and f' at {where}'}", mode_note(size))

    def legend(self) -> str:
        """Legend of the legs' colours as HTML, with the values at the time that is shown."""
        with self.lock:
            if self._motion is None or self.drawn:
                return plain_legend(len(self._plain))
            index = self._motion.index(self.time)
            self._leg_colors(index)
            return plain_legend(len(self._plain)) if self._colors is None else self._colors.html(index)

    def colour_by(self, quantity: str) -> None:
        """Colour the legs by "force", "stroke margin", "bending", or by their number ("plain")."""
        with self.lock:
            self._colors = None
            super().colour_by(quantity)

    def close(self) -> None:
        """Drop study, result and colours; nothing is drawn any more."""
        with self.lock:
            super().close()
            self._motion = self._colors = self._at_rest = self._drawn = None

    def _leg_colors(self, index: int) -> Array:
        if self.quantity == "plain" or self._drawn is None or self.data is None:
            return self._plain
        if self._colors is None:
            self._colors = leg_colors(self.quantity, self._drawn.study, self.data)
        return self._colors.colors(index)

    def _take(self, data: Dataset | None) -> RobotMotion | None:
        self._motion = self._colors = None
        if data is not None and self._drawn is not None:
            self._motion = RobotMotion(self._drawn.study, data)
            self.point: str = self._wanted if self._motion.tool_apart else "com"
        return self._motion

    def _redraw_paths(self) -> None:
        if self._motion is not None and self._drawn is not None:
            self._drawn.deviation.paths(*self._motion.paths(self.scale, self.point))

    def _whole(self) -> tuple[Array, Array]:
        """Points (n, 3) [m] of the robot at home and along its motion, and those of payload and tool with labels."""
        if self._drawn is None:
            return _NOWHERE, _NOWHERE
        study, skeleton = self._drawn.study, self._drawn.skeleton
        found = kinematics.poses(study.robot, study.motion, np.linspace(0.0, study.duration, INSTANTS))
        seen = [skeleton.scene_at(x, R) for x, R in zip(found.position, found.rotation, strict=True)] + [skeleton.home]
        labelled = [place for scene in seen for place in (scene.com, scene.centre + scene.rotation @ skeleton.tool)]
        return np.vstack([*(scene.points for scene in seen), skeleton.home.base * LABELS]), np.array(labelled)


def pose_words(pose: PoseLike) -> str:
    """A pose from home in a few words: "heave 80 mm, roll 5 deg"."""
    named = pose if isinstance(pose, Mapping) else {}
    moved = {name: float(named[name]) for name in model.AXES if named.get(name)}
    words = [
        f"{name} {number(1e3 * v, 4)} mm" if name in model.AXES[:3] else f"{name} {number(math.degrees(v), 4)} deg"
        for name, v in moved.items()
    ]
    return ", ".join(words) or ("home" if isinstance(pose, Mapping) else "another pose")
