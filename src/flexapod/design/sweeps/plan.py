"""A sweep file: which keys vary and how, and what is kept of every point."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexapod.common.errors import InputError
from flexapod.common.files import LARGEST_TEXT, check_name, read_text
from flexapod.common.tables.key_paths import Step, key_text, parse_key
from flexapod.common.tables.section import Section
from flexapod.common.tables.toml import parse_toml, refuse_excess
from flexapod.model.file.key_paths import overlap

_PER_CENT = re.compile(r"\s*(\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+)\s*%\s*")
MOST_POINTS = 10_000_000  # more is a mistake in a grid: their hashes alone would fill the memory


@dataclass(frozen=True, kw_only=True)
class Spaced:
    """`count` values from `start` to `stop`, as written; evenly spaced, or their logarithms."""

    start: object
    stop: object
    count: int
    logarithmic: bool


@dataclass(frozen=True, kw_only=True)
class Block:
    """Keys that change together: a list of values for each, all of one length; or one key with spaced values."""

    keys: tuple[tuple[Step, ...], ...]
    values: tuple[tuple[object, ...], ...] = ()
    spaced: Spaced | None = None

    @property
    def count(self) -> int:
        """Number of values of each key."""
        return self.spaced.count if self.spaced else len(self.values[0])


@dataclass(frozen=True, kw_only=True)
class KeyRange:
    """A key between two values, as written."""

    key: tuple[Step, ...]
    low: object
    high: object


@dataclass(frozen=True, kw_only=True)
class Hypercube:
    """A Latin hypercube of `count` samples."""

    count: int
    seed: int
    ranges: tuple[KeyRange, ...]


@dataclass(frozen=True, kw_only=True)
class Tolerance:
    """Scatter of every number under a key: `law` normal (`size` is the standard deviation) or uniform (half width).

    `size` as written; of `relative` scatter, a share of the nominal value.
    """

    key: tuple[Step, ...]
    law: str
    size: object
    relative: bool


@dataclass(frozen=True, kw_only=True)
class Draws:
    """`count` random samples."""

    count: int
    seed: int
    tolerances: tuple[Tolerance, ...]


@dataclass(frozen=True, kw_only=True)
class Keep:
    """Scalars by name (empty: the default ones), records by name, time between their instants as written."""

    scalars: tuple[str, ...] = ()
    records: tuple[str, ...] = ()
    record_step: float | None = None


@dataclass(frozen=True, kw_only=True)
class SweepPlan:
    """A sweep: the product of `blocks`, of the `hypercube` and of the `draws`; the last varies fastest."""

    blocks: tuple[Block, ...]
    hypercube: Hypercube | None
    draws: Draws | None
    keep: Keep
    text: str
    file: str | None

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of every block, of samples of the hypercube, of draws."""
        more = [part.count for part in (self.hypercube, self.draws) if part is not None]
        return (*(block.count for block in self.blocks), *more)

    @property
    def size(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    @property
    def hash(self) -> str:
        """Hash of the content, whatever comments and spaces the file has."""
        content = repr((self.blocks, self.hypercube, self.draws, self.keep))
        return hashlib.sha256(content.encode()).hexdigest()[:16]


def read_plan(sweep: str | Path | Mapping[str, Any]) -> SweepPlan:
    """A sweep from its file, or from a mapping with the same content.

    Raises
    ------
    InputError
        With file, key, value, what is allowed and the next step.
    """
    if isinstance(sweep, Mapping):
        plain = _plain(sweep)
        refuse_excess(plain, None)
        return _plan(Section(plain, "", None, Path()), json.dumps(plain, indent=1, default=str))
    if not isinstance(sweep, str | Path):
        raise InputError(
            "is not a sweep", key="sweep", value=type(sweep).__name__, allowed="a sweep file or a dictionary like it"
        )
    file = Path(sweep)
    check_name(file)
    try:
        text = read_text(file, LARGEST_TEXT)
    except OSError as error:
        words = f"cannot be read: {error.strerror}"
        raise InputError(words, file=file, next_step="See docs/sweep.md for an example") from None
    return _plan(Section(parse_toml(text, str(file)), "", str(file), file.parent), text)


def _plain(value: Any) -> Any:
    """Numbers and arrays of NumPy as those of Python, all the way down."""
    if isinstance(value, Mapping):
        return {name: _plain(inner) for name, inner in value.items()}
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    return [_plain(inner) for inner in value] if isinstance(value, list | tuple) else value


def _plan(top: Section, text: str) -> SweepPlan:
    top.check_keys("vary", "latin_hypercube", "random", "keep")
    try:
        plan = SweepPlan(
            blocks=tuple(_block(top.child(entry, f"vary[{i}]")) for i, entry in enumerate(_tables(top, "vary"), 1)),
            hypercube=_hypercube(top.section("latin_hypercube")),
            draws=_draws(top.section("random")),
            keep=_keep(top.section("keep")),
            text=text,
            file=top.file,
        )
    except InputError as error:
        raise error.with_location(file=top.file) from None
    if not plan.shape:
        raise InputError(
            "varies nothing", file=top.file or "sweep", allowed="[[vary]], [latin_hypercube], [random], or several"
        )
    if plan.size > MOST_POINTS:
        raise InputError(f"has {plan.size:,} points", file=top.file or "sweep", allowed=f"at most {MOST_POINTS:,}")
    _refuse_overlaps(plan)
    return plan


def _tables(section: Section, name: str) -> list[object]:
    value = section.data.get(name, [])
    if not isinstance(value, list):
        raise section.error("is not a list of tables", name, allowed=f"[[{section.key(name)}]]")
    return value


def _refuse_overlaps(plan: SweepPlan) -> None:
    """A value may vary in one place, and be given a tolerance in one more."""
    varied = [key for block in plan.blocks for key in block.keys]
    varied += [entry.key for entry in plan.hypercube.ranges] if plan.hypercube else []
    scattered = [entry.key for entry in plan.draws.tolerances] if plan.draws else []
    for key in (*varied, *scattered):
        if key == ("leg",):  # its coordinate would be named like the dimension
            words = "[vary.together] with a list of values for each"
            raise InputError("is a whole table", file=plan.file, key="leg", allowed=f"keys in it; {words}")
    for one, other in itertools.chain(itertools.combinations(varied, 2), itertools.combinations(scattered, 2)):
        if one == other:
            raise InputError("varies in two places", file=plan.file, key=key_text(one), allowed="one of them")
        if overlap(one, other):
            raise InputError(
                f"varies, and so does {key_text(other)}: one would replace the other",
                file=plan.file,
                key=key_text(one),
                allowed="one of them, or keys that have no value in common",
            )


def _block(section: Section) -> Block:
    if "together" in section:
        section.check_keys("together")
        return _together(section.child(section.data["together"], "together"))
    section.require_keys("key")
    key = parse_key(section.data["key"], what=section.key("key"))
    if "values" in section:
        section.check_keys("key", "values")
        return Block(keys=(key,), values=(_list(section, "values"),))
    section.check_keys("key", "values", "start", "stop", "count", "spacing")
    section.require_keys("start", "stop", "count")
    spacing = section.text("spacing", ("linear", "logarithmic")) or "linear"
    spaced = Spaced(
        start=section.data["start"],
        stop=section.data["stop"],
        count=_whole(section, "count", 2),
        logarithmic=spacing == "logarithmic",
    )
    return Block(keys=(key,), spaced=spaced)


def _together(section: Section) -> Block:
    names = list(section.data)
    if not names:
        raise InputError("names no key", key=section.path, allowed="a list of values for every key")
    columns = tuple(_list(section, name) for name in names)
    for name, column in zip(names, columns, strict=True):
        if len(column) != len(columns[0]):
            raise InputError(
                f"has {len(column)} values", key=section.key(name), allowed=f"{len(columns[0])}, as {names[0]} has"
            )
    return Block(keys=tuple(parse_key(name, what=section.path) for name in names), values=columns)


def _list(section: Section, name: str) -> tuple[object, ...]:
    value = section.data[name]
    if not isinstance(value, list) or not value:
        raise section.error("is not a list of values", name, allowed='such as ["25 mm", "27 mm", "30 mm"]')
    return tuple(value)


def _whole(section: Section, name: str, least: int) -> int:
    value = section.integer(name) or 0
    if value < least:
        raise section.error("is out of range", name, allowed=f"at least {least}")
    return value


def _hypercube(section: Section | None) -> Hypercube | None:
    if section is None:
        return None
    section.check_keys("count", "seed", "ranges")
    section.require_keys("ranges", "count")
    inner, ranges = section.child(section.data["ranges"], "ranges"), []
    for name, value in inner.data.items():
        if not isinstance(value, list) or len(value) != 2:
            raise inner.error("is not a range", name, allowed='lowest and highest value, such as ["25 mm", "30 mm"]')
        ranges.append(KeyRange(key=parse_key(name, what=inner.path), low=value[0], high=value[1]))
    if not ranges:
        raise section.error("names no key", "ranges", allowed='such as { "payload.mass" = ["50 kg", "150 kg"] }')
    return Hypercube(count=_whole(section, "count", 1), seed=_whole(section, "seed", 0), ranges=tuple(ranges))


def _draws(section: Section | None) -> Draws | None:
    if section is None:
        return None
    section.check_keys("count", "seed", "tolerance")
    section.require_keys("tolerance", "count")
    entries = [section.child(entry, f"tolerance[{i}]") for i, entry in enumerate(_tables(section, "tolerance"), 1)]
    if not entries:
        raise section.error("names no key", "tolerance", allowed="[[random.tolerance]]")
    return Draws(
        count=_whole(section, "count", 1),
        seed=_whole(section, "seed", 0),
        tolerances=tuple(_tolerance(entry) for entry in entries),
    )


def _tolerance(section: Section) -> Tolerance:
    section.check_keys("key", "normal", "uniform")
    section.require_keys("key")
    laws = [law for law in ("normal", "uniform") if law in section]
    if len(laws) != 1:
        raise InputError(
            "has no law" if not laws else "has two laws",
            key=section.path,
            allowed='normal = standard deviation, or uniform = half width, such as "0.02 mm" or "1 %"',
        )
    value = section.data[laws[0]]
    share = _PER_CENT.fullmatch(value) if isinstance(value, str) else None
    return Tolerance(
        key=parse_key(section.data["key"], what=section.key("key")),
        law=laws[0],
        size=float(share[1]) / 100 if share else value,
        relative=share is not None,
    )


def _keep(section: Section | None) -> Keep:
    if section is None:
        return Keep()
    section.check_keys("scalars", "records", "record_step")
    names = {}
    for kind in ("scalars", "records"):
        value = section.data.get(kind, [])
        if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
            raise section.error("is not a list of names", kind)
        names[kind] = tuple(dict.fromkeys(value))
    step = section.number("record_step", "time")
    if step is not None and step <= 0:
        raise section.error("is out of range", "record_step", allowed="above 0")
    if step is not None and not names["records"]:
        raise section.error("has no effect without records", "record_step", next_step="Leave it out")
    return Keep(scalars=names["scalars"], records=names["records"], record_step=step)
