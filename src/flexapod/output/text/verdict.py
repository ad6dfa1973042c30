"""Verdict on a requirement in words: for `check`, `budget`, `map`, `run`, their page and the report, first of all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.analysis.error_budget.text import part_words
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.quantities import number, scale
from flexapod.common.ranking import first_largest
from flexapod.output.text.parts import Item, Text, TextTable

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import analysis
else:
    analysis = LazyModule("flexapod.analysis")

KEPT, MISSED, OPEN = "kept", "NOT kept", "not judged"
MARKS = {KEPT: "good", MISSED: "bad", OPEN: "open"}
HOUR = 3600.0


def study_verdict(study: model.Study | model.ActuatorStudy | None) -> Dataset | None:
    """Verdict on a study's requirement; None of a study that has none."""
    asked = isinstance(study, model.Study) and study.requirement is not None
    return analysis.verdict(study) if asked else None  # type: ignore[arg-type]


def all_kept(data: Dataset | None) -> bool:
    """Test whether every requirement is judged and kept; none is always kept."""
    return data is None or bool(data.kept.all())


def verdict_items(data: Dataset | None) -> Iterator[Item]:
    """The answer in a sentence and a small table; nothing of a study without requirement."""
    if data is None:
        return
    yield answer(data)
    yield verdict_table(data)
    yield from (Text(words, "soft") for words in _notes(data))
    yield ""


def answer(data: Dataset) -> str:
    """Answer in a few words: no, where and by what; or yes; or that some requirement is not judged."""
    count = data.sizes["requirement"]
    missed, unjudged = (np.flatnonzero(x) for x in ((data.margin < 0).values, ~data.judged.values))
    if missed.size:
        worst = missed[first_largest(_excess(data)[missed])]
        rest = f" {len(missed)} of {count} requirements are missed." if len(missed) > 1 else ""
        return f"No: {_miss(data, int(worst))}{rest}{_unjudged(data, unjudged)}"
    if unjudged.size:
        return f"Not judged: {_reasons(data, unjudged)}."
    return f"Yes: {'the requirement is' if count == 1 else f'all {count} requirements are'} kept."


def _excess(data: Dataset) -> np.ndarray:
    """Part of the bound by which each is missed."""
    return -data.margin.values / np.where(data.wanted.values > 0, data.wanted.values, 1.0)


def _unjudged(data: Dataset, which: np.ndarray) -> str:
    return f" Not judged: {_reasons(data, which)}." if which.size else ""


def _reasons(data: Dataset, which: np.ndarray) -> str:
    found: dict[str, list[str]] = {}
    for k in which:
        found.setdefault(str(data.why.values[k]).rstrip("."), []).append(_name(str(data.requirement.values[k])))
    return "; ".join(f"{', '.join(names)} ({why})" for why, names in found.items())


def _miss(data: Dataset, k: int) -> str:
    """What is missed by how much, where, by which part; and what it is at home."""
    name, unit = str(data.requirement.values[k]), str(data.unit.values[k])
    found, wanted, home = _quantities(unit, *(float(data[x].values[k]) for x in ("found", "wanted", "home")))
    state, leg, part = str(data.state.values[k]), int(data.leg.values[k]), str(data.part.values[k])
    place = str(data.pose.values[k])
    at = f" at {place}" if place and not place.startswith(("on ", "after ", "the ")) else f" {place}" if place else ""
    words = [f"{_name(name)} {found} for {wanted}{at}", state, f"leg {leg}" if leg and "legs" not in part else ""]
    why = str(data.why.values[k])
    said = ", ".join(filter(None, words)) + (f": {why}" if why else "")
    said += f"; most of it {_parts(part)}" if part and name in ERRORS else f"; {part}" if part else ""
    if np.isnan(data.home.values[k]):
        return f"{said}."
    warm = str(data.home_state.values[k]).startswith("warm")
    return f"{said}. {'Warm at home' if warm else 'At home'} {home}."


ERRORS = (
    "pose_accuracy", "pose_accuracy_calibrated", "pose_accuracy_corrected", "repeatability",
    "minimum_incremental_motion",
)  # fmt: skip


def _parts(part: str) -> str:
    """Parts with the largest share; the second one makes up for the first."""
    return ", made up for by ".join(part_words(one) for one in part.split(", "))


def _name(name: str) -> str:
    key, _, axis = name.partition(".")
    return key.replace("_", " ") + (f" {axis}" if axis else "")


def _quantities(unit: str, *values: float) -> list[str]:
    """Values of one quantity in one unit that reads well."""
    if unit == "s" and max((abs(x) for x in values if np.isfinite(x)), default=0.0) >= HOUR:
        return [f"{number(x / HOUR)} h" for x in values]
    if unit == "1":
        return [number(x) for x in values]
    shown = scale([x for x in values if np.isfinite(x)] or [1.0], unit)
    return [shown.text(x) if np.isfinite(x) else "n/a" if np.isnan(x) else "without end" for x in values]


def verdict_table(data: Dataset) -> TextTable:
    """Each requirement in a row: asked, found, left, kept or not, and where it is worst."""
    rows = []
    for k, name in enumerate(map(str, data.requirement.values)):
        numbers = [float(data[x].values[k]) for x in ("wanted", "found", "margin")]
        wanted, found, left = _quantities(str(data.unit.values[k]), *numbers)
        if np.isnan(numbers[1]):
            found = left = ""
        state = MISSED if numbers[2] < 0 else KEPT if data.kept.values[k] else OPEN
        leg = int(data.leg.values[k])
        where = ", ".join(
            filter(None, [str(data.pose.values[k]), str(data.state.values[k]), f"leg {leg}" if leg else ""])
        )
        rows.append([_name(name), wanted, found, left, state, where])
    return TextTable(["requirement", "asked", "found", "left", "", "worst"], rows, left=(0, 4, 5), marks=MARKS)


def _notes(data: Dataset) -> Iterator[str]:
    names = list(map(str, data.requirement.values))
    sure = [_name(name) for name, is_sure in zip(names, data.sure.values, strict=True) if is_sure]
    words = f"Looked at in {data.attrs['poses']} poses, no proof for those between"
    yield f"{words}; for sure: {', '.join(sure)}." if sure else f"{words}."
    if "settling_time" in names:
        yield "Settling with the drives held, without a position loop."


def verdict_as_dict(data: Dataset | None) -> dict[str, object]:
    """A verdict as plain data under "verdict"; nothing of a study without requirement."""
    if data is None:
        return {}
    columns = ("wanted", "found", "margin", "kept", "judged", "sure", "home")
    rows = []
    for k, name in enumerate(map(str, data.requirement.values)):
        row: dict[str, object] = {"requirement": name, "unit": str(data.unit.values[k])}
        row |= {x: data[x].values[k].item() for x in columns}
        row |= {x: str(data[x].values[k]) for x in ("pose", "state", "part", "why")} | {"leg": int(data.leg.values[k])}
        rows.append(row)
    return {"verdict": {"answer": answer(data), "kept": all_kept(data), "requirements": rows}}
