"""The tab "Budget": error budget of the tool by part, at home or where a result deviates most."""

from __future__ import annotations

import threading
from html import escape
from typing import TYPE_CHECKING

import viser

from flexapod import model
from flexapod.app.browser import markup
from flexapod.app.browser.background import Debouncer, Threads
from flexapod.common.errors import FlexapodError
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.scene.style import ERRORS

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import analysis
    from flexapod.analysis.error_budget import text
    from flexapod.analysis.error_budget.text import Bar
    from flexapod.common import quantities
    from flexapod.output.text import budget
    from flexapod.output.text import verdict as text_verdict
else:
    analysis = LazyModule("flexapod.analysis")
    text = LazyModule("flexapod.analysis.error_budget.text")
    quantities = LazyModule("flexapod.common.quantities")
    budget = LazyModule("flexapod.output.text.budget")
    text_verdict = LazyModule("flexapod.output.text.verdict")

CHANGED = 0.3  # after a change of the study, before its budget is computed [s]


class BudgetPanel:
    """The error budget of one user's study; made inside the tab that holds it, computed in the background."""

    def __init__(self, client: viser.ClientHandle, threads: Threads) -> None:
        self._html = client.gui.add_html("")
        self._lock, self._latest = threading.Lock(), Debouncer(threads, self._compute)
        self._study: model.Study | model.ActuatorStudy | None = None
        self._data: Dataset | None = None

    def show(self, study: model.Study | model.ActuatorStudy, data: Dataset | None = None) -> None:
        """The budget of a study at home, or where its results deviate most."""
        with self._lock:
            self._study, self._data = study, data
        self._latest.request(CHANGED)

    def close(self) -> None:
        """Drop what was computed."""
        self._latest.close()
        with self._lock:
            self._study = self._data = None

    def _compute(self) -> None:
        with self._lock:
            study, data = self._study, self._data
        if study is None:
            return
        html = ""
        try:
            html = budget_html(study, data)
        except FlexapodError as error:
            html = markup.error_html(error)
        finally:  # a fault, too, leaves no budget of the study before
            with self._lock:
                if study is self._study and data is self._data:
                    self._html.content = html


def budget_html(study: model.Study | model.ActuatorStudy, data: Dataset | None = None) -> str:
    """A budget in sentences, as a chart and as a table."""
    if not isinstance(study, model.Study):
        return markup.block("Error budgets are those of robots: a single actuator has no tool to place.", "soft")
    found = None if data is None else budget.peak_budget(data)
    where = (
        "at home" if found is None else f"at the pose of t = {found.attrs['pose_time']:.4g} s, the largest deviation"
    )
    found = analysis.budget(study) if found is None else found
    first, *more = found.attrs["summary"].splitlines()
    note = f"At rest, {where}; world axes. What is dynamic: flexapod budget FILE --motion."
    verdict = verdict_html(study)
    sentences = verdict + markup.block(first, "good") + "".join(markup.block(line) for line in more)
    return (
        sentences
        + chart_html(text.bars(found))
        + markup.scrollable_html(markup.table_html(*budget.table(found)))
        + markup.block(note, "soft")
    )


def verdict_html(study: model.Study) -> str:
    """Verdict on the requirement of a study in a sentence and a table; nothing without one."""
    found = text_verdict.study_verdict(study)
    if found is None:
        return ""
    table = text_verdict.verdict_table(found)
    said = markup.block(text_verdict.answer(found), "good" if text_verdict.all_kept(found) else "error")
    return said + markup.scrollable_html(markup.table_html(list(table.head), [list(row) for row in table.rows]))


def chart_html(rows: list[Bar]) -> str:
    """Bars of the parts, of each kind in its colour, with a legend."""
    most = max((sum(row.sizes.values()) for row in rows), default=0.0)
    if not most:
        return ""
    small = quantities.scale([sum(row.sizes.values()) for row in rows], "m")
    lines = []
    for row in rows:
        pieces = "".join(
            f"<span style='display:inline-block;height:0.8em;background:{color};"
            f"width:{60 * row.sizes[name] / most:.2f}%' title='{escape(what)}'></span>"
            for name, (what, color) in ERRORS.items()
            if name in row.sizes
        )
        size = f"{float(small(sum(row.sizes.values()))):.3g} {small.name}, {row.share_words}"
        lines.append(
            f"<div>{escape(row.words)}</div><div class='flexapod-bar' style='white-space:nowrap'>{pieces} "
            f"<b>{escape(size)}</b></div>"
        )
    used = {name for row in rows for name in row.sizes}
    box = "display:inline-block;width:0.8em;height:0.8em"
    legend = "".join(
        f"<div><span style='{box};background:{color}'></span> {escape(what)}</div>"
        for name, (what, color) in ERRORS.items()
        if name in used
    )
    return markup.panel_html("".join(lines) + f"<div style='padding-top:0.5em'>{legend}</div>")
