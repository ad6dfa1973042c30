"""An error in words: what is wrong and with what, what is allowed, the next step."""

from __future__ import annotations

from collections.abc import Mapping

from flexapod.common.errors import ComputationError, FlexapodError, InputError

__all__ = ["lines_of", "parts_of"]


def parts_of(error: FlexapodError) -> dict[str, str | None]:
    """The parts of an error by name: `kind`, `what`, and where given `file`, `key`, `value`, `allowed`, `next_step`."""
    if isinstance(error, InputError):
        return {"kind": "input", **error.as_dict()}
    if isinstance(error, ComputationError):
        return {"kind": "computation", "what": error.what, "next_step": error.next_step}
    return {"kind": "computation", "what": str(error)}


def lines_of(parts: Mapping[str, str | None]) -> list[str]:
    """An error in words: what is wrong and with what, then a line each for file, what is allowed and the next step."""
    named = ("allowed", "next_step") if not parts.get("key") else ("file", "allowed", "next_step")
    return [_headline(parts), *(f"  {name.replace('_', ' '):11s}{parts[name]}" for name in named if parts.get(name))]


def _headline(parts: Mapping[str, str | None]) -> str:
    """Key and value, else the file, and what is wrong with it."""
    place = parts.get("key") or parts.get("file")
    if parts.get("key") and parts.get("value") is not None:
        place = f"{place} = {parts['value']}"
    return f"Error: {place}: {parts['what']}" if place else f"Error: {parts['what']}"
