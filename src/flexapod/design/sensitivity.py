"""Sensitivities of a study: per cent of its outputs for a per cent of its numbers, by differences of whole calls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flexapod.analysis.results.arguments import PoseLike, RobotLike, as_study
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.time_history import check_progress
from flexapod.analysis.results.variables import Variable, dataset
from flexapod.analysis.scalar_outputs import DEFAULTS, OUTPUTS, StudyValues, check_output
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError, InputError, names_of
from flexapod.common.resources import one_thread
from flexapod.design.variants import KeyNumber, Variants
from flexapod.model import Study
from flexapod.solve.modal.structural_damping import hold_loss_frequency

if TYPE_CHECKING:
    from xarray import Dataset

STEP = 1e-3  # relative
POINTS = (-2, -1, 1, 2)  # steps away from the study
ROUNDING = 1e-11  # least relative error of a value
TABLES = ("payload", "leg", "tolerances", "heat", "geometry")  # whose numbers are the keys, if none are given
MATTERS = 1e-4  # per cent per per cent, of some output: a key with less is left out, if none are given
CORNER = 1e-3  # of both slopes: what the slopes to both sides may differ by beyond a gradual change
NOISY = 1e-4  # uncertainty from which on no effect is no finding
DOUBLED = ("stiffness", "rotational stiffness", "axial stiffness", "bending stiffness")
ERRORS = ("tolerances", "heat", "geometry")
ERROR_NAMES = ("play", "backlash", "friction")
CORNERS = {"first_frequency": "; equal frequencies part"}
FORMS = {
    "sensitivity": Variable(("key", "output"), "1", "per cent of the output for a per cent of the key"),
    "uncertainty": Variable(("key", "output"), "1", "of the sensitivity, by rounding and by the steps"),
    "factor": Variable(("key",), "1", "by which the key is multiplied for `factor_effect`"),
    "factor_effect": Variable(("key", "output"), "percent", "change of the output, if the key is multiplied by factor"),
    "note": Variable(("key", "output"), "1", "why there is no number, or what it leaves out; empty: nothing"),
    "key_value": Variable(("key",), "mixed", "value of the key, the first of several"),
    "value": Variable(("output",), "mixed", "value of the output"),
    "output_units": Variable(("output",), "1", "unit of the output"),
}


Values = tuple[Array, list[str]]
"""Values at the points beside a study, (4, outputs), and why there are none at some."""


class Found(NamedTuple):
    """Sensitivity, its uncertainty and a note, of one key and one output."""

    slope: float
    uncertainty: float
    note: str


@one_thread()
def sensitivity(
    study: RobotLike,
    keys: Sequence[str] | str | None = None,
    outputs: Sequence[str] | str | None = None,
    pose: PoseLike = None,
    *,
    progress: Callable[[str, float], None] | None = None,
) -> Dataset:
    """Sensitivity of outputs to the numbers of a study: which change brings how much.

    Parameters
    ----------
    study : Study or path
        Of a robot.
    keys : str or sequence of str, optional
        Keys of the study file, ``"leg.piston.diameter"``; default: all numbers that the file gives of payload, legs,
        tolerances, temperatures and geometry, less those that change no output.
    outputs : str or sequence of str, optional
        Names of outputs; default: first frequency, least stiffness, sag and pose accuracies.
    pose : pose, optional
        As for `modes`; default home.
    progress : callable, optional
        Told in words what is done, and its share.

    Returns
    -------
    xarray.Dataset
        Along `key` and `output`: `sensitivity`, per cent for a per cent, and its `uncertainty`; `factor_effect` [%] of
        halving an error or doubling a stiffness (`factor` of the key); `note` of what has no such number, where the
        other variables are NaN, or of what it leaves out. Temperatures count from the reference. Frequencies at which
        loss factors hold are kept.

    Raises
    ------
    InputError
        A key that is no number, an output that does not exist or has no derivative, a pose out of reach.
    ComputationError
        The study has no equilibrium at the pose.

    Examples
    --------
    >>> data = fx.sensitivity(fx.preset("machine-hexapod"), "payload.mass", "static_deviation_size")
    >>> print(data.sensitivity.values.round(2).item())
    -0.52
    """
    check_progress(progress)
    whole = as_study(study)
    if whole.robot.platform_fixed:
        raise InputError("has a platform that is fixed: its tool does not move", key="study")
    names, variants = check_outputs(outputs), Variants(whole)
    given = None if keys is None else list(dict.fromkeys(names_of(keys, "keys")))
    asked = variants.written_keys(TABLES) if given is None else given
    numbers = {key: variants.numbers(key) for key in asked}
    with hold_loss_frequency(whole.robot, whole.simulation):
        base = _row(whole, names, pose)
        rows: dict[str, Values] = {}
        for k, key in enumerate(asked):
            if progress is not None:
                progress(key, k / len(asked))
            rows[key] = _rows(variants, numbers[key], names, pose)
        factors = {key: _factor(key, numbers[key]) for key in asked}
        effects = {key: _effect(variants, numbers[key], names, pose, base, factors[key]) for key in asked}
    found = _judged(base, rows, names, numbers)
    if given is None:
        asked = [key for key in asked if _matters(found[key])]
    return _described(whole, names, base, asked, found, factors, effects, numbers)


def check_outputs(outputs: Sequence[str] | str | None) -> list[str]:
    """Names of outputs that have derivatives.

    Raises
    ------
    InputError
        No output of that name, or one that has no derivative.
    """
    names: list[str] = [*DEFAULTS] if outputs is None else list(dict.fromkeys(names_of(outputs, "outputs")))
    for name in names:
        check_output(name)
        if OUTPUTS[name].smooth:
            other = name.replace("_peak", "_rms")
            hint = f"Take {other}" if other != name and other in OUTPUTS else "Compare values: flexapod sweep"
            raise InputError(f"has no derivative: {OUTPUTS[name].smooth}", key="outputs", value=name, next_step=hint)
    return names


def _row(study: Study, names: Sequence[str], pose: PoseLike) -> Array:
    found = StudyValues(study, pose).values(names)
    return np.array([found[name] for name in names])


def _scaled(variants: Variants, numbers: Sequence[KeyNumber], factor: float) -> Study:
    return variants.study_with({number.steps: number.times(factor) for number in numbers})


def _rows(variants: Variants, numbers: Sequence[KeyNumber], names: Sequence[str], pose: PoseLike) -> Values:
    """Values at the points beside the study, (4, outputs), NaN where there are none, and the reasons."""
    rows, reasons = np.full((len(POINTS), len(names)), np.nan), []
    for k, point in enumerate(POINTS if numbers else ()):
        try:
            rows[k] = _row(_scaled(variants, numbers, 1 + point * STEP), names, pose)
        except FlexapodError as error:
            reasons.append(str(error).splitlines()[0])
    return rows, reasons


def _factor(key: str, numbers: Sequence[KeyNumber]) -> float:
    """Half of an error, twice a stiffness; NaN of anything else."""
    parts = key.replace("[", ".").split(".")
    if parts[0] in ERRORS or any(word in parts[-1] or word in parts for word in ERROR_NAMES):
        return 0.5
    return 2.0 if numbers and numbers[0].dimension in DOUBLED else np.nan


def _effect(
    variants: Variants, numbers: Sequence[KeyNumber], names: Sequence[str], pose: PoseLike, base: Array, factor: float
) -> Array:
    """Change of the outputs [%] if the key is multiplied by a factor; NaN without one, and out of reach."""
    none = np.full(len(names), np.nan)
    if not numbers or not np.isfinite(factor):
        return none
    try:
        found = _row(_scaled(variants, numbers, factor), names, pose)
    except FlexapodError:
        return none
    return np.divide(100 * (found - base), np.abs(base), out=none, where=base != 0)


def _judged(
    base: Array, rows: Mapping[str, Values], names: Sequence[str], numbers: Mapping[str, Sequence[KeyNumber]]
) -> dict[str, list[Found]]:
    """Sensitivities of all keys; the rounding of an output is that of most of its keys at least."""
    usual = np.zeros(len(names))
    for j in range(len(names)):
        gradual = [values[:, j] for values, _ in rows.values() if not _has_corner(values[:, j], base[j])]
        known = [rest for f in gradual if np.isfinite(rest := _fourth(f, base[j])) and rest > 0]
        usual[j] = np.median(known) if known else 0.0
    found: dict[str, list[Found]] = {}
    for key, (values, reasons) in rows.items():
        columns = enumerate(zip(names, base.tolist(), usual.tolist(), strict=True))
        found[key] = [
            _one(values[:, j], f0, rest, reasons, bool(numbers[key]), CORNERS.get(name, ""))
            for j, (name, f0, rest) in columns
        ]
    return found


def _fourth(f: Array, f0: float) -> float:
    """Size of the fourth difference, which is rounding where the output changes gradually."""
    return abs(float(f[0] + f[3] - 4 * (f[1] + f[2]) + 6 * f0))


def _has_corner(f: Array, f0: float) -> bool:
    """Tell whether slopes to both sides differ: second differences then grow with the step, not with its square."""
    bend, wider = f[1] + f[2] - 2 * f0, f[0] + f[3] - 2 * f0
    sharp = abs(bend) > CORNER * (abs(f[2] - f0) + abs(f0 - f[1]))
    return bool(sharp and abs(wider - 4 * bend) > abs(bend) > 1e-10 * abs(f0))


def _one(f: Array, f0: float, rest: float, reasons: Sequence[str], given: bool, where: str) -> Found:
    """Derivative of fourth order by four values beside one, and how sure it is.

    The fourth difference is rounding, unless there is a corner; the other orders tell what the step does.
    """
    if not given:
        return Found(np.nan, np.nan, "the key is 0, or what temperatures count from: it has no per cent")
    if reasons:
        return Found(np.nan, np.nan, f"a gap: {reasons[0]}")
    if not (np.isfinite(f).all() and np.isfinite(f0)):
        return Found(np.nan, np.nan, "the output has no value")
    if f0 == 0:
        return Found(np.nan, np.nan, "the output is 0: it has no per cent")
    narrow, wide = (f[2] - f[1]) / (2 * STEP), (f[3] - f[0]) / (4 * STEP)
    slope = narrow + (narrow - wide) / 3
    right, left = (f[2] - f0) / STEP, (f0 - f[1]) / STEP
    size, error = abs(f0), max(rest, _fourth(f, f0), ROUNDING * abs(f0))
    if _has_corner(f, f0):
        words = f"a corner: {right / size:+.3g} % upwards, {-left / size:+.3g} % downwards for a per cent{where}"
        return Found(np.nan, np.nan, words)
    off = abs(slope - narrow)
    step = off * off / abs(slope) if slope and off < abs(slope) else off
    uncertainty = (1.5 * error / (12 * STEP) + step + STEP * off) / size
    note = ""
    if abs(slope) / size < 3 * uncertainty:
        note = "no effect" if uncertainty < NOISY else f"lost in rounding: within {3 * uncertainty:.2g}"
        if abs(f[1] + f[2] - 2 * f0) > 100 * error:
            note = "zero by symmetry: the effect is of second order"
    return Found(slope / size, uncertainty, note)


def _matters(found: Sequence[Found]) -> bool:
    return any(one.note.startswith(("a gap", "a corner", "lost")) or abs(one.slope) > MATTERS for one in found)


def _described(
    study: Study, names: Sequence[str], base: Array, keys: Sequence[str], found: Mapping[str, Sequence[Found]],
    factors: Mapping[str, float], effects: Mapping[str, Array], numbers: Mapping[str, Sequence[KeyNumber]],
) -> Dataset:  # fmt: skip
    shape = (len(keys), len(names))
    values = {
        "sensitivity": np.array([[one.slope for one in found[key]] for key in keys]).reshape(shape),
        "uncertainty": np.array([[one.uncertainty for one in found[key]] for key in keys]).reshape(shape),
        "factor": np.array([factors[key] for key in keys]),
        "factor_effect": np.array([effects[key] for key in keys]).reshape(shape),
        "note": np.array([[one.note for one in found[key]] for key in keys], dtype=str).reshape(shape),
        "key_value": np.array([numbers[key][0].value if numbers[key] else 0.0 for key in keys]),
        "value": base,
        "output_units": np.array([OUTPUTS[name].units for name in names]),
    }
    return dataset(
        values, {"key": np.array(keys, dtype=str), "output": list(names)}, attributes(study, study.warnings), FORMS
    )
