"""Imports without searches for garbage, which would take a third of the time of a short process."""

from __future__ import annotations

import atexit
import gc
from importlib import import_module
from types import ModuleType

__all__ = ["loaded"]

atexit.register(gc.freeze)  # the search as the interpreter ends would look at every module again


def loaded(name: str) -> ModuleType:
    """Import a module; what it makes goes to the oldest generation at once, as it stays for the life of the process."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        return import_module(name)
    finally:
        if not gc.get_freeze_count():
            gc.freeze()
            gc.unfreeze()  # into the oldest generation
        if collecting:
            gc.enable()
