"""JSON schema of what a study file may hold: an editor completes its keys, shows their words, and marks wrong ones.

It is made of what the readers ask of all examples of the reference, so a text that it accepts may still be refused:
what belongs together, and units of another kind, only reading tells.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from flexapod.common.tables.columns import Column
from flexapod.common.tables.reference import plain_path, reference
from flexapod.common.units import DIMENSIONS
from flexapod.model.file.fields import NotedField, Notes, read_notes
from flexapod.model.file.key_trials import study_data, words_of

DRAFT = "http://json-schema.org/draft-07/schema#"
_NUMBER = {"type": ["number", "string"]}
_LIMITS = {"above": "exclusiveMinimum", "at least": "minimum", "below": "exclusiveMaximum", "at most": "maximum"}


@dataclass
class _Node:
    """A key: `forms` of its value, as JSON; `inner`: keys of a table there; `words`; once a table, or in a list."""

    forms: dict[str, dict[str, Any]] = field(default_factory=dict)
    inner: dict[str, _Node] = field(default_factory=dict)
    words: str = ""
    table: bool = False
    rows: bool = False
    named: bool = False

    def at(self, path: str) -> _Node:
        """The key at a path below this one."""
        found = self
        for name in plain_path(path).split(".") if path else ():
            found = found.inner.setdefault(name, _Node())
        return found


def json_schema() -> str:
    """The schema, as text."""
    top = _Node(table=True)
    with tempfile.TemporaryDirectory() as name:
        for file, text in reference().files.items():
            (Path(name) / file).write_text(text, encoding="utf-8")
        for entry in reference().entries:
            _take(top, read_notes(study_data(entry), Path(name))[0])
    found = {"$schema": DRAFT, "title": "A study of flexapod", **_schema(top)}
    return json.dumps(found, indent=1, ensure_ascii=False) + "\n"


def _take(top: _Node, notes: Notes) -> None:
    """Put what one example shows into the tree of keys."""
    for path, columns in notes.columns.items():
        names = notes.allowed.get(path, ())
        for column in (column for name, column in columns.items() if name in names):
            for form in _others(column):
                top.at(path).at(column.name).forms[json.dumps(form)] = form
    for asked in notes.fields.values():
        for form in _forms(asked):
            top.at(asked.key).forms[json.dumps(form)] = form
    for path, names in notes.allowed.items():
        node = top.at(path)
        node.rows |= path.endswith("]")
        node.table |= not path.endswith("]")
        node.named |= path in notes.named
        words = words_of(notes, plain_path(path))
        for name in sorted(names):
            node.at(name).words = node.at(name).words or words.get(name, "")


def _forms(asked: NotedField) -> Iterator[dict[str, Any]]:
    """Forms that may stand where a value is read."""
    if asked.kind == "number":
        units = {DIMENSIONS[dimension].unit for dimension in asked.dimensions} - {""}
        yield _NUMBER | _bounds(asked.bounds.words) | ({"$comment": ", ".join(sorted(units))} if units else {})
    elif asked.kind == "whole":
        yield {"type": "integer"} | _bounds(asked.bounds.words)
    elif asked.kind == "words":
        yield {"type": "array", "items": {"enum": list(asked.choices or ())}}
    else:
        plain = {"vector": _array(_NUMBER), "rows": _array(_array(_NUMBER)), "flag": {"type": "boolean"}}
        yield plain.get(asked.kind, {"enum": list(asked.choices)} if asked.choices else {"type": "string"})


def _others(column: Column) -> Iterator[dict[str, Any]]:
    """Forms that its class takes as well: a list for all legs, a number or a text in place of a table."""
    if column.kind == "vector":
        yield _array(_NUMBER)
    if (column.kind == "table" and column.dimensions) or column.short == "number":
        yield _NUMBER
    if column.short == "text":
        yield {"type": "string"}


def _array(items: dict[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": items}


def _bounds(words: str) -> dict[str, float]:
    """Limits of a number; JSON lets them be for texts, whose numbers have units."""
    found = re.findall(r"(above|at least|below|at most) (\S+?)(?:,|$)", words)
    return {_LIMITS[name]: float(limit) for name, limit in found}


def _schema(node: _Node) -> dict[str, Any]:
    forms = list(node.forms.values())
    if node.table or node.rows:
        inner = {name: _schema(key) for name, key in node.inner.items()}
        table: dict[str, Any] = {"type": "object", "properties": inner, "additionalProperties": False}
        if node.named:  # of any names, each like any of the examples
            each = [form for key in inner.values() for form in key.get("anyOf", [key])]
            table = {"type": "object", "additionalProperties": {"anyOf": each}}
        forms += [table] * node.table + [_array(table)] * node.rows
    head = {"description": node.words.removeprefix("table: ")} if node.words else {}
    return head | (forms[0] if len(forms) == 1 else {"anyOf": forms} if forms else {})
