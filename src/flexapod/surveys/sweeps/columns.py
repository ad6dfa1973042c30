"""What a store knows from the start: what varies, and room for what is kept."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from flexapod import version
from flexapod.errors import InputError
from flexapod.model import ActuatorStudy
from flexapod.study.after.leg_results import leg_labels
from flexapod.study.attributes import attributes
from flexapod.study.names import fixed_labels
from flexapod.surveys.sweeps.identity import sources
from flexapod.surveys.sweeps.kept import Kept
from flexapod.surveys.sweeps.keys import Step, key_text
from flexapod.surveys.sweeps.points import Points, Resolved
from flexapod.surveys.sweeps.reading import dimension_of
from flexapod.surveys.sweeps.samples import number
from flexapod.surveys.sweeps.store import FORMAT, Column, Values
from flexapod.units import DIMENSIONS

DRAWN = "_drawn"  # what a tolerance drew about values that vary themselves, and own the name


def header(points: Points, kept: Kept, resolved: Resolved, varied: Mapping[str, Column]) -> dict[str, Any]:
    """Attributes of the store: what is in it, told by hashes, and how its points are laid out."""
    study = attributes(points.nominal)
    return {
        "title": f"flexapod: sweep of a {'single actuator' if isinstance(points.nominal, ActuatorStudy) else 'robot'}",
        "flexapod_sweep_format": FORMAT,
        "flexapod_version": version.__version__,
        "flexapod_sources": sources(),
        "study": study["study"],
        "study_file": study["study_file"],
        "study_hash": study["study_hash"],
        "sweep": points.plan.text,
        "sweep_file": points.plan.file or "",
        "sweep_hash": points.plan.hash,
        "points_hash": resolved.hash,
        "axes": json.dumps(axes(points)),
        "coordinates": " ".join(varied),  # for other readers: CF
        "varied": " ".join(varied),
        "kept": " ".join(kept.variables),
        "complete": " ".join(name for name in kept.variables if name not in kept.absent),
    }


def axes(points: Points) -> list[dict[str, Any]]:
    """What the points are the product of, the last fastest: name, number of values, keys that vary with it."""
    plan = points.plan
    found: list[dict[str, Any]] = [
        {"name": key_text(block.keys[0]), "count": block.count, "keys": [key_text(key) for key in block.keys]}
        for block in plan.blocks
    ]
    if plan.hypercube:
        keys = [key_text(entry.key) for entry in plan.hypercube.ranges]
        found.append({"name": "sample", "count": plan.hypercube.count, "keys": keys})
    if plan.draws:
        found.append({"name": "draw", "count": plan.draws.count, "keys": []})
    return found


def columns(points: Points, kept: Kept, resolved: Resolved) -> tuple[dict[str, Column], dict[str, Column]]:
    """Arrays of what varies, and of what is kept with the labels of its dimensions."""
    given = _varied(points)
    drawn = _scattered(points, resolved)
    varied = given | {f"{name}{DRAWN}" if name in given else name: column for name, column in drawn.items()}
    made: dict[str, Column] = {}
    for name, (dims, units, long_name) in kept.variables.items():
        shape = (len(points), *kept.shape(name))
        comment = {"comment": f"NaN at a computed point: {kept.absent[name]}"} if name in kept.absent else {}
        made[name] = Column(("point", *dims), shape, {"units": units, "long_name": long_name, **comment})
    used = {
        dim: size
        for column in (*varied.values(), *made.values())
        for dim, size in zip(column.dims, column.shape, strict=True)
    }
    robot = getattr(points.nominal, "robot", None)
    own = {} if robot is None else leg_labels(robot)
    for dim, (labels, words) in ({dim: (own[dim], dim) for dim in own if dim in used} | fixed_labels(used)).items():
        values = np.asarray(own.get(dim, labels))
        made[dim] = Column((dim,), values.shape, {"long_name": words}, values)
    if "time" in used:
        made["time"] = Column(("time",), kept.times.shape, {"units": "s", "long_name": "time"}, kept.times)
    return varied, made


def _varied(points: Points) -> dict[str, Column]:
    """Values by key of blocks and hypercube."""
    at, plan = np.unravel_index(np.arange(len(points)), points.plan.shape), points.plan
    found = {}
    for position, (block, values) in enumerate(zip(plan.blocks, points.columns, strict=True)):
        for key, column in zip(block.keys, values, strict=True):
            found[key_text(key)] = _column(key, column, at[position], points)
    if plan.hypercube is not None and points.cube is not None:
        for entry, column in zip(plan.hypercube.ranges, points.cube.T, strict=True):
            found[key_text(entry.key)] = _column(entry.key, column.tolist(), at[len(plan.blocks)], points)
    return found


def _column(key: tuple[Step, ...], values: Any, at: Values, points: Points) -> Column:
    plain = np.asarray(_plain(values, key, points))
    attributes = {"long_name": key_text(key)}
    items = [key, *((*key, number) for number in range(1, 1 + plain.shape[1] if plain.ndim > 1 else 1))]
    found = {dimension_of(item, points.dimensions) for item in items} - {None}
    if len(found) == 1 and plain.dtype.kind != "U":  # forces and moments in one list have no unit in common
        attributes["units"] = DIMENSIONS[str(found.pop())].unit or "1"
    dims = _dims(key, plain.shape[1:], each=key[-1] == "joints")
    return Column(("point", *dims), (len(at), *plain.shape[1:]), attributes, plain[at])


def _plain(values: Any, key: tuple[Step, ...], points: Points) -> list[Any]:
    """Values as numbers in SI where all are numbers of one shape, else as text."""

    def si(value: object, key: tuple[Step, ...]) -> Any:
        if isinstance(value, list):
            return [si(item, (*key, at)) for at, item in enumerate(value, start=1)]
        return number(value, key, points.dimensions)

    try:
        found = [si(value, key) for value in values]
        np.array(found, dtype=float)
    except (ValueError, InputError):
        return [str(value) for value in values]
    return found


def _scattered(points: Points, resolved: Resolved) -> dict[str, Column]:
    """Values by key of tolerances: one of every point, or of every point and leg, joint or axis."""
    found = {}
    draws = points.plan.draws
    for tolerance, group, values in zip(
        draws.tolerances if draws else (), points.leaves, resolved.scattered, strict=True
    ):
        key = tolerance.key
        numbers = [[step for step in leaf.key if isinstance(step, int)] for leaf in group]
        given = sum(isinstance(step, int) for step in key)
        shape = tuple(len({n[i] for n in numbers}) for i in range(given, len(numbers[0])))
        dimension = dimension_of(group[0].key, points.dimensions) or "number"
        attributes = {"long_name": key_text(key), "units": DIMENSIONS[dimension].unit or "1"}
        whole = (len(points), *shape)
        dims = _dims(key, shape, each=_of_each_leg(key))
        found[key_text(key)] = Column(("point", *dims), whole, attributes, values.reshape(whole))
    return found


def _of_each_leg(key: tuple[Step, ...]) -> bool:
    """Whether what scatters under a key has one value or row of its own for each leg."""
    return key[-1] == "joints" or (key[0] == "leg" and not isinstance(key[1], int))


def _dims(key: tuple[Step, ...], shape: tuple[int, ...], *, each: bool) -> tuple[str, ...]:
    """Names of the dimensions of what stands under a key: legs where there is one of `each`, axes, or own names."""
    dims: list[str] = []
    for position, size in enumerate(shape):
        usual = "leg" if each and position == 0 else "axis" if size == 3 else ""
        dims.append(usual if usual and usual not in dims else f"{key_text(key)} {position + 1}")
    return tuple(dims)
