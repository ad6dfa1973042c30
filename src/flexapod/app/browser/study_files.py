"""A study for somebody to take along: its text, and with it the tables that the text names."""

from __future__ import annotations

import io
import re
import zipfile

import numpy as np

from flexapod.app.browser.document import Document
from flexapod.app.browser.uploads import plain_name
from flexapod.common.tables.csv_tables import table_text
from flexapod.common.tables.named_files import Content
from flexapod.common.tables.systems import system_text
from flexapod.model import ActuatorStudy, Study
from flexapod.model.stored import stored_tables

__all__ = ["study_download", "study_files"]


def study_download(document: Document, study: Study | ActuatorStudy | None) -> tuple[str, bytes]:
    """End of a file's name, and its content: a ZIP of the study and its tables, or the text alone where it names none.

    `study`: what the document reads as; None where it is refused.
    """
    text, tables = study_files(document, study) if study is not None else (document.text, {})
    if not tables:
        return ".toml", text.encode()
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as files:
        files.writestr("study.toml", text)
        for name, content in tables.items():
            files.writestr(name, content)
    return ".zip", archive.getvalue()


def study_files(document: Document, study: Study | ActuatorStudy) -> tuple[str, dict[str, str]]:
    """The text of a study that names plain files only, and the text of each of these by name."""
    tables: dict[str, Content] = {}
    for key, table in stored_tables(study).items():
        place = next(place for place in _places(key) if isinstance(document.value(place), str))
        name = _free(
            plain_name(table.name) if table.name else _named_after(place, table.content), tables, table.content
        )
        tables[name] = {**tables.get(name, {}), **table.content}
        if document.value(place) != name:
            document = document.changed(place, name)
    return document.text, {name: _text(content) for name, content in tables.items()}


def _places(key: str) -> tuple[str, ...]:
    """Where a key may stand in a text: by itself, in the table of all legs, in place of its table."""
    of_all = re.sub(r"^leg\[\d+\]", "leg", key)
    return key, of_all, *(place.rpartition(".")[0] for place in (key, of_all))


def _named_after(key: str, content: Content) -> str:
    stem = re.sub(r"\W+", "-", key.rpartition(".")[0]).strip("-")
    return f"{stem}.json" if "A" in content else f"{stem}.csv"


def _free(name: str, tables: dict[str, Content], content: Content) -> str:
    """A name under which no other table stands; columns of legs in one file stay together."""
    stem, _, ending = name.rpartition(".")
    names = (name, *(f"{stem}-{i}.{ending}" for i in range(2, len(tables) + 3)))
    return next(one for one in names if one not in tables or _fit(tables[one], content))


def _fit(there: Content, content: Content) -> bool:
    """Whether columns may stand beside others: those that both have are the same, the instants among them."""
    both = there.keys() & content.keys()
    return bool(both) and all(
        there[x][0] == content[x][0] and np.array_equal(np.asarray(there[x][1]), np.asarray(content[x][1]))
        for x in both
    )


def _text(content: Content) -> str:
    return system_text(content) if "A" in content else table_text(content)
