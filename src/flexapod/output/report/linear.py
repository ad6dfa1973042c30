"""A report's section of the linear model: what disturbances do about rest, what a controller does to damping."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from flexapod.common.errors import FlexapodError
from flexapod.common.files import scratch
from flexapod.common.quantities import column, sentence
from flexapod.model import ActuatorStudy
from flexapod.output.text import html
from flexapod.output.text.html import Html
from flexapod.output.text.parts import Item, Text, TextTable

if TYPE_CHECKING:
    from flexapod.model import Study

__all__ = ["linear_section"]


def linear_section(study: Study | ActuatorStudy | None) -> list[Html]:
    """Vibration by the study's disturbances and damping by its controller; nothing where it has neither."""
    if study is None or isinstance(study, ActuatorStudy):
        return []
    told: list[Item] = [*_shaken(study), *_damped(study)]
    return [html.section("linear", "Linear model about home", told)] if told else []


def _shaken(study: Study) -> Iterator[Item]:
    """Words and figure of the vibration by disturbances."""
    if study.disturbance is None:
        return
    from flexapod.analysis import vibration
    from flexapod.analysis.pose_errors.disturbances import words_of
    from flexapod.output import figures
    from flexapod.output.report.figures import store

    try:
        data = vibration(study)
    except FlexapodError as error:
        yield Text(f"The vibration by disturbances cannot be said: {error}", "bad")
        return
    yield from map(sentence, words_of(data, "at home"))
    with scratch() as folder:
        drawn = store(
            figures.vibration(data), "Rms of the tool by frequencies from here up", folder / "vibration", ("png",)
        )
    yield html.figure(drawn.title, drawn.picture, drawn.plot)


def _damped(study: Study) -> Iterator[Item]:
    """A table of damping without the controller and with it."""
    if study.control is None:
        return
    from flexapod.analysis.predicted_damping import control_words, predicted_damping

    try:
        found = predicted_damping(study)
    except FlexapodError as error:
        yield Text(f"What the controller does to damping cannot be said: {error}", "bad")
        return
    if found is None:
        return
    both = ((found.frequency, found.ratio), (found.frequency_with, found.ratio_with))
    columns = [text for f, ratio in both for text in (column(f, "Hz", 6)[1], column(100 * ratio, "")[1])]
    head = ["frequency [Hz]", "damping [%]", "with the controller [Hz]", "its damping [%]"]
    yield TextTable(head, list(zip(*columns, strict=True)), left=())
    yield Text("Predicted by the linear model, from sample to sample, without noise and limits.", "soft")
    yield from map(sentence, control_words(study))
