"""The paper's energies line by line as printed, and what each printed line costs the tip.

A printed line takes the place of the derived one, all others stay; the tip's path is then integrated with the rates of
section 2.2, three shapes, a tip mass of ours, and for the lines about weight with gravity in the plane of motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from xarray import Dataset

from flexapod import model
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.time_history import Share
from flexapod.common.arrays import Array
from flexapod.mechanics import shapes
from flexapod.mechanics.shapes.beam_functions import clamped_free
from flexapod.verification.paper.energies import (
    SHAPES,
    TIP_MASS,
    BeamState,
    Change,
    matrices,
    modified_beam_kinetic,
    quadratic_form,
    weighted_sum,
)

GRAVITY = 9.81  # m/s^2, in the cases that are upright
STEP, OUTPUT, DURATION = 5e-4, 1e-2, 10.0  # s; RK4 errs by (omega h)^4 / 120 a radian: 2e-6 for 40 Hz
CHUNK = 1.0  # s of matrices at once


def roots(count: int) -> Array:
    """Roots epsilon_i of Eq. 3."""
    return np.array([shape.eps for shape in clamped_free(count)])


def _norm_as_said(p: BeamState) -> dict[str, Any]:
    """Kinetic and strain energy with Y_i that are not normalised, taken as if they were: squares of Y_i count 1."""
    eps = roots(p.basis.count)
    alpha = (np.sin(eps) + np.sinh(eps)) / (np.cos(eps) + np.cosh(eps))
    mass, k, squares = p.basis.mass.copy(), p.basis.count, np.outer(alpha, alpha)
    mass[:k, :k] /= squares
    bent = 0.5 * p.EI / p.length**3 * quadratic_form(p.a, p.basis.stiffness / squares)
    return {"4": modified_beam_kinetic(p, mass, sliding=1.0), "6": bent}


def _frequencies_as_printed(p: BeamState) -> Any:
    """Strain energy 1/2 rho L sum omega_i^2 a_i^2 with omega^4 = beta^4 EI / rho, in numbers of SI."""
    omega_by_length = roots(p.basis.count) * (p.EI / p.rho) ** 0.25
    return 0.5 * p.rho / p.length * quadratic_form(p.a, np.diag(omega_by_length**2))


def _nothing(p: BeamState) -> Any:
    return 0.0 * p.tip


@dataclass(frozen=True)
class PrintedLine:
    """Printed line: what it changes in the energies, by equation, and whether the case is vertical in gravity."""

    name: str
    change: Change
    upright: bool = False


def _tip_with(p: BeamState, square: Any, coupled: Any) -> dict[str, Any]:
    """Eq. 5 with another u'^2 and another coupling."""
    return {"5": 0.5 * TIP_MASS * (p.tip**2 * p.angle_dot**2 + square + coupled)}


#: Lines of the paper in its order; `copy` in a name: as our copy has it, which may have lost dots or a power.
LINES = (
    PrintedLine("2, norm", _norm_as_said),
    PrintedLine("2, power (copy)", lambda p: {"6": _frequencies_as_printed(p)}),
    PrintedLine("4, without sliding", lambda p: {"4": modified_beam_kinetic(p, p.basis.mass, sliding=0.0)}),
    PrintedLine("5, dots lost (copy)", lambda p: _tip_with(p, p.tip**2, TIP_MASS * p.length * p.angle_dot * p.tip)),
    PrintedLine("5, with dots", lambda p: _tip_with(p, p.tip_dot**2, TIP_MASS * p.length * p.angle_dot * p.tip_dot)),
    PrintedLine(
        "5, with dots and factor 2", lambda p: _tip_with(p, p.tip_dot**2, 2 * p.length * p.angle_dot * p.tip_dot)
    ),
    PrintedLine("7, nothing elastic", lambda p: {"7": _nothing(p)}, upright=True),
    PrintedLine(
        "8, linear", lambda p: {"8, tip": TIP_MASS * p.angle_dot**2 * p.length * weighted_sum(p.basis.tip_slope, p.a)}
    ),
    PrintedLine(
        "8, with half and square",
        lambda p: {"8, tip": 0.5 * TIP_MASS * p.angle_dot**2 * weighted_sum(p.basis.tip_slope, p.a) ** 2},
    ),
    PrintedLine("9-10, centrifugal only", lambda p: {"9-10": _nothing(p)}, upright=True),
)


def _none(_: BeamState) -> dict[str, Any]:
    return {}


