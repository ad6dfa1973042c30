"""Modes of a robot with its drives locked: a list at a pose, one of them drawn and animated."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from viser import Icon

from flexapod import model, rigid
from flexapod.app.view import words
from flexapod.app.view.dial import Dial
from flexapod.app.view.listed_modes import Listed, ListedModes
from flexapod.app.view.robot_scene import pose_words
from flexapod.app.view.threads import Threads
from flexapod.scene.skeleton import Skeleton
from flexapod.study.words import held, number

if TYPE_CHECKING:
    import viser

__all__ = ["RobotModes"]

LISTED = 24  # modes in the list


class RobotModes(ListedModes[model.Study]):
    """Controls of a robot's modes for one user."""

    size = "the robot's size"

    def _add_controls(self, gui: viser.GuiApi, threads: Threads) -> None:
        """Sliders of the pose from home: millimetres and degrees; `_fit` sets how far the former reach."""
        self._pose: dict[str, Dial] = {}
        with gui.add_folder("Pose from home"):
            for name in model.AXES[:3]:
                self._pose[name] = Dial(
                    gui, threads, name, "mm", (-1.0, 1.0), 1.0, 0.0, self._moved, dimension="length"
                )
            for name in model.AXES[3:]:
                self._pose[name] = Dial(
                    gui, threads, name, "deg", (-60.0, 60.0), 0.5, 0.0, self._moved, dimension="angle"
                )
            home = gui.add_button("Home", icon=Icon.HOME)
        home.on_click(lambda _: self._go_home())

    def _fit(self, study: model.Study) -> None:
        """The chosen pose stays, within sliders that reach half as far as a leg is long and that the robot follows."""
        reach = 500.0 * float(study.robot.home_lengths.mean())
        reach = float(f"{reach:.1g}")
        for name in model.AXES[:3]:
            self._pose[name].fit(-reach, reach, reach / 500)
        limbs = rigid.rigid_limbs(study.robot)
        free = rigid.independent_axes(limbs, np.zeros(6, dtype=bool), np.zeros(3))
        for name, moves in zip(model.AXES, free, strict=True):
            self._pose[name].disabled = not moves
            self._pose[name].value *= moves

    def _listed(self, study: model.Study) -> Listed:
        from flexapod import study as fx

        pose = self._at()
        found = fx.modes(study, pose)
        rows = [
            [str(int(m)), number(float(f), 4), number(100 * float(d), 3), str(kind)]
            for m, f, d, kind in zip(found.mode, found.frequency, found.damping_ratio, found.kind.values, strict=True)
        ][:LISTED]
        header = ["Mode", "frequency [Hz]", "damping [%]", "what moves most"]
        more = found.sizes["mode"] - len(rows)
        table = (
            words.table_html(header, rows)
            + (words.block(f"and {more} higher ones", "soft") if more > 0 else "")
            + words.block(f"{held(study.robot)}, about the static equilibrium at the pose above.", "soft")
        )
        names = [f"{m}: {f} Hz, {kind}" for m, f, _, kind in rows]
        return Listed(found, names, table, pose_words(pose), Skeleton(study.robot).size)

    def _preview(self, study: model.Study) -> None:
        self.scene.show_pose(self._at())

    def _at(self) -> dict[str, float]:
        """The pose of the sliders in m and rad; what the robot's legs make of the others follows."""
        units: dict[str, float] = dict(zip(model.AXES, [1e-3] * 3 + [math.pi / 180] * 3, strict=True))
        return {name: units[name] * dial.value for name, dial in self._pose.items() if not dial.disabled}

    def _go_home(self) -> None:
        for dial in self._pose.values():
            dial.value = 0.0
        self._moved()
