"""Any law of the platform's coordinates as a table of poses that a study file can hold, Eqs. (T22.4)-(T22.5)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple, TypeVar, cast

import numpy as np

from flexapod.analysis.results.arguments import FileLike
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.common.files import path_of, write_text
from flexapod.common.tables.csv_tables import table_text
from flexapod.kinematics import Law
from flexapod.kinematics.laws import spline, spline_law
from flexapod.model import AXES, ActuatorStudy, CsvLaw, CsvMotion, Motion, Study, load
from flexapod.model.motion import Axis
from flexapod.model.stored_tables import stored_tables

FEWEST, MOST = 100, 3200  # rows between first and last knot
ENOUGH = 1e-5  # of the largest acceleration of each kind, by which that of the table may be off in the mean
JUMPS = 1e-2  # mean error of accelerations above which the law's rate jumps
NEAREST = (1e-3, 2e-4, 1e-5)  # s: rows beside a knot where the law's derivatives jump, the fewer first
GROWTH = 1.6  # of the distances of rows from there on: below the 2.6 up to which splines of graded rows stay near


class CommandTable(NamedTuple):
    """A motion as a table; `place`, `acceleration`: how much it is off, at most and in the mean, over the largest."""

    motion: CsvMotion
    place: float
    acceleration: float

    @property
    def error(self) -> tuple[bool, float]:
        """Sort key of tables by their error: in accelerations, or in places for laws whose rate jumps."""
        jumps = self.acceleration > JUMPS
        return jumps, self.place if jumps else self.acceleration


def tabulate_law(
    law: Callable[[Array], Law],
    knots: Array,
    like: Motion,
    axes: Mask,
    length: float,
    *,
    hold: float = 0.0,
    rows: Array | None = None,
) -> CommandTable:
    """The table of a law: rows are doubled until the accelerations of the spline through them are those of the law.

    Parameters
    ----------
    law : callable
        Of instants (T,): coordinates (T, 6) with rates and accelerations.
    knots : ndarray, shape (n,)
        Instants from 0 on between which it is smooth [s].
    like : Motion
        Whose pivot it has.
    axes : ndarray of bool, shape (6,)
        Coordinates that are commanded; the columns of others are zero.
    length : float
        At which turns count [m].
    hold : float
        Rest after the last knot [s].
    rows : ndarray, optional
        Instants of the rows, where they are chosen.
    """
    best: CommandTable | None = None
    count = FEWEST
    while rows is not None or count <= MOST:
        for time in (rows,) if rows is not None else _choices(knots, count):
            found = _through(law, time, like, axes, length, hold)
            best = found if best is None or found.error < best.error else best
            if best.acceleration <= ENOUGH:
                break
        if rows is not None or best is None or best.acceleration <= ENOUGH:
            break
        count *= 2
    if best is None:
        raise InputError("has no time in which to move", key="motion")
    return best


def _through(
    law: Callable[[Array], Law], time: Array, like: Motion, axes: Mask, length: float, hold: float
) -> CommandTable:
    """The table with these rows, a turn counted at a `length` [m]."""
    pose = np.where(axes, law(time).position, 0.0)
    between = (time[:-1, None] + np.diff(time)[:, None] * np.array([0.25, 0.5, 0.75])).ravel()
    exact, ours = law(between), spline_law(between, spline(time, pose), first=0.0, last=float(time[-1]))
    share = np.repeat(np.diff(time), 3) / (3 * time[-1])
    count = np.where(axes, np.repeat([1.0, length], 3), 0.0)
    wrong, change, bent, most = (
        np.linalg.norm(count * x, axis=1)
        for x in (ours.position - exact.position, exact.position, ours.acceleration - exact.acceleration,
                  exact.acceleration)
    )  # fmt: skip
    least = max(change.max(), np.finfo(float).tiny)
    off = wrong.max() / least, (share * bent).sum() / max(most.max(), least / time[-1] ** 2)
    motion = CsvMotion(time=time, pose=pose, hold=hold, pivot=like.pivot, independent=axis_names(axes))
    return CommandTable(motion, float(off[0]), float(off[1]))


def axis_names(axes: Mask) -> tuple[Axis, ...] | None:
    """Names of the coordinates (6,) that are commanded; None of all."""
    return None if axes.all() else tuple(axis for axis, asked in zip(AXES, axes, strict=True) if asked)


def _even(knots: Array, count: int) -> Array:
    """Rows evenly between knots, those at the knots included."""
    spans = np.diff(knots)
    each = np.maximum(2, np.ceil(count * spans / spans.sum()).astype(int))
    parts = [first + span * np.arange(n) / n for first, span, n in zip(knots, spans, each, strict=False)]
    return np.append(np.concatenate(parts), knots[-1])


def _choices(knots: Array, count: int) -> Iterator[Array]:
    """Rows that may do, the fewest first."""
    yield _even(knots, count)
    yield from (_graded(knots, count, nearest) for nearest in NEAREST)


def _graded(knots: Array, count: int, nearest: float) -> Array:
    """Rows evenly, and more towards each knot."""
    even = _even(knots, count)
    far = float(np.diff(even).max())
    near = np.cumsum(nearest * GROWTH ** np.arange(np.ceil(np.log(max(far / nearest, 1.0)) / np.log(GROWTH))))
    more = np.concatenate([np.add.outer(knots, near).ravel(), np.subtract.outer(knots, near).ravel()])
    reach = near[-1] if near.size else 0.0
    apart = np.abs(even[:, None] - knots).min(axis=1)
    kept = even[(apart == 0) | (apart > reach)]
    found = np.unique(np.concatenate([kept, more[(more > knots[0]) & (more < knots[-1])]]))
    return found[np.append(True, np.diff(found) > 0.5 * nearest)]


TABLES = re.compile(r"""["']([^"'\n]+\.csv)["']""")  # names of tables in a study file
_WRITTEN = ("motion.file", "motion.rotation.file", "load.torque.file")  # keys of tables that are written with a study
S = TypeVar("S", bound=Study | ActuatorStudy)


def check_out(study: Study | ActuatorStudy, path: FileLike) -> Path:
    """Check the path of a study to be written; refuse one that is no study file, or the one that is read."""
    place = path_of(path, "out")
    if place.suffix != ".toml":
        raise InputError("is no name of a study file", key="out", value=str(path), allowed="NAME.toml")
    if place.is_dir():
        raise InputError("is a folder", key="out", value=str(path), allowed="NAME.toml")
    own, table = None if study.path is None else Path(study.path).resolve(), place.with_suffix(".csv").name
    if own is not None and place.resolve() == own:
        raise InputError("is the file of the study itself", key="out", value=str(path), next_step="Choose another name")
    if own is not None and place.resolve().parent == own.parent and table in study.source_text:
        words = f"would replace {table}, a table that the study names"
        raise InputError(words, key="out", value=str(path), next_step="Choose another name")
    if others := [key for key, kept in stored_tables(study).items() if not kept.name and key not in _WRITTEN]:
        words = "cannot be written: a table of the study was given in Python, and no file holds it"
        raise InputError(words, key=others[0], next_step="Write that table into a file, and name it in the study")
    if own is not None and isinstance(study, Study):
        made = {getattr(study.motion, "file", None)}  # the motion's own is written
        for name in sorted(set(TABLES.findall(study.source_text)) - made):
            if not (place.parent / name).is_file():
                words = f"lies where {name} is not, a table that the study names"
                raise InputError(words, key="out", value=str(path), allowed=f"a file in {own.parent}")
    return place


def save_study(study: S, path: FileLike) -> S:
    """Write the study as a file, with the table of its commands as another; return the study that it holds.

    Parameters
    ----------
    study : Study or ActuatorStudy
        Its motion, rotation or torque is a table.
    path : path
        ``NAME.toml``; the table is ``NAME.csv``. In the folder of the study whose other tables it names.
    """
    place = check_out(study, path)
    beside = place.with_suffix(".csv")
    written, key = _name_table(study, beside.name)
    write_text(beside, table_text(stored_tables(written)[key].content))
    said = "".join(f"# {line}\n" for line in study.notes)
    write_text(place, said + written.source_text)
    found = load(place)
    return found.replace(notes=study.notes)  # type: ignore[return-value]


def _name_table(study: S, name: str) -> tuple[S, str]:
    """The study with the name of the table of its commands, and the key of that table."""
    if isinstance(study, Study):
        return study.replace(motion=cast("CsvMotion", study.motion).replace(file=name)), "motion.file"
    table, key = ("motion", "rotation") if study.motion.rotation else ("load", "torque")
    part = getattr(study, table)
    changed = part.replace(**{key: cast("CsvLaw", getattr(part, key)).replace(file=name)})
    return study.replace(**{table: changed}), f"{table}.{key}.file"
