"""Key paths of a study file: ``leg[3].piston.diameter``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from flexapod.common.errors import InputError, suggest_word

Step = str | int
_NAME = re.compile(r"([A-Za-z_][\w-]*)((?:\[\d+\])*)")


def parse_key(key: object, *, what: str) -> tuple[Step, ...]:
    """Steps of a key path: names, and numbers of list items counted from 1.

    Raises
    ------
    InputError
        It is not a key path; `what` is the entry of the sweep file that holds it.
    """
    steps: list[Step] = []
    for part in key.split(".") if isinstance(key, str) else [""]:
        match = _NAME.fullmatch(part.strip())
        if match is None:
            raise InputError(
                "is not a key path", key=what, value=key, allowed="names of the study file, e.g. leg[3].piston.diameter"
            )
        steps += [match[1], *(int(number) for number in re.findall(r"\d+", match[2]))]
    return tuple(steps)


def key_text(steps: tuple[Step, ...]) -> str:
    """The key path as text."""
    return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in steps).lstrip(".")


def copy_data(data: Any) -> Any:
    """A copy of tables and lists, all the way down; several times faster than `copy.deepcopy`."""
    if isinstance(data, dict):
        return {name: copy_data(value) for name, value in data.items()}
    return [copy_data(value) for value in data] if isinstance(data, list) else data


def leaves(value: object, steps: tuple[Step, ...]) -> Iterator[tuple[tuple[Step, ...], object]]:
    """Path and value of every single number in a value that may be a list, or a list of rows."""
    if isinstance(value, list):
        for number, item in enumerate(value, start=1):
            yield from leaves(item, (*steps, number))
    else:
        yield steps, value


def similar_key(data: Mapping[str, Any], steps: tuple[Step, ...]) -> str | None:
    """The key of the file that the user may have meant, as a question, or None."""
    wanted = key_text(steps)
    known = list(_all_keys(data, ""))
    ends = [key for key in known if key.endswith(f".{wanted}")]
    return f"Did you mean {ends[0]!r}?" if ends else suggest_word(wanted, known)


def _all_keys(data: object, path: str) -> Iterator[str]:
    if isinstance(data, Mapping):
        for name, value in data.items():
            inner = f"{path}.{name}" if path else str(name)
            yield inner
            yield from _all_keys(value, inner)
    elif isinstance(data, list) and data and isinstance(data[0], Mapping):
        yield from _all_keys(data[0], path)
