"""Record of a time integration: the stored quantities of each chunk, nothing else."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics.rotations import matrix

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.solve.time.problem import Chunk
    from flexapod.solve.time.recording import Recording

#: Called with the simulated time reached and the whole simulated time [s].
Progress = Callable[[float, float], None]
#: Called with what is being done, in words, and the share of the whole that is done (0 to 1).
Report = Callable[[str, float], None]
#: Called with the share of a part that is done (0 to 1).
Share = Callable[[float], None]


class Interrupted(KeyboardInterrupt):
    """The user stopped a simulation; `dataset` holds what was computed, marked as partial."""

    def __init__(self, dataset: Dataset) -> None:
        self.dataset = dataset
        super().__init__(f"stopped at t = {float(dataset.time[-1]):.6g} s")


@dataclass(frozen=True, kw_only=True)
class Record:
    """Quantities at T stored instants, axis 0 = time.

    ``q`` (T, legs, n) leg coordinates; ``rate`` (T, legs, n') rates of those that were asked for; ``turn`` (T, 3)
    angular velocity in platform axes; ``lam``, ``drive``, ``pose``, ``reaction``, ``energy``, ``sums``, ``closure``,
    ``friction``, ``control`` as in `solve.time.recording.Recording`.
    ``force_error``: estimate of the error of the legs' forces [N], where steps follow a tolerance.
    ``failure``: why the integration stopped early, in words, or None; ``interrupted``: by the user.
    """

    time: Array
    q: Array
    rate: Array
    turn: Array
    lam: Array
    drive: Array
    pose: Array
    reaction: Array
    energy: Array
    sums: Array
    closure: Array
    friction: Array
    control: Array
    smallest_step: float
    largest_error: float
    force_error: float | None
    wall_time: float
    failure: ComputationError | None
    interrupted: bool

    @cached_property
    def attitude(self) -> Array:
        """Attitude of the payload, (T, 3, 3)."""
        return matrix(self.pose[:, 3:])

    def part(self, which: slice) -> Record:
        """Record of some of the instants."""
        names = [field.name for field in fields(self) if isinstance(getattr(self, field.name), np.ndarray)]
        return replace(self, **{name: getattr(self, name)[which] for name in names})


_KEPT = ("time", "q", "lam", "drive", "pose", "reaction", "energy", "sums", "closure", "friction", "control")


def check_progress(progress: object) -> None:
    """Refuse a `progress` that cannot be called, before a run begins."""
    if progress is not None and not callable(progress):
        raise InputError("cannot be called", key="progress", value=progress, allowed="a function (time, duration)")


def collect(chunks: Iterable[Chunk], rates: Sequence[int], duration: float, progress: Progress | None) -> Record:
    """Run a time integration to its end, to its failure, or until the user interrupts it.

    ``rates``: coordinates of a leg whose rates are kept.

    Raises
    ------
    ComputationError, KeyboardInterrupt
        If nothing beyond the start had been computed.
    """
    parts: list[dict[str, Array]] = []
    steps, errors, begin = [np.inf], [0.0], time.perf_counter()
    failure, interrupted, of_force = None, False, None
    try:
        for chunk in chunks:
            parts.append(recorded_arrays(chunk.recording, rates))  # whole or not at all, whenever the user interrupts
            steps.append(chunk.step)
            errors.append(chunk.error)
            of_force = chunk.force_error
            if progress is not None:
                progress(float(chunk.recording.time[-1]), duration)
    except ComputationError as error:
        failure = error
    except KeyboardInterrupt:
        interrupted = True
    if len(parts) < 2 and (failure or interrupted):
        raise failure or KeyboardInterrupt
    return Record(
        **{name: np.concatenate([part[name] for part in parts]) for name in parts[0]},
        smallest_step=min(steps),
        largest_error=max(errors),
        force_error=of_force,
        wall_time=time.perf_counter() - begin,
        failure=failure,
        interrupted=interrupted,
    )


def recorded_arrays(r: Recording, of: Sequence[int]) -> dict[str, Array]:
    """Arrays of a recording that a `Record` holds, with the rates of some coordinates of the legs."""
    legs, n = r.q.shape[1:]
    rates = r.v[:, : legs * n].reshape(len(r.time), legs, n)
    parts = {name: getattr(r, name) for name in _KEPT}
    parts |= {"rate": rates[:, :, list(of)], "turn": r.v[:, legs * n + 3 : legs * n + 6]}
    return {name: np.array(array) for name, array in parts.items()}  # copies: views would keep the whole chunk


def result_or_interrupt(made: Callable[[], Dataset], record: Record) -> Dataset:
    """The result of a record; raised as `Interrupted` if the user stopped it, also while the result was made."""
    try:
        result = made()
    except KeyboardInterrupt:  # a second one ends it
        raise Interrupted(made()) from None
    if record.interrupted:
        raise Interrupted(result)
    return result
