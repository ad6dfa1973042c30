"""Channels by name: ``drive:3`` is one, ``drive`` stands for all that begin with ``drive:``."""

from __future__ import annotations

from collections.abc import Sequence

from flexapod.common.errors import InputError, closest, names_of

__all__ = ["NOISE", "RATE", "Names", "chosen", "groups"]

RATE = "rate:"  # before the name of a reading: its rate of change
NOISE = "noise:"  # before the name of a sensor: what is added to its reading

Names = str | Sequence[str] | None


def chosen(given: Names, among: Sequence[str], key: str) -> list[int]:
    """Places of channels by names or groups, in the order of the names; all for None.

    Parameters
    ----------
    given : str or sequence of str, optional
        Names (``tool:z``) and groups (``tool``).
    among : sequence of str
        All names of channels there are.
    key : str
        What a refusal calls the argument.

    Raises
    ------
    InputError
        No channel of this name, with the nearest.
    """
    if given is None:
        return list(range(len(among)))
    found: list[int] = []
    for name in names_of(given, key):
        places = [i for i, known in enumerate(among) if known == name or known.startswith(f"{name}:")]
        if not places:
            raise _unknown(name, among, key)
        found += [i for i in places if i not in found]
    return found


def groups(names: Sequence[str]) -> list[str]:
    """Groups that channels belong to, in their order: what stands before the last colon."""
    return list(dict.fromkeys(name.rpartition(":")[0] or name for name in names))


def _unknown(name: str, among: Sequence[str], key: str) -> InputError:
    return InputError(
        "is not a channel",
        key=key,
        value=name,
        allowed=", ".join(groups(among)) + f", or a single one as {among[0]}" if among else "none",
        next_step=closest(name, [*groups(among), *among]),
    )
