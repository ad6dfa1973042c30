"""Points of a sweep: the study of each, which are equal, which are refused, and what varies."""

from __future__ import annotations

import hashlib
import pickle
import tomllib
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from flexapod.analysis.checks.resource_limits import check_outputs, check_room, result_bytes
from flexapod.analysis.results.causes import cause_names
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, Malformed
from flexapod.common.tables.base import SHORT
from flexapod.common.tables.key_paths import Step, copy_data, key_text, leaves, similar_key
from flexapod.common.tables.named_files import NamedFiles
from flexapod.design.sweeps.plan import SweepPlan, Tolerance
from flexapod.design.sweeps.reading import (
    dimension_of,
    hypercube_values,
    number,
    spaced_values,
    standard_draws,
)
from flexapod.model import ActuatorStudy, Study
from flexapod.model.file.key_paths import leg_count, put, value_at
from flexapod.model.file.variants import read_with_dimensions, study_from_tables
from flexapod.model.stored_tables import files_of

MEMORY = 64 << 20  # of studies that were read and wait to be computed; others are read again
POINT = 200  # byte kept of each point while points are read: its hash, its number, their places in lists
Setting = tuple[str, str, int, tuple[int, ...], tuple[object, ...]]


@dataclass(frozen=True, kw_only=True)
class _Leaf:
    """One number that scatters: its path and the size of its scatter (SI, or a share of the nominal)."""

    key: tuple[Step, ...]
    size: float
    relative: bool

    def place(self, data: Any, value: float) -> None:
        """Set the number in tables in which nothing on its path is given in short."""
        for step in self.key[:-1]:
            data = data[step - 1] if isinstance(step, int) else data[step]
        last = self.key[-1]
        data[last - 1 if isinstance(last, int) else last] = value


class _Cell(NamedTuple):
    """A point of the grid before anything scatters: its number, its tables, by tolerance its numbers [SI]."""

    at: tuple[int, ...]
    tables: dict[str, Any]
    nominal: tuple[Array, ...]


@dataclass(frozen=True, kw_only=True)
class Resolved:
    """All points, read.

    ``first`` (N,): the first point with an equal study; ``refused``: message by point whose study cannot be;
    ``scattered``: by tolerance, the values (N, numbers) [SI]; ``hash``: of all studies; ``settings``: one point for
    every kind of kernel; ``instants``: numbers of stored instants and time between them that occur; ``causes``: of
    deviations, that occur together; ``largest``: the point whose results are the largest.
    """

    first: Array
    refused: Mapping[int, str]
    scattered: tuple[Array, ...]
    hash: str
    settings: Mapping[Setting, int]
    instants: frozenset[tuple[int, float]]
    causes: frozenset[tuple[str, ...]]
    largest: int


@dataclass
class _Found:
    first: list[int] = field(default_factory=list)
    refused: dict[int, str] = field(default_factory=dict)
    known: dict[bytes, int] = field(default_factory=dict)
    settings: dict[Setting, int] = field(default_factory=dict)
    instants: set[tuple[int, float]] = field(default_factory=set)
    causes: set[tuple[str, ...]] = field(default_factory=set)
    largest: tuple[float, int] = (0.0, 0)


