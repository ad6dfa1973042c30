"""Runs of one study with other settings: each once, timed, a failed one with its message."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.results.time_history import Report
from flexapod.analysis.simulation import run
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError
from flexapod.common.quantities import text
from flexapod.model import ActuatorStudy, Study
from flexapod.model.study.simulation import OWN_BASIS, STRAIGHT

if TYPE_CHECKING:
    from xarray import Dataset

#: What is compared, by name, in words. The first that a study has is what the accuracy is asked of.
QUANTITIES = {"deviation": "deviation of the centre of mass", "tip": "tip deflection"}
TIMED = 0.5  # a setting is run again until this has been timed [s]
REPEATS = 5  # but not more often
OVERHEAD = 0.12  # of a run beside its time integration, until one has been timed [s]
PER_STEP = 25e-6  # of a step without shapes, until one has been timed [s]
TOLERANCE_STEPS = 40  # steps per stored result that a tolerance is guessed to take


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Setting of a run: fidelity, basis, shapes per plane, `step` or else `tolerance`, `output_step` [s]."""

    fidelity: str
    basis: str
    modes: int
    step: float | None
    tolerance: float | None = None
    output_step: float

    @property
    def shapes(self) -> int:
        """Lateral shapes per plane that count."""
        return 0 if self.fidelity in STRAIGHT else self.modes

    @property
    def label(self) -> str:
        """Fidelity and its shapes, elements or segments, as text."""
        n = self.shapes
        words = {
            "finite-segment": f"{n} segment{'s' * (n > 1)}",
            "beam-fem": f"{n // 2} element{'s' * (n > 3)}",
            "solid-fem": f"{n} shape{'s' * (n > 1)} of the solid",
            "assumed-modes": f"{n} {self.basis} shape{'s' * (n > 1)}",
        }
        return words.get(self.fidelity, self.fidelity)

    @property
    def time_words(self) -> str:
        """Step or tolerance as text."""
        return f"tolerance {self.tolerance:g}" if self.step is None else f"step {text(self.step, 's', 5)}"

    def lines(self) -> list[str]:
        """Lines of [simulation]."""
        own = self.fidelity in OWN_BASIS or not self.shapes
        time = f"tolerance = {self.tolerance:g}" if self.step is None else f"step = {self.step:.10g}"
        return [
            f'fidelity = "{self.fidelity}"',
            *([] if own else [f'basis = "{self.basis}"']),
            *([f"modes = {self.modes}"] if self.shapes else []),
            time,
        ]