def tip_paths(cases: Sequence[tuple[PrintedLine | None, bool]]) -> Array:
    """Deflection of the tip [m], (case, time), at every `OUTPUT`.

    Parameters
    ----------
    cases : sequence of (PrintedLine or None, bool)
        The line that is as printed, none where all are as derived, and whether gravity acts in the plane of motion.
    """
    study, basis = model.preset("paper-actuator"), shapes.lateral_basis("clamped-free", SHAPES)
    static = np.linalg.solve(basis.stiffness, basis.tip)
    bent = study.initial.tip_displacement * static / (basis.tip @ static)  # (T9.3)
    state = np.tile(np.concatenate([bent, np.zeros(SHAPES)])[:, None], (len(cases), 1, 1))
    equations = [matrices(_none if line is None else line.change, GRAVITY if u else 0.0) for line, u in cases]
    tips, skip = [basis.tip @ state[:, :SHAPES, 0].T], round(OUTPUT / STEP)
    for start in np.arange(0.0, DURATION, CHUNK):
        instants = start + np.arange(0.0, CHUNK + 0.25 * STEP, STEP / 2)
        system, push = (np.stack(x, axis=1) for x in zip(*(_first_order(e, instants) for e in equations), strict=True))
        for i in range(round(CHUNK / STEP)):
            state = _runge_kutta(system[2 * i : 2 * i + 3], push[2 * i : 2 * i + 3], state)
            if (i + 1) % skip == 0:
                tips.append(basis.tip @ state[:, :SHAPES, 0].T)
    return np.array(tips).T


def _first_order(equation: Any, time: Array) -> tuple[Array, Array]:
    """State matrices (n, 2k, 2k) and right sides (n, 2k, 1) at instants of the motion with the rates of section 2.2."""
    study, count = model.preset("paper-actuator"), len(time)
    turn, feed = (float(getattr(law, "rate", 0.0)) for law in (study.motion.rotation, study.motion.extension))
    beam = study.actuator
    motion = (beam.free_length + feed * time, np.full(count, feed), beam.angle + turn * time, np.full(count, turn))
    found = equation.map(count)(*(row[None, :] for row in motion))
    M, C, K, rest = (np.array(x).reshape(SHAPES, count, -1).swapaxes(0, 1) for x in found)
    lower = -np.linalg.solve(M, np.concatenate([K, C, rest], axis=2))
    system, push = np.zeros((count, 2 * SHAPES, 2 * SHAPES)), np.zeros((count, 2 * SHAPES, 1))
    system[:, :SHAPES, SHAPES:] = np.eye(SHAPES)
    system[:, SHAPES:], push[:, SHAPES:] = lower[:, :, :-1], lower[:, :, -1:]
    return system, push


def _runge_kutta(system: Array, push: Array, x: Array) -> Array:
    """One step of all cases from matrices at its start, middle and end."""
    one = system[0] @ x + push[0]
    two = system[1] @ (x + 0.5 * STEP * one) + push[1]
    three = system[1] @ (x + 0.5 * STEP * two) + push[1]
    four = system[2] @ (x + STEP * three) + push[2]
    return x + STEP / 6 * (one + 2 * two + 2 * three + four)


def printed_lines(_: Share) -> Dataset:
    """Error of the tip by each printed line.

    Returns
    -------
    xarray.Dataset
        Over `line`: `tip_deflection` (time, line) with that line as printed, `derived` (time, line) with none, in the
        same case; `tip_error` and `largest` (line): largest distance of the two, and largest deflection as derived
        [m]; `upright` (line): 1 where gravity acts.
    """
    found = tip_paths([(None, False), (None, True), *((line, line.upright) for line in LINES)])
    paths, own = found[2:], found[[int(line.upright) for line in LINES]]
    metre, time = {"units": "m"}, OUTPUT * np.arange(found.shape[1])
    values = {
        "tip_deflection": (("time", "line"), paths.T, metre),
        "derived": (("time", "line"), own.T, metre),
        "tip_error": ("line", np.abs(paths - own).max(axis=1), metre),
        "largest": ("line", np.abs(own).max(axis=1), metre),
        "upright": ("line", [int(line.upright) for line in LINES], {"units": "1"}),
    }
    coords = {"line": [line.name for line in LINES], "time": ("time", time, {"units": "s"})}
    return Dataset(values, coords, attributes(model.preset("paper-actuator")) | {"step": STEP, "tip_mass": TIP_MASS})
