"""The tab "Modes": of a robot at a pose, chosen and animated; of a single actuator's beam at a length."""

from __future__ import annotations

import math
import threading
from typing import TYPE_CHECKING

import numpy as np
import viser
from viser import Icon

from flexapod import analysis as fx
from flexapod import kinematics, model
from flexapod.analysis.results.idealizations import soft_drives
from flexapod.app.browser import markup
from flexapod.app.browser.background import Threads
from flexapod.app.browser.listed_modes import ModeControls, ModeTable
from flexapod.app.browser.robot_scene import pose_words
from flexapod.app.browser.scene import PageScene
from flexapod.app.browser.text_fields import NumberField
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.quantities import number, text
from flexapod.output.scene.geometry import BEAM_POINTS
from flexapod.output.scene.skeleton import Skeleton
from flexapod.output.text.description import locked_drive_words

if TYPE_CHECKING:
    from flexapod.analysis.description import actuator_description
    from flexapod.output.scene import robot_scene
    from flexapod.output.scene.robot_scene import BeamModes as Shapes
else:
    actuator_description = LazyModule("flexapod.analysis.description.actuator_description")
    robot_scene = LazyModule("flexapod.output.scene.robot_scene")


LISTED = 24  # modes in the list


class RobotModeControls(ModeControls[model.Study]):
    """Controls of a robot's modes for one user."""

    size = "the robot's size"

    def _add_controls(self, gui: viser.GuiApi, threads: Threads) -> None:
        """Sliders of the pose from home: millimetres and degrees; `_fit` sets how far the former reach."""
        self._pose: dict[str, NumberField] = {}
        with gui.add_folder("Pose from home"):
            for name in model.AXES[:3]:
                self._pose[name] = NumberField(
                    gui, threads, name, "mm", (-1.0, 1.0), 1.0, 0.0, self._moved, dimension="length"
                )
            for name in model.AXES[3:]:
                self._pose[name] = NumberField(
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
        limbs = kinematics.rigid_limbs(study.robot)
        free = kinematics.independent_axes(limbs, np.zeros(6, dtype=bool), np.zeros(3))
        for name, moves in zip(model.AXES, free, strict=True):
            self._pose[name].disabled = not moves
            self._pose[name].value *= moves

    def _listed(self, study: model.Study) -> ModeTable:
        pose = self._at()
        found = fx.modes(study, pose)
        rows = [
            [str(int(m)), number(float(f), 4), number(100 * float(d), 3), str(kind)]
            for m, f, d, kind in zip(found.mode, found.frequency, found.damping_ratio, found.kind.values, strict=True)
        ][:LISTED]
        header = ["Mode", "frequency [Hz]", "damping [%]", "what moves most"]
        more = found.sizes["mode"] - len(rows)
        table = (
            markup.table_html(header, rows)
            + (markup.block(f"and {more} higher ones", "soft") if more > 0 else "")
            + markup.block(
                f"{locked_drive_words(soft_drives(study.robot))}, about the static equilibrium at the pose above.",
                "soft",
            )
        )
        names = [f"{m}: {f} Hz, {kind}" for m, f, _, kind in rows]
        return ModeTable(found, names, table, pose_words(pose), Skeleton(study.robot).size)

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


MOVED = 0.1  # after the slider has moved, before the modes are computed [s]
MOST = 12  # shapes


class BeamModeControls(ModeControls[model.ActuatorStudy]):
    """Length and number of shapes of a beam, and the modes they give, for one user."""

    size = "the free length"

    def _add_controls(self, gui: viser.GuiApi, threads: Threads) -> None:
        def resize() -> None:
            self._moved(MOVED)

        self._length = NumberField(
            gui,
            threads,
            "free length",
            "m",
            (0.0, 1.0),
            0.01,
            0.5,
            resize,
            dimension="length",
            hint="Outside the hub",
        )
        self._count = NumberField(gui, threads, "shapes", "", (1, MOST), 1, 3, resize, hint="Lateral shapes, and modes")

    def _fit(self, study: model.ActuatorStudy) -> None:
        actuator = study.actuator
        self._length.fit(0.05 * actuator.length, actuator.length, 0.005 * actuator.length)
        self._length.value = actuator.free_length
        self._count.value = min(MOST, max(1, study.simulation.modes))

    def _listed(self, study: model.ActuatorStudy) -> ModeTable:
        still = _still(study, self._length.value, int(self._count.value))
        found = robot_scene.beam_modes(still, BEAM_POINTS)
        kinds = [f", {kind}" if study.actuator.space else "" for kind in found.kind]
        names = [
            f"{i}: {number(f, 4)} Hz{kind}" for i, (f, kind) in enumerate(zip(found.frequency, kinds, strict=True), 1)
        ]
        return ModeTable(
            found,
            names,
            _beam_table(found, still),
            f"{text(found.free_length, 'm', 4)} of free length",
            found.free_length,
        )

    def _preview(self, study: model.ActuatorStudy) -> None:
        self.scene.show_pose(self._length.value)


def _still(study: model.ActuatorStudy, length: float, count: int) -> model.ActuatorStudy:
    """The study at rest at a free length [m] with a number of shapes."""
    return study.replace(
        actuator=study.actuator.replace(free_length=length),
        simulation=study.simulation.replace(modes=count, duration=study.duration),
        motion=model.ActuatorMotion(),
        load=model.ActuatorLoad(),
    )


def _beam_table(modes: Shapes, study: model.ActuatorStudy) -> str:
    """Frequencies and damping as HTML, and the sag where the beam lies level."""
    rows = [
        [str(i), number(f, 4), number(100 * d, 3), kind]
        for i, (f, d, kind) in enumerate(zip(modes.frequency, modes.damping_ratio, modes.kind, strict=True), start=1)
    ]
    sag = actuator_description.describe_actuator(study).beam[0].sag
    level = f"The tip sags by {text(sag, 'm')} where the beam lies level. " if sag else ""
    note = level + "Hub and extension held, about the straight beam at rest."
    return markup.table_html(["Mode", "frequency [Hz]", "damping [%]", "what moves"], rows) + markup.block(note, "soft")


class ModesPanel:
    """Modes for one user; made inside the tab that holds them, with what `ModeControls` takes."""

    client: viser.ClientHandle
    scene: PageScene

    def __init__(self, client: viser.ClientHandle, scene: PageScene, threads: Threads) -> None:
        self.client, self.scene, self._threads = client, scene, threads
        self._place = client.gui.add_folder(None)
        self._lock = threading.Lock()
        self._inside: RobotModeControls | BeamModeControls | None = None

    def show_study(self, study: model.Study | model.ActuatorStudy) -> None:
        """List the modes of another study; computed in the background."""
        kind = RobotModeControls if isinstance(study, model.Study) else BeamModeControls
        with self._lock:
            if not isinstance(self._inside, kind):
                self._leave()
                with self._place:
                    self._inside = kind(self.client, self.scene, self._threads)
            self._inside.show_study(study)  # type: ignore[arg-type]

    def pause(self) -> None:
        """Stop a mode that moves."""
        with self._lock:
            if self._inside is not None:
                self._inside.pause()

    def close(self) -> None:
        """Stop, and drop what was computed."""
        with self._lock:
            self._leave()

    def _leave(self) -> None:
        if self._inside is not None:
            self._inside.close()
            self._inside = None
