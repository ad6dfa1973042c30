"""Calls of public functions with one odd argument: what each needs besides, and what is odd."""

from __future__ import annotations

import inspect
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import flexapod as fx
from flexapod import control

ROOT = Path(__file__).parents[1]


def deep() -> list[Any]:
    """A list in a list, 900 times."""
    found: list[Any] = []
    for _ in range(900):
        found = [found]
    return found


def odd_values() -> dict[str, Any]:
    """What no call means, by name."""
    from xarray import Dataset

    return {
        "None": None, "text": "nonsense", "empty text": "", "zero byte": "a\0b", "400 digits": 10**400,
        "5000 digits": -(10**5000), "nan": float("nan"), "inf": float("inf"), "complex": 1 + 2j, "True": True,
        "empty list": [], "list of None": [None], "list of large": [10**400] * 6, "object": object(),
        "empty Dataset": Dataset(), "dict": {"x": 1}, "empty dict": {}, "bytes": b"abc", "function": lambda: None,
        "deep": deep(), "class": float, "set": {1, 2}, "texts": ["a", "b"], "complex array": np.full((2, 2), 1j),
    }  # fmt: skip


#: Of parameters of many calls what is right, by name.
@cache
def right() -> dict[str, Any]:
    """Arguments that are right, for the parameters that need one."""
    from tests.helpers.odd import swinging

    study = fx.model.override(fx.preset("nano-hexapod"), fidelity="rigid", duration=0.002, output_step=0.001)
    system, law = swinging(), control.DVF(1.0)
    return {
        "robot": study, "study": study, "subject": study, "system": system, "controller": law, "hz": [1.0, 10.0],
        "lengths": study.robot.home_lengths, "inputs": "drive", "outputs": "tool", "path": "result.nc",
        "gains": [0.5, 1.0], "format": "mat", "name": "paper-robot", "text": fx.model.preset_text("paper-robot"),
        "corner": 10.0, "frequency": 10.0, "damping": 0.1, "value": 1.0, "ratio": 3.0,
        "samples": np.sin(np.arange(200.0)), "radius": 1.0, "half_angle": 0.2, "kind": "6-UPS", "letters": "UPS",
        "period": 1e-3, "jacobian": np.eye(2), "stiffness": np.eye(6), "force": "drive:1", "place": "stroke:1",
        "gain": 1.0, "law": control.gain(1.0), "sensor": "stroke",
        "fig": fx.plot.bode(system.frequency_response([1.0, 2.0]), "drive:1", "stroke:1"), "stem": "figure",
        "data": fx.simulate(study),
    }  # fmt: skip


def parameters(call: Any) -> list[str]:
    """Names of what a call takes, but for the rest of a name."""
    kinds = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    try:
        return [name for name, one in inspect.signature(call).parameters.items() if one.kind not in kinds]
    except (TypeError, ValueError):
        return []


def needed(call: Any) -> list[str]:
    """Names of what it needs."""
    known = inspect.signature(call).parameters
    return [name for name in parameters(call) if known[name].default is inspect.Parameter.empty]


def arguments(call: Any, own: dict[str, Any]) -> tuple[list[Any], dict[str, Any]]:
    """Arguments by position where a parameter takes no name."""
    known = inspect.signature(call).parameters
    placed = [own[name] for name in own if known[name].kind is inspect.Parameter.POSITIONAL_ONLY]
    named = {name: x for name, x in own.items() if known[name].kind is not inspect.Parameter.POSITIONAL_ONLY}
    return placed, named
