"""A controller of a simulation, out of the arguments of a call, and its results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from flexapod.arrays import Array
from flexapod.errors import InputError, nearest
from flexapod.results.asked import Made
from flexapod.results.record import Record
from flexapod.solve.time.sampled import Sampled

__all__ = ["Controller", "PerChannel", "Reads", "control_coords", "control_results", "sampled_controller"]

#: One number for all channels, or numbers by channels (``stroke:1``) and groups (``stroke``).
PerChannel = float | Mapping[str, float] | None


class Linear(Protocol):
    """A linear system from sample to sample, as `flexapod.control.StateSpace`."""

    A: Array
    B: Array
    C: Array
    D: Array
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    sample: float | None


@runtime_checkable
class Reads(Protocol):
    """What becomes a linear system from sample to sample, as the controllers of `flexapod.control`."""

    def sampled(self, period: float) -> Linear:
        """The law for samples a period [s] apart."""
        ...


@runtime_checkable
class Called(Protocol):
    """A function in place of a linear law, and the channels that it reads and moves."""

    function: Callable[[float, Array], object]
    inputs: Sequence[str]
    outputs: Sequence[str]


Controller = Reads | Called | Linear


def sampled_controller(
    controller: Controller | None,
    sample: float | None,
    *,
    delay_samples: int = 0,
    quantise: PerChannel = None,
    saturate: PerChannel = None,
    noise: PerChannel | Mapping[str, Mapping[str, float]] = None,
    seed: int = 0,
) -> Sampled | None:
    """The controller of a call, see `flexapod.simulate`; None without one.

    Raises
    ------
    InputError
        Settings without a controller, no period, a delay or limits that are none, a channel that it has not.
    """
    settings = {"sample": sample, "quantise": quantise, "saturate": saturate, "noise": noise}
    settings |= {"delay_samples": delay_samples or None}
    if controller is None:
        if given := [name for name, value in settings.items() if value is not None]:
            raise InputError("is for a controller, and there is none", key=given[0], next_step="Give controller=")
        return None
    period = sample if sample is not None else getattr(controller, "sample", None)
    if period is None or not (np.isfinite(period) and period > 0):
        raise InputError(
            "is not a time between samples", key="sample", value=sample, allowed="above 0 s, as 2e-4 for 5 kHz"
        )
    if not isinstance(delay_samples, int) or delay_samples < 0:
        raise InputError("is no number of samples", key="delay_samples", value=delay_samples, allowed="0, 1, 2, ...")
    law = _law(controller, period)
    inputs, outputs = tuple(law.inputs), tuple(law.outputs)
    for key, names in (("controller.inputs", inputs), ("controller.outputs", outputs)):
        if not names or len(set(names)) < len(names):
            raise InputError("are none, or one of them twice", key=key, value=", ".join(names))
    function = getattr(law, "function", None)
    matrices = {} if function else {name: np.asarray(getattr(law, name), dtype=float) for name in "ABCD"}
    return Sampled(
        readings=inputs,
        outputs=outputs,
        period=float(period),
        function=function,
        delay_samples=delay_samples,
        quantum=_by_channel(quantise, inputs, "quantise", 0.0),
        most=_by_channel(saturate, outputs, "saturate", np.inf),
        sigma=_by_channel(_sigmas(noise, period), inputs, "noise", 0.0),
        seed=seed,
        **matrices,
    )


def _law(controller: Controller, period: float) -> Linear | Called:
    """What is computed at each sample."""
    found = controller
    if isinstance(controller, Reads) and not isinstance(controller, Called) and getattr(found, "sample", None) is None:
        found = controller.sampled(period)
    if isinstance(found, Called):
        return found
    own = getattr(found, "sample", None)
    if not all(hasattr(found, name) for name in ("A", "B", "C", "D", "inputs", "outputs")) or own is None:
        raise InputError(
            "is no controller from sample to sample",
            key="controller",
            value=type(controller).__name__,
            allowed="one of flexapod.control, a StateSpace with a sample time, or a flexapod.control.Function",
        )
    if abs(own - period) > 1e-9 * period:
        raise InputError(
            "is not the time between its samples", key="sample", value=period, allowed=f"{own:.6g} s, that of the law"
        )
    return found  # type: ignore[return-value]


def _sigmas(noise: object, period: float) -> PerChannel:
    """Standard deviations out of these, or out of one-sided densities {"psd": unit^2/Hz}, Eq. (T26.4)."""

    def sigma(given: object) -> object:
        if isinstance(given, Mapping) and set(given) == {"psd"}:
            return float(np.sqrt(given["psd"] / (2 * period)))
        return given

    if isinstance(noise, Mapping) and set(noise) != {"psd"}:
        return {name: sigma(value) for name, value in noise.items()}  # type: ignore[misc]
    return sigma(noise)  # type: ignore[return-value]


def _by_channel(given: PerChannel, names: Sequence[str], key: str, without: float) -> Array:
    """A number for each channel; not below 0."""
    found = np.full(len(names), without)
    for name, value in given.items() if isinstance(given, Mapping) else [("", given)]:
        which = [i for i, known in enumerate(names) if not name or known == name or known.startswith(f"{name}:")]
        if not which:
            like = nearest(name, names)
            raise InputError(
                "is no channel of this controller",
                key=key,
                value=name,
                allowed=", ".join(names),
                next_step=None if like is None else f"Did you mean {like!r}?",
            )
        if value is not None:
            found[which] = value
    if not (found >= 0).all():
        raise InputError("is below 0, or no number", key=key, value=given)
    return found


def control_results(sampled: Sampled | None, record: Record) -> dict[str, Made]:
    """What a controller read and held at the stored instants, and its work; nothing without one."""
    if sampled is None:
        return {}
    read = len(sampled.readings)
    return {
        "sensor_reading": record.control[:, :read],
        "control_input": record.control[:, read:-1],
        "work_control": record.control[:, -1],
    }


def control_coords(sampled: Sampled | None) -> dict[str, list[str]]:
    """Names of its channels."""
    return {} if sampled is None else {"sensor": list(sampled.readings), "actuator": list(sampled.outputs)}
