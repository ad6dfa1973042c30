"""Errors of flexapod: what happened, where, the value, what is allowed, what to do next."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import Path

LONGEST_QUOTE = 80
"""Letters that a message quotes of what stands somewhere: of a cell of a table, of a value."""


class FlexapodError(Exception):
    """Base of every error that flexapod raises on purpose; `exit_code` is what a command returns.

    Examples
    --------
    >>> issubclass(fx.InputError, fx.FlexapodError) and issubclass(fx.ComputationError, fx.FlexapodError)
    True
    """

    exit_code = 1


class ComputationError(FlexapodError):
    """A computation on valid input did not succeed (exit code 1).

    Parameters
    ----------
    what : str
        What failed, where and when, in the user's words.
    next_step : str, optional
        What the user can do about it.

    Examples
    --------
    >>> try:
    ...     fx.forward_kinematics(fx.preset("paper-robot"), [0.8, 1.2, 0.8, 1.2, 0.8, 1.2])
    ... except fx.ComputationError as error:
    ...     print(error.exit_code)
    1
    """

    exit_code = 1

    what: str
    next_step: str | None

    def __init__(self, what: str, *, next_step: str | None = None) -> None:
        self.what, self.next_step = what, next_step
        super().__init__(_sentences(what, next_step))

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuild_computation, (type(self), self.what, self.next_step)


class InputError(FlexapodError):
    """Input that is refused before anything is computed (exit code 2).

    Parameters
    ----------
    what : str
        What is wrong, without file, key and value.
    file : str or Path, optional
        The file that was read.
    key : str, optional
        Key path in that file, or keyword of a Python call, e.g. ``leg.piston.diameter``.
    value : object, optional
        The value found there.
    allowed : str, optional
        What is allowed.
    next_step : str, optional
        What the user can do.

    Examples
    --------
    >>> try:
    ...     fx.preset("hexapod")
    ... except fx.InputError as error:
    ...     print(error.key, error.value, error.exit_code)
    preset hexapod 2
    """

    exit_code = 2

    def __init__(
        self,
        what: str,
        *,
        file: str | Path | None = None,
        key: str | None = None,
        value: object = None,
        allowed: str | None = None,
        next_step: str | None = None,
    ) -> None:
        self.what: str = what
        self.file: str | None = None if file is None else str(file)
        self.key: str | None = key
        self.value: object = value
        self.allowed: str | None = allowed
        self.next_step: str | None = next_step
        super().__init__(self._message())

    def _message(self) -> str:
        place = ": ".join(str(part) for part in (self.file, self._key_and_value()) if part)
        head = f"{place}: {self.what}" if place else self.what
        return _sentences(head, f"Allowed: {self.allowed}" if self.allowed else None, self.next_step)

    def _key_and_value(self) -> str | None:
        if self.key is None:
            return None
        return self.key if self.value is None else f"{self.key} = {_short(self.value)}"

    def with_location(self, *, file: str | Path | None = None, prefix: str = "") -> InputError:
        """The same error with its file and the path of the section that holds the key."""
        key = ".".join(part for part in (prefix, self.key) if part) or None
        return type(self)(
            self.what,
            file=self.file or file,
            key=key,
            value=self.value,
            allowed=self.allowed,
            next_step=self.next_step,
        )

    def as_dict(self) -> dict[str, str | None]:
        """The parts of the message, for machine-readable output."""
        try:
            value = None if self.value is None else str(self.value)
        except Exception:  # see `_short`
            value = _short(self.value)
        return {
            "what": self.what,
            "file": self.file,
            "key": self.key,
            "value": value,
            "allowed": self.allowed,
            "next_step": self.next_step,
        }

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuild_input, (type(self), self.what, self.file, self.key, self.value, self.allowed, self.next_step)


class Malformed(InputError):
    """Error that no other values can mend: an unknown key, a wrong unit, no number, no such choice."""


def suggest_word(word: str, allowed: Iterable[str]) -> str | None:
    """The allowed word that a mistyped one most resembles, as a question, or None."""
    found = closest_word(word, allowed)
    return None if found is None else f"Did you mean {found!r}?"


def closest_word(word: str, allowed: Iterable[str]) -> str | None:
    """The allowed word that a mistyped one most resembles, or None."""
    found = difflib.get_close_matches(word, list(allowed), n=1, cutoff=0.6)
    return found[0] if found else None


def check_kind(value: object, kinds: type | tuple[type, ...], key: str, allowed: str) -> None:
    """Raise InputError of a value that is of none of some kinds; `allowed` says in words what they are."""
    if not isinstance(value, kinds):
        raise InputError(f"is no such thing but a {type(value).__name__}", key=key, allowed=allowed)


def check_known(value: object, among: Iterable[str], key: str, what: str = "is not known") -> None:
    """Raise InputError of a value that is none of some words, with the nearest of them."""
    words = list(among)
    if not isinstance(value, str) or value not in words:
        hint = suggest_word(value, words) if isinstance(value, str) else None
        raise InputError(what, key=key, value=value, allowed=", ".join(words), next_step=hint)


def names_of(given: object, key: str) -> list[str]:
    """One name or several, as a list; `key` is what a refusal calls them."""
    if isinstance(given, str):
        return [given]
    if not isinstance(given, Iterable):
        raise InputError("is no name", key=key, value=given, allowed="a name, or a list of names")
    return [name if isinstance(name, str) else _short(name) for name in given]


def _rebuild_computation(kind: type[ComputationError], what: str, next_step: str | None) -> ComputationError:
    return kind(what, next_step=next_step)


def _rebuild_input(
    kind: type[InputError], what: str, file: str | None, key: str | None, value: object, allowed: str | None,
    next_step: str | None,
) -> InputError:  # fmt: skip
    return kind(what, file=file, key=key, value=value, allowed=allowed, next_step=next_step)


def quote_text(text: str) -> str:
    """A text in quotes, as a message shows it: of a long one the beginning."""
    return _short(text[:LONGEST_QUOTE])


def _short(value: object) -> str:
    try:
        text = " ".join(repr(value).split())
    except Exception:  # a whole number of thousands of digits, lists too deep, or an object's own error
        text = f"a {type(value).__name__} that cannot be written"
    return text if len(text) <= LONGEST_QUOTE else text[: LONGEST_QUOTE - 3] + "..."


def _sentences(*parts: str | None) -> str:
    kept = [part.rstrip() for part in parts if part]
    return " ".join(part if part.endswith((".", "?", "!")) else part + "." for part in kept)
