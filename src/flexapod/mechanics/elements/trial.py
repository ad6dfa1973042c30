"""Trial of external elements: errors in hooks, and numbers that do not fit, are reported with class and file."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.common.errors import FlexapodError, InputError

if TYPE_CHECKING:
    from flexapod.mechanics.elements.element import Physics
    from flexapod.mechanics.elements.slot import Slot


def source_of(element: type[Physics]) -> Path | None:
    """File of the module of a class; None of one that was typed into a console."""
    file = getattr(sys.modules.get(element.__module__), "__file__", None)
    found = None if file is None else Path(file)
    return found if found is not None and found.is_file() else None


def hook_error(kind: type[Physics], hook: str, what: str, **more: Any) -> InputError:
    """Error about a hook of a class, with its file."""
    return InputError(what, file=source_of(kind), key=f"{kind.__name__}.{hook}", **more)


@contextmanager
def wrap_hook_errors(kind: type[Physics], hook: str) -> Iterator[None]:
    """Hook of a class that is called within: what it raises becomes an InputError with class and file.

    Raises
    ------
    InputError
        A class with a table of its own raised what is none of flexapod's errors.
    """
    try:
        yield
    except FlexapodError:
        raise
    except Exception as error:
        if not kind.at:
            raise
        said = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        what = f"fails with {said.splitlines()[0].rstrip('.')}"
        advice = "See `flexapod.Element` and docs/an-element-of-your-own.md"
        raise hook_error(kind, hook, what, next_step=advice) from error


def refuse_declared(kind: type[Physics]) -> None:
    """Refuse a class whose names and sizes are none, or whose tables name what it does not have.

    Raises
    ------
    InputError
        With class and file.
    """
    for hook in ("coordinates", "parameters"):
        named = getattr(kind, hook)
        with wrap_hook_errors(kind, hook):
            sizes = {str(name): int(size) for name, size in named}
        if len(sizes) < len(named) or not all(name.isidentifier() and size > 0 for name, size in sizes.items()):
            raise hook_error(kind, hook, "are no names with sizes", value=named, allowed='as (("k", 1), ("axis", 3))')
    for hook, of in (("absent", kind.parameters), ("follows", kind.coordinates)):
        for name in getattr(kind, hook):
            if name not in dict(of):
                names = ", ".join(dict(of)) or "none: there are none"
                raise hook_error(kind, hook, "is none of the element's own", value=name, allowed=names)


def refuse_numbers(slot: Slot, given: Mapping[str, Any], known: Mapping[str, int]) -> None:
    """Refuse numbers of an external element that no parameter takes, in size or name, or that are no numbers.

    ``known``: all parameters of a leg by name, with their sizes.

    Raises
    ------
    InputError
        With class and file.
    """
    kind = slot.kind
    for called, value in given.items():
        name = called.removeprefix(slot.prefix)
        if called not in known:
            names = ", ".join(name for name, _ in kind.parameters) or "nothing: `parameters` is empty"
            raise hook_error(kind, "numbers", "is no parameter of the element", value=name, allowed=names)
        with wrap_hook_errors(kind, "numbers"):
            numbers = np.asarray(value, dtype=float)
        if numbers.size != known[called]:
            sizes = f"{numbers.size} numbers for {name}, which `parameters` says has {known[called]}"
            raise hook_error(kind, "numbers", f"gives {sizes}", value=value)
        if not np.isfinite(numbers).all():
            raise hook_error(kind, "numbers", f"gives {name} a value that is no number", value=value)