class Points:
    """Points of a sweep of a study, by number from 0.

    Parameters
    ----------
    study : Study or ActuatorStudy
    plan : SweepPlan

    Raises
    ------
    InputError
        A key that no study file has, or values that are not of its kind.
    """

    def __init__(self, study: Study | ActuatorStudy, plan: SweepPlan) -> None:
        self.nominal: Study | ActuatorStudy = study
        self.plan: SweepPlan = plan
        self.data: dict[str, Any] = tomllib.loads(study.source_text)
        self.files: NamedFiles = files_of(study)
        self.dimensions: dict[str, str] = {}
        try:
            probe = self._probe()
            self.columns: tuple[Any, ...] = tuple(self._columns())
            self.leaves: tuple[tuple[_Leaf, ...], ...] = (
                tuple(self._leaves(probe, t) for t in plan.draws.tolerances) if plan.draws else ()
            )
            self._check_room()
            cube = plan.hypercube
            self.cube: Array | None = None if cube is None else hypercube_values(cube, self.dimensions)
        except InputError as error:
            raise error.with_location(file=plan.file) from None
        self.draws: tuple[Array, ...] = standard_draws(plan.draws, tuple(map(len, self.leaves))) if plan.draws else ()
        self._packed: dict[int, bytes] = {}
        self._room = MEMORY
        self._cell: _Cell | None = None

    def _check_room(self) -> None:
        """Refuse more random numbers than the memory holds: draws, samples, and what is recorded of each point."""
        cube, draws, leaves = self.plan.hypercube, self.plan.draws, sum(map(len, self.leaves))
        samples = 2 * cube.count * len(cube.ranges) if cube else 0  # between 0 and 1, and between their limits
        drawn = leaves * draws.count if draws else 0
        check_room(
            8.0 * (samples + drawn + leaves * len(self)) + POINT * len(self),
            None,
            key="random.count" if draws else "latin_hypercube.count" if cube else "vary",
            next_step="Give fewer points; sweeps with other seeds, each with a store of its own, add more",
        )

    def __len__(self) -> int:
        return self.plan.size

    def study(self, point: int) -> Study | ActuatorStudy:
        """The study of a point.

        Raises
        ------
        InputError
            It cannot be: values that are not physical, or not allowed together.
        """
        return study_from_tables(self._tables(point)[0], self.files)

    def pickled_study(self, point: int) -> bytes:
        """The study of a point, pickled; asked for once, it is forgotten."""
        found = self._packed.pop(point, None)
        return pickle.dumps(self.study(point), protocol=pickle.HIGHEST_PROTOCOL) if found is None else found

    def forget_others(self, points: Collection[int]) -> None:
        """Drop what was read of all points but these."""
        wanted = set(points)
        self._packed = {point: packed for point, packed in self._packed.items() if point in wanted}

    def resolve(self, progress: Callable[[float], None] | None = None) -> Resolved:
        """Read all points.

        Raises
        ------
        InputError
            A key or value that is wrong whatever the others, or not one point whose study can be.
        """
        found, scattered = _Found(), [np.full((len(self), len(group)), np.nan) for group in self.leaves]
        last: InputError | None = None
        for point in range(len(self)):
            if progress is not None and point % 100 == 0:
                progress(point / len(self))
            try:
                tables, values = self._tables(point)
                for array, row in zip(scattered, values, strict=True):
                    array[point] = row
                self._note(found, point, study_from_tables(tables, self.files))
            except Malformed as error:
                raise error.with_location(file=self.plan.file) from None
            except InputError as error:
                last = error
                found.first.append(point)
                found.refused[point] = str(error)
        if last is not None and len(found.refused) == len(self):
            raise last.with_location(file=self.plan.file)
        digest = hashlib.sha256(b"".join(found.known))
        digest.update(np.array(found.first).tobytes())
        return Resolved(
            first=np.array(found.first),
            refused=found.refused,
            scattered=tuple(scattered),
            hash=digest.hexdigest()[:16],
            settings=found.settings,
            instants=frozenset(found.instants),
            causes=frozenset(found.causes),
            largest=found.largest[1],
        )

    def _note(self, found: _Found, point: int, study: Study | ActuatorStudy) -> None:
        check_outputs(study)  # before anything is made as long as its record
        found.first.append(found.known.setdefault(content_hash(study), point))
        if found.first[-1] == point and self._room > 0:
            self._packed[point] = pickle.dumps(study, protocol=pickle.HIGHEST_PROTOCOL)
            self._room -= len(self._packed[point])
        s = study.simulation
        axial = tuple(s.axial_shapes(leg.axial_modes) for leg in study.robot.legs) if isinstance(study, Study) else ()
        found.settings.setdefault((s.fidelity, s.lateral_basis, s.lateral_shapes, axial, _shape_numbers(study)), point)
        found.largest = max(found.largest, (result_bytes(study), point))
        found.instants.add((s.outputs(study.duration), s.stored_step))
        if isinstance(study, Study):
            found.causes.add(cause_names(study.robot))

    def _probe(self) -> dict[str, Any]:
        """Tables with the first value of every key; reading them gives the dimensions."""
        read_with_dimensions(self.data, self.files, self.dimensions)
        probe = copy_data(self.data)
        firsts: list[tuple[tuple[Step, ...], object]] = []
        for block in self.plan.blocks:
            values = [block.spaced.start] if block.spaced else [column[0] for column in block.values]
            firsts += zip(block.keys, values, strict=True)
        cube = self.plan.hypercube
        firsts += [(entry.key, entry.low) for entry in cube.ranges] if cube else []
        for key, value in firsts:
            put(probe, key, value)
        try:
            read_with_dimensions(probe, self.files, self.dimensions)
        except Malformed as error:
            if error.what == "unknown key" and error.key:
                error.next_step = self._hint(error.key) or error.next_step
            raise
        except InputError:  # not physical: other points may be, and what stands behind it has not been read
            self._read_one_by_one(firsts)
        return probe

    def _read_one_by_one(self, firsts: list[tuple[tuple[Step, ...], object]]) -> None:
        """Read the first values again, without those that are not physical."""
        good = copy_data(self.data)
        for key, value in firsts:
            trial = copy_data(good)
            with suppress(InputError):
                put(trial, key, value)
                read_with_dimensions(trial, self.files, self.dimensions)
                good = trial

    def _hint(self, key: str) -> str | None:
        varied = [k for block in self.plan.blocks for k in block.keys]
        varied += [entry.key for entry in self.plan.hypercube.ranges] if self.plan.hypercube else []
        for candidate in varied:
            if key_text(candidate).startswith(key.split("[")[0]):
                return similar_key(self.data, candidate)
        return None

    def _columns(self) -> Any:
        """Columns of values by block, one for every key."""
        for block in self.plan.blocks:
            if block.spaced:
                yield (spaced_values(block.spaced, block.keys[0], self.dimensions),)
            else:
                yield block.values

    def _leaves(self, probe: dict[str, Any], tolerance: Tolerance) -> tuple[_Leaf, ...]:
        key = tolerance.key
        each = [key]
        if key[0] == "leg" and len(key) > 1 and isinstance(key[1], str):
            each = [("leg", number, *key[1:]) for number in range(1, leg_count(self.data) + 1)]
        tables = copy_data(self.data)
        try:
            found = [leaf for path in each for leaf, _ in leaves(value_at(tables, path), path)]
            read_with_dimensions(tables, self.files, self.dimensions)  # what was spelled out has new paths
        except InputError:  # it has a value only where another entry of the sweep gives it one
            found = [leaf for path in each for leaf, _ in leaves(value_at(probe, path), path)]
        dimensions = {dimension_of(leaf, self.dimensions) for leaf in found}
        if None in dimensions:
            raise InputError(
                "is not a number that could scatter", key=key_text(key), next_step="Vary it with [[vary]] and values"
            )
        if len(dimensions) > 1:
            raise InputError(
                f"holds numbers of several kinds ({', '.join(sorted(map(str, dimensions)))})",
                key=key_text(key),
                next_step=f"Give a tolerance to each, such as {key_text(found[0])}",
            )
        size = tolerance.size if tolerance.relative else number(tolerance.size, found[0], self.dimensions)
        if not isinstance(size, float | int) or size < 0:
            raise InputError("is out of range", key=f"{tolerance.law} of {key_text(key)}", value=size, allowed="from 0")
        return tuple(_Leaf(key=leaf, size=float(size), relative=tolerance.relative) for leaf in found)

    def _tables(self, point: int) -> tuple[dict[str, Any], list[list[float]]]:
        """Tables of a point, and the scattered values by tolerance."""
        at = tuple(map(int, np.unravel_index(point, self.plan.shape)))
        cell = self._grid(at[:-1] if self.plan.draws else at)
        data, values = copy_data(cell.tables), []
        for group, draws, nominal in zip(self.leaves, self.draws, cell.nominal, strict=True):
            first = group[0]  # size and form are those of the tolerance
            row = (nominal + first.size * draws[at[-1]] * (nominal if first.relative else 1.0)).tolist()
            for leaf, value in zip(group, row, strict=True):
                leaf.place(data, value)
            values.append(row)
        return data, values

    def _grid(self, at: tuple[int, ...]) -> _Cell:
        """Point of the grid that its draws share; the last one is cached, since draws vary fastest."""
        if self._cell is None or self._cell.at != at:
            data, left = copy_data(self.data), list(at)
            for block, columns in zip(self.plan.blocks, self.columns, strict=True):
                row = left.pop(0)
                for key, column in zip(block.keys, columns, strict=True):
                    put(data, key, column[row])
            if self.plan.hypercube is not None and self.cube is not None:
                for entry, value in zip(self.plan.hypercube.ranges, self.cube[left.pop(0)].tolist(), strict=True):
                    put(data, entry.key, value)
            nominal = tuple(
                np.array([number(value_at(data, leaf.key), leaf.key, self.dimensions) for leaf in group])
                for group in self.leaves
            )
            self._cell = _Cell(at, data, nominal)
        return self._cell


def _shape_numbers(study: Study | ActuatorStudy) -> tuple[object, ...]:
    """Numbers of a study that its shapes, and with them its kernel, may depend on."""
    basis = study.simulation.lateral_basis
    if isinstance(study, Study):
        robot = study.robot
        circles = robot.base_joints.tobytes(), robot.platform_joints.tobytes()
        mouths = tuple(leg.cylinder.mouth for leg in robot.legs)
        return (robot.legs[0].piston, *circles, robot.home_height, mouths) if basis == "solid" else ()
    beam = study.actuator
    if basis == "tip-load":
        return (beam.tip_inertia > 0 or beam.space,)
    by_basis = {"tip-mass": (beam.tip_mass, beam.tip_inertia, beam.rhoA), "solid": (beam.section,)}
    return (*by_basis[basis], beam.free_length) if basis in by_basis else ()


def content_hash(study: Study | ActuatorStudy) -> bytes:
    """Hash of what a study means, whatever its text and file."""
    content = study.model_dump_json(exclude={"source_text", "path", "notes"}, context=SHORT)
    return hashlib.sha256(content.encode()).digest()[:16]