def setting_of(study: Study | ActuatorStudy) -> Setting:
    """The setting of a study's file."""
    s = study.simulation
    return Setting(
        fidelity=s.fidelity, basis=s.basis, modes=s.modes, step=s.step, tolerance=s.tolerance, output_step=s.output_step
    )


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A run: curves (T, ..., component) [m] by quantity at `time` [s], steps, seconds of time integration.

    `failure`: why there are no curves, or "".
    """

    setting: Setting
    time: Array
    curves: Mapping[str, Array]
    steps: int
    seconds: float
    failure: str = ""

    def peak(self, quantity: str) -> float:
        """Largest size [m]; NaN of a failed run."""
        return float(np.linalg.norm(self.curves[quantity], axis=-1).max()) if not self.failure else float("nan")

    def common_values(self, other: Trial, quantity: str) -> tuple[Array, Array]:
        """Values of both at the instants that both have."""
        spacing = float(other.time[1] - other.time[0])
        at = np.rint(self.time / spacing).astype(int)
        both = (np.abs(self.time / spacing - at) < 1e-6) & (at < len(other.time))
        return self.curves[quantity][both], other.curves[quantity][at[both]]


class Trials:
    """Runs of a study; each setting is computed once, however often it is asked for.

    Parameters
    ----------
    study : Study or ActuatorStudy
    """

    def __init__(self, study: Study | ActuatorStudy) -> None:
        self.study = study
        self.report: Report | None = None
        self._known: dict[Setting, Trial] = {}
        self._planned: dict[Setting, float] = {}
        self._per_step, self._overhead = PER_STEP, OVERHEAD
        self._done = self._whole = 0.0

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the compared quantities; the accuracy is asked of the first."""
        return ("tip",) if isinstance(self.study, ActuatorStudy) else ("deviation", "tip")

    def __contains__(self, setting: Setting) -> bool:
        return setting in self._known

    def run(self, setting: Setting) -> Trial:
        """The run with a setting; the median time of several where it is short."""
        if setting not in self._known:
            weight = self._planned.get(setting) or self.cost(setting)
            self._known[setting] = self._measured(setting, weight)
            self._done += weight
        return self._known[setting]

    def cost(self, setting: Setting) -> float:
        """Seconds that a setting is expected to take, repeats and all; 0 if it is known."""
        if setting in self._known:
            return 0.0
        once = self.steps(setting) * self.per_step(setting)
        return (self._overhead + once) * min(REPEATS, math.ceil(TIMED / once))

    def steps(self, setting: Setting) -> float:
        """Number of steps expected."""
        step = setting.step or setting.output_step / TOLERANCE_STEPS
        return self.study.duration / step

    def per_step(self, setting: Setting) -> float:
        """Seconds that a step is expected to take, scaled from the last run."""
        return self._per_step * _work(setting)

    def plan(self, settings: list[Setting]) -> float:
        """Make the bar end after these settings; returns their expected seconds."""
        self._planned = {setting: self.cost(setting) for setting in settings if setting not in self._known}
        ahead = sum(self._planned.values())
        self._whole = self._done + ahead
        return ahead

    def _measured(self, setting: Setting, weight: float) -> Trial:
        trial = self._once(setting, weight)
        if trial.failure:
            return trial
        seconds = [trial.seconds]
        while len(seconds) < REPEATS and sum(seconds) < TIMED:
            begin = perf_counter()
            seconds.append(self._once(setting, weight).seconds)
            self._overhead = perf_counter() - begin - seconds[-1]
        self._per_step = median(seconds) / max(trial.steps, 1) / _work(setting)
        return replace(trial, seconds=median(seconds))

    def _once(self, setting: Setting, weight: float) -> Trial:
        before, whole = self._done, max(self._whole, self._done + weight)

        def progress(time: float, end: float) -> None:
            if self.report is not None:
                self.report(f"{setting.label}, {setting.time_words}", min(1.0, (before + weight * time / end) / whole))

        try:
            data = run(self._with(setting), progress=progress)
        except FlexapodError as error:
            return _failed(setting, str(error))
        if data.attrs["partial"]:
            return _failed(setting, str(data.attrs["failure"]))
        return Trial(
            setting=setting,
            time=data.time.values,
            curves=_curves(data),
            steps=int(data.attrs["steps"]),
            seconds=float(data.attrs["wall_time"]),
        )

    def _with(self, s: Setting) -> Study | ActuatorStudy:
        names = ("fidelity", "modes", "step", "tolerance", "output_step")
        changes = {name: getattr(s, name) for name in (*names, *(["basis"] * (s.fidelity not in OWN_BASIS)))}
        return self.study.replace(simulation=self.study.simulation.replace(**changes))


def _work(setting: Setting) -> float:
    """Work of a step against that of one without shapes: measured on six legs with 0 to 12 shapes a plane."""
    k = setting.shapes
    return 1 + 0.09 * k + 0.03 * k**2


def _failed(setting: Setting, why: str) -> Trial:
    return Trial(setting=setting, time=np.zeros(0), curves={}, steps=0, seconds=float("nan"), failure=why)


def _curves(data: Dataset) -> dict[str, Array]:
    if "com_deviation" not in data:
        return {"tip": data.tip_deflection.values.reshape(data.sizes["time"], -1)}
    return {"deviation": data.com_deviation.values, "tip": data.tip_deflection.values}
