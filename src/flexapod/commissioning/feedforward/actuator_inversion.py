"""Commands of a single actuator whose tip follows its rigid beam, by (T20.25) and (T22.20)-(T22.22).

Inputs of a linear system for a wanted output are bounded; they act before the output moves, and after.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from flexapod import kinematics
from flexapod.analysis.linear import linearize
from flexapod.commissioning.feedforward.command_table import save_study
from flexapod.common.arrays import Array, Complex
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.control import StateSpace
from flexapod.model import ActuatorStudy, CsvLaw, MotionLaw, RateLaw
from flexapod.solve.shapes import home

DECAY = 16.0  # time constants of the slowest zero before and after: e^-16 = 1e-7
MOST = 2**19  # instants
FINE = 60  # instants in the time of the fastest zero that the output can ask for
LEAST = 2048  # instants while the output moves
IMAGINARY = 1e-6  # of its size: a zero is on the axis
FREE = 1e-2  # of the response a thousand times as fast
KEPT = 1e-6  # of its largest size: of the input before and after what counts


@dataclass(frozen=True, kw_only=True)
class Inverse:
    """An input at instants ``time`` (n,) [s], 0 where the output begins to move: ``value`` (n,), and ``zeros`` [1/s].

    ``before``, ``after`` [s]: how long it acts while the output does not move yet and no longer.
    """

    time: Array
    value: Array
    zeros: Complex
    before: float
    after: float


def inverse(system: StateSpace, moving: float, bend: Callable[[Array], Array]) -> Inverse:
    """The bounded input of a system of one input and one output that moves freely at rest, Eq. (T22.20).

    Parameters
    ----------
    system : StateSpace
        Its output is a place: input over its second derivative is finite where nothing changes.
    moving : float
        How long the output moves, from rest to rest [s].
    bend : callable
        Second derivative of the output at instants (T,) from 0 to `moving`.

    Raises
    ------
    InputError
        Several channels; zeros on the imaginary axis: what is bounded would never end.
    """
    if len(system.inputs) != 1 or len(system.outputs) != 1 or system.sample is not None:
        raise InputError("is not a continuous system of one input and one output", key="system")
    zeros = system.zeros()
    zeros = zeros[np.abs(zeros) > 0]
    if (np.abs(zeros.real) <= IMAGINARY * np.abs(zeros)).any():
        worst = zeros[np.argmin(np.abs(zeros.real) / np.abs(zeros))]
        raise InputError(
            f"has a zero at {worst.real:.3g} {worst.imag:+.3g}i 1/s, on the imaginary axis: its input would never end",
            key="order",
            value="stable-inversion",
            allowed="zeros beside the axis: give what vibrates some damping",
        )
    ahead, behind = (_lasts(zeros[way * zeros.real > 0]) for way in (1, -1))
    whole = ahead + moving + behind
    fast = max([abs(z) for z in zeros if abs(z) < LEAST / moving], default=0.0)
    step = min(moving / LEAST, 2 * np.pi / (FINE * fast) if fast else np.inf)
    count = min(MOST, int(2 ** np.ceil(np.log2(whole / step))))
    step = whole / count
    time: Array = (step * np.arange(count) - ahead).astype(float)
    inside = (time >= 0) & (time <= moving)
    wanted = np.where(inside, bend(np.clip(time, 0.0, moving)), 0.0)
    hz = np.fft.rfftfreq(count, step).astype(float)
    value = np.fft.irfft(np.fft.rfft(wanted) / _bends(system, hz), count)  # (T22.20)
    acting = np.flatnonzero(np.abs(value) > KEPT * np.abs(value).max())
    first, last = float(time[acting[0]]), float(time[acting[-1]])
    kept = (time >= min(first, 0.0)) & (time <= max(last, moving))
    return Inverse(
        time=time[kept], value=value[kept], zeros=zeros, before=max(0.0, -first), after=max(0.0, last - moving)
    )


def _lasts(zeros: Complex) -> float:
    """Duration of inputs with these zeros [s]."""
    return DECAY / float(np.abs(zeros.real).min()) if zeros.size else 0.0


def _bends(system: StateSpace, hz: Array) -> Complex:
    """Second derivative of the output over the input at frequencies, the first of which is 0, Eq. (T22.21)."""
    s = 2j * np.pi * hz
    found = np.empty(len(hz), dtype=complex)
    found[1:] = s[1:] ** 2 * system.at(hz[1:])[0, 0]
    low = 1e-3 * hz[1]  # the double pole at rest cancels in the limit
    found[0] = (2j * np.pi * low) ** 2 * system.at([low])[0, 0, 0]
    if not abs(found[0]) > FREE * np.abs(found[1:3]).max():
        raise InputError(
            "does not move freely: where nothing changes its input would have to hold it",
            key="system",
            allowed="an input whose force, or acceleration, is in proportion to that of the output when slow",
        )
    return found


def linear_response(system: StateSpace, time: Array, value: Array) -> Array:
    """Outputs (outputs, n) at even instants of a system at rest under an input, straight between them, (T22.22)."""
    from scipy.linalg import expm

    n, h = len(system.A), time[1] - time[0]
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n], whole[:n, n], whole[n, n + 1] = system.A, system.B[:, 0], 1.0 / h
    step = expm(whole * h)
    x, found = np.zeros(n), np.empty((len(system.outputs), len(time)))
    for k, u in enumerate(value):
        found[:, k] = system.C @ x + system.D[:, 0] * u
        if k + 1 < len(value):
            x = step[:n, :n] @ x + step[:n, n] * u + step[:n, n + 1] * (value[k + 1] - u)
    return found


Drives = Literal["given", "force"]
ROWS = 4000  # of a table at most


@dataclass(frozen=True, kw_only=True)
class TipStudy:
    """An actuator study whose tip follows the path of the rigid beam, and what that costs.

    ``inverse``: input of the linear beam; ``miss`` (before, after) [m]: of the tip, at most, by the linear model;
    ``longer`` [s]: of the whole motion.
    """

    study: ActuatorStudy
    drives: Drives
    inverse: Inverse
    miss: tuple[float, float]

    @property
    def longer(self) -> float:
        """Time that the hub or its motor acts beyond the motion of the tip [s]."""
        return self.inverse.before + self.inverse.after

    @property
    def sentence(self) -> str:
        """Benefit, cost and effect as text."""
        what = "the hub's motor pushes" if self.drives == "force" else "the hub turns"
        early, late = (f"{text(x, 's')}" for x in (self.inverse.before, self.inverse.after))
        return (
            f"{what} so that the tip follows the path of the rigid beam: from {early} before the tip moves to {late} "
            f"after it has arrived, so that the motion takes {text(self.longer, 's')} more. By the linear model the "
            f"tip misses by {text(self.miss[1], 'm')} at most in place of {text(self.miss[0], 'm')}"
        )

    def __repr__(self) -> str:
        return f"TipStudy({self.sentence})"


def tip_inversion(study: ActuatorStudy, drives: Drives = "given", out: str | Path | None = None) -> TipStudy:
    """A study whose tip follows the path that a rigid beam would have; see `compensate`."""
    law, moving = _refuse(study, drives)
    turned = linearize(study, inputs="command:rotation", outputs="tip:rotation")
    pushed = linearize(study, inputs="drive:rotation", outputs="tip:rotation", drives="force")
    used, length = turned if drives == "given" else pushed, home(study.actuator)["extension"]
    found = inverse(used, moving, lambda t: length * kinematics.motion_law(law, t).acceleration)
    wanted = kinematics.motion_law(law, np.clip(found.time, 0.0, moving))
    bend = np.where((found.time >= 0) & (found.time <= moving), wanted.acceleration, 0.0)
    own, new = (
        np.abs(linear_response(system, found.time, value)[0] - length * wanted.position).max()
        for system, value in ((turned, bend), (used, found.value))
    )
    made = TipStudy(study=study, drives=drives, inverse=found, miss=(float(own), float(new)))
    return _tip_result(made, law, out)


def _tip_result(made: TipStudy, law: MotionLaw, out: str | Path | None) -> TipStudy:
    """The study that does it, with what it brings."""
    from scipy.interpolate import CubicSpline

    study, found = made.study, made.inverse
    time = found.time - found.time[0]
    some = np.unique(np.linspace(0, len(time) - 1, min(len(time), ROWS + 1)).astype(int))
    duration = None if study.simulation.duration is None else study.simulation.duration + made.longer
    simulation = study.simulation.replace(duration=duration or float(time[-1]))
    if made.drives == "force":
        motion = study.motion.replace(rotation=None)
        load = study.load.replace(torque=CsvLaw(time=time[some], value=found.value[some]))
    else:
        angle = CubicSpline(time, found.value).antiderivative(2)(time)
        motion, load = study.motion.replace(rotation=CsvLaw(time=time[some], value=angle[some])), study.load
    notes = (*study.notes, made.sentence)
    told = replace(made, study=study.replace(motion=motion, load=load, simulation=simulation, notes=notes))
    return told if out is None else replace(told, study=save_study(told.study, out))


def _refuse(study: ActuatorStudy, drives: str) -> tuple[MotionLaw, float]:
    """The law of the hub, and how long it moves [s]; what has no linear model is refused."""
    actuator, motion = study.actuator, study.motion
    if not isinstance(drives, str) or drives not in ("given", "force"):
        raise InputError("is not a way to take drives", key="drives", value=drives, allowed='"given", "force"')
    if motion.rotation is None or isinstance(motion.rotation, RateLaw) or motion.rotation.law == "spin-up":
        raise InputError(
            "does not bring the hub from rest to rest",
            file=study.path,
            key="motion.rotation",
            allowed='a profile, as { law = "smooth", amplitude = "20 deg", duration = "2 s" }, or a table',
        )
    extension = motion.extension
    moves = extension is not None and np.ptp(kinematics.motion_law(extension, np.linspace(0, study.duration, 101))[0])
    wrong = {
        "actuator.space": actuator.space,
        "actuator.gravity": actuator.gravity != 0,
        "motion.extension": bool(moves) or extension is None,
        "load": study.load.wrench is not None,
        "simulation.fidelity": not study.simulation.lateral_shapes,
    }
    for key, bad in wrong.items():
        if bad:
            raise InputError(
                "has no linear model that stays what it is along the motion",
                file=study.path,
                key=key,
                allowed="a beam that bends in its plane, of a length that stays, without gravity and loads",
            )
    law = motion.rotation
    return law, float(law.time[-1] if isinstance(law, CsvLaw) else law.duration)
