"""Tables of settings as Datasets and CSV: one row a setting, with errors, orders and cost."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.results.attributes import attributes
from flexapod.common.files import replace_file
from flexapod.common.lazy_imports import LazyModule
from flexapod.design.convergence.family import FAMILIES, Family, Findings
from flexapod.design.convergence.trials import QUANTITIES, Setting, Trial
from flexapod.model import ActuatorStudy, Study

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.common import datasets
else:
    datasets = LazyModule("flexapod.common.datasets")


@dataclass(frozen=True, kw_only=True)
class SettingRow:
    """A setting in the table: its run, and by quantity its relative error and the order from the row before."""

    family: str
    trial: Trial
    error: Mapping[str, float]
    order: Mapping[str, float]
    reference: bool


def as_dataset(study: Study | ActuatorStudy, found: Findings, *, partial: bool = False) -> Dataset:
    """Dataset of all findings; ``partial = 1`` in the attributes if the user stopped it."""
    rows = [row for name in FAMILIES if found.trials.get(name) for row in _family_rows(found, name)]
    for name in ("file", "recommended"):
        for trial in found.trials.get(name, ()):
            error = {q: found.error(trial, q) for q in found.quantities}
            none = dict.fromkeys(found.quantities, np.nan)
            rows.append(
                SettingRow(family=name, trial=trial, error=error, order=none, reference=trial is found.reference)
            )
    lines = [line for trial in found.trials.get("recommended", ()) for line in trial.setting.lines()]
    attrs = {
        **attributes(study, study.warnings),
        "title": "flexapod: convergence",
        "accuracy": found.accuracy,
        "quantity": QUANTITIES[found.quantities[0]],
        **{f"floor_{q}": floor for q, floor in found.floor.items()},
        "recommended": "\n".join(lines),
        "reference": reference_words(found.reference.setting) if found.reference else "",
        "reference_error": found.reference_error,
        "shape_step": found.shape_step,
        "notes": "\n".join(found.notes),
        "partial": int(partial),
    }
    return rows_dataset(rows, found.quantities, attrs).merge(_groups(found), combine_attrs="override")


def _family_rows(found: Findings, name: str) -> list[SettingRow]:
    family = found.family(name)
    errors = {q: family.errors(q) for q in found.quantities}
    orders = {q: family.orders(q) for q in found.quantities}
    return [
        SettingRow(
            family=name,
            trial=trial,
            error={q: float(errors[q][i]) for q in errors},
            order={q: float(orders[q][i]) for q in orders},
            reference=trial is family.reference,
        )
        for i, trial in enumerate(family.trials)
    ]


def rows_dataset(rows: list[SettingRow], quantities: Iterable[str], attrs: Mapping[str, object]) -> Dataset:
    """Rows as a Dataset along ``setting``."""

    def column(values: Iterable[object], unit: str, words: str) -> tuple[str, object, dict[str, str]]:
        return "setting", np.array(list(values)), {"units": unit, "long_name": words}

    trials = [row.trial for row in rows]
    nan = float("nan")
    data = {
        "family": column((row.family for row in rows), "1", "what is varied"),
        "label": column((_label(row) for row in rows), "1", "setting in words"),
        "fidelity": column((t.setting.fidelity for t in trials), "1", "fidelity"),
        "basis": column((_basis(t.setting) for t in trials), "1", "basis of assumed modes"),
        "shapes": column((t.setting.shapes for t in trials), "1", "lateral shapes per plane"),
        "step": column((t.setting.step or nan for t in trials), "s", "fixed step"),
        "tolerance": column((t.setting.tolerance or nan for t in trials), "1", "tolerance of the step control"),
        "steps": column((t.steps for t in trials), "1", "number of steps"),
        "seconds": column((t.seconds for t in trials), "s", "time of the integration, median of repeats"),
        "reference": column((int(row.reference) for row in rows), "1", "1: the others are compared with this one"),
        "failure": column((t.failure for t in trials), "1", "why the run failed"),
    }
    for q in quantities:
        words = QUANTITIES[q]
        data[f"peak_{q}"] = column((t.peak(q) for t in trials), "m", f"largest {words}")
        data[f"error_{q}"] = column((row.error[q] for row in rows), "1", f"relative error of the {words}")
        data[f"order_{q}"] = column((row.order[q] for row in rows), "1", f"observed order of the {words}")
    return datasets.build_dataset(data, attrs=attrs)


def _groups(found: Findings) -> Dataset:
    """Findings of each family along ``group``: reference, rate, order, error of the reference."""
    families = [found.family(name) for name in FAMILIES if found.trials.get(name)]
    main = found.quantities[0]
    data = {
        "group_reference": ("group", np.array([_reference(f) for f in families]), {"long_name": "reference"}),
        "rate": ("group", np.array([_rate(f, main) for f in families]), {"long_name": "how the error falls"}),
        "order": ("group", np.array([f.order(main) for f in families]), {"long_name": "observed order"}),
    }
    for q in found.quantities:
        own = np.array([f.own_error(q) for f in families])
        data[f"own_error_{q}"] = ("group", own, {"units": "1", "long_name": f"{QUANTITIES[q]}: error of the reference"})
    return datasets.build_dataset(data, {"group": [f.name for f in families]})


def _reference(family: Family) -> str:
    return "none: all runs failed" if family.reference is None else reference_words(family.reference.setting)


def _rate(family: Family, quantity: str) -> str:
    return family.rate(quantity) if len(family.trials) > 2 and family.reference else "too few runs to tell"


def reference_words(setting: Setting) -> str:
    """Setting as text."""
    return f"{setting.label}, {setting.time_words}"


def _label(row: SettingRow) -> str:
    setting = row.trial.setting
    if row.family == "step":
        return setting.time_words
    return setting.label if row.family in (*FAMILIES, "ladder") else reference_words(setting)


def _basis(setting: Setting) -> str:
    return setting.basis if setting.fidelity == "assumed-modes" else ""


def save_table(data: Dataset, path: Path) -> Path:
    """Write what varies along ``setting`` to a CSV file, a setting a row; missing numbers stay empty.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    names = [str(name) for name, values in data.data_vars.items() if values.dims == ("setting",)]
    head = [_head(name, data[name].attrs.get("units", "1")) for name in names]
    columns = [data[name].values for name in names]
    with replace_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        writer.writerows([_cell(column[i]) for column in columns] for i in range(data.sizes["setting"]))
    return path


def _head(name: str, unit: str) -> str:
    return name if unit == "1" else f"{name} [{unit}]"


def _cell(value: object) -> str:
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else f"{value:.10g}"
    return str(value)
