"""A controller of a simulation, out of the arguments of a call, and its results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.analysis.results.lazy_arrays import ArraySource
from flexapod.analysis.results.remarks import remark
from flexapod.analysis.results.time_history import Record
from flexapod.common.arguments import integer
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, suggest_word
from flexapod.common.units import quantity

if TYPE_CHECKING:
    from flexapod.control import AdaptiveDamping, Controller, FunctionController, StateSpace
    from flexapod.solve.time.sampled_control import SampledController

    AnyController = Controller | AdaptiveDamping | StateSpace | FunctionController

SUMS = 1e-9  # of a pole from 1, of what it sums: less is none

#: One number for all channels, or numbers by channels (``stroke:1``) and groups (``stroke``).
PerChannel = float | Mapping[str, float] | None
#: The same, or one-sided densities {"psd": unit^2/Hz} in place of numbers.
Noise = float | Mapping[str, float] | Mapping[str, Mapping[str, float]] | None


#: Groups of channels that controllers read and move without being told which.
READ, MOVED = ("stroke", "encoder", "drive-force", "force-sensor:drive"), ("drive", "command")
READ_OF_PLATFORM = ("tool", "com", *(f"{x}:{at}" for x in ("accelerometer", "geophone") for at in ("tool", "com")))


def sampled_controller(
    study: model.Study,
    controller: AnyController | None = None,
    sample: float | str | None = None,
    delay_samples: int | None = None,
    quantise: PerChannel = None,
    saturate: PerChannel = None,
    noise: Noise = None,
    seed: int | None = None,
) -> SampledController | None:
    """The controller of a simulation: that of the call, else that of the study; None without one.

    Parameters
    ----------
    study : Study
    controller : Controller, AdaptiveDamping, StateSpace or Function, optional
        Of `flexapod.control`. It reads at each sample what sensors
        show from what they showed at the start, kinematic ones against the commanded path, and holds its outputs until
        the next, Eqs. (T26.1)-(T26.3).
    sample : float or str, optional
        Time between samples [s], or as ``"5 kHz"``; of fixed steps a multiple.
    delay_samples : int, optional
        Samples from a reading to what is made of it.
    quantise, saturate, noise : float or mapping, optional
        Steps of the readings, largest magnitude of the outputs, standard deviation of the readings' noise: one number,
        or numbers by channel or group. ``{"psd": S}`` in place of a deviation: one-sided [unit^2/Hz], Eq. (T26.4).
    seed : int, optional
        Of the noise: the same seed, the same bits.

    Raises
    ------
    InputError
        Settings without a controller, no period, a delay or limits that are none, a channel that it has not.
    """
    given = {"sample": sample, "delay_samples": delay_samples, "quantise": quantise, "saturate": saturate}
    given |= {"noise": noise, "seed": seed}
    given = {name: value for name, value in given.items() if value is not None}
    if controller is None and study.control is not None:
        controller, own = _of_table(study.control, study.robot)
        key = "sample" if "sample" in given else "control.sample"
        return _made(controller, study.robot, key=key, **(own | given))  # type: ignore[arg-type]
    if controller is None:
        if given:
            raise InputError(
                "is for a controller, and there is none", key=next(iter(given)), next_step="Give controller="
            )
        return None
    return _made(controller, study.robot, **given)  # type: ignore[arg-type]


def _of_table(table: model.Control, robot: model.Robot) -> tuple[AnyController, dict[str, object]]:
    """Controller and settings of a study file."""
    from flexapod.solve.linear.channels import plant_channels

    names = ("sample", "delay_samples", "saturate", "seed", "quantise", "noise")
    found = {name: getattr(table, name, None) for name in names}
    if isinstance(table, model.ToolControl):
        tool = [channel.name for channel in plant_channels(table.reads, robot, "outputs")]
        each = {name: found[name] for name in ("quantise", "noise")}
        found |= {name: None if x is None else dict(zip(tool, x.tolist(), strict=True)) for name, x in each.items()}  # type: ignore[attr-defined]
    if isinstance(table, model.ForceControl):
        found |= {name: {table.reads: found[name]} for name in ("quantise", "noise") if found[name] is not None}
    if isinstance(table, model.FileControl) and table.saturate is not None:
        found["saturate"] = _limit_of_drives(table)
    return _controller_of(table, robot), {name: value for name, value in found.items() if value is not None}


def _limit_of_drives(table: model.FileControl) -> dict[str, float | None]:
    """The largest force of the drives that a law in a file moves."""
    if not any(name.partition(":")[0] == "drive" for name in table.outputs):
        raise InputError(
            "limits forces of drives, and the law in the file moves none",
            key="control.saturate",
            value=table.saturate,
            allowed=f"laws with outputs drive:1 and so on; its own: {', '.join(table.outputs)}",
        )
    return {"drive": table.saturate}


def _controller_of(table: model.Control, robot: model.Robot) -> Controller | StateSpace:
    """The controller that a table describes."""
    from flexapod.control import DVF, IFF, PID, Decoupled, StateSpace, by_jacobian, pid, robot_jacobian

    if isinstance(table, model.ForceControl):
        return IFF(
            table.gain, high_pass=table.high_pass, parallel_stiffness=table.parallel_stiffness, sensor=table.reads
        )
    if isinstance(table, model.DampedControl):
        return DVF(table.gain, low_pass=table.low_pass, sensor=table.reads)
    if isinstance(table, model.StrokeControl):
        gains = (table.proportional, table.integral, table.derivative)
        return PID(*gains, low_pass=table.low_pass, sensor=table.reads)
    if isinstance(table, model.ToolControl):
        gains = zip(table.proportional.tolist(), table.integral.tolist(), table.derivative.tolist(), strict=True)
        out = by_jacobian(robot_jacobian(robot, robot.tool)).out
        return Decoupled([pid(*each, table.low_pass) for each in gains], into=np.eye(6), out=out, sensor=table.reads)
    _refuse_unknown(table, robot)
    return StateSpace(
        A=table.A, B=table.B, C=table.C, D=table.D, inputs=table.inputs, outputs=table.outputs,
        states=tuple(f"law x{i + 1}" for i in range(len(table.A))), units={}, sample=table.own,
    )  # fmt: skip


def _refuse_unknown(table: model.FileControl, robot: model.Robot) -> None:
    """Refuse channels of a law in a file that the robot has not, with the nearest."""
    from flexapod.solve.linear.channels import plant_channels

    for name, known, channels in (("inputs", "outputs", table.inputs), ("outputs", "inputs", table.outputs)):
        for channel in channels:
            try:
                plant_channels(channel, robot, known)
            except InputError as error:
                error.key = name
                raise error.with_location(file=table.file) from None


def _made(
    controller: AnyController,
    robot: model.Robot,
    *,
    sample: float | str | None = None,
    delay_samples: int = 0,
    quantise: PerChannel = None,
    saturate: PerChannel = None,
    noise: Noise = None,
    seed: int = 0,
    key: str = "sample",
) -> SampledController:
    """A controller with all settings; `key`: where its time between samples is given."""
    from flexapod.control import StateSpace
    from flexapod.solve.time.sampled_control import SampledController

    period = _period(controller, sample)
    delay_samples, seed = integer(delay_samples, "delay_samples", 0, 1000), integer(seed, "seed", 0, 2**31 - 1)
    law = _law(controller, period, robot)
    inputs, outputs = tuple(law.inputs), tuple(law.outputs)
    for which, names in (("inputs", inputs), ("outputs", outputs)):
        if not names or len(set(names)) < len(names):
            raise InputError("are none, or one of them twice", key=f"controller.{which}", value=", ".join(names))
    matrices = {name: getattr(law, name) for name in "ABCD"} if isinstance(law, StateSpace) else {}
    return SampledController(
        readings=inputs,
        outputs=outputs,
        period=period,
        function=None if isinstance(law, StateSpace) else law.function,
        delay_samples=delay_samples,
        quantum=_by_channel(quantise, inputs, "quantise", 0.0),
        most=_by_channel(saturate, outputs, "saturate", np.inf),
        sigma=_by_channel(_sigmas(noise, period), inputs, "noise", 0.0),
        seed=seed,
        key=key,
        **matrices,
    )


def _period(controller: AnyController, sample: float | str | None) -> float:
    """Time between samples [s]: as given, or that of a law that has one."""
    from flexapod.control import StateSpace
    from flexapod.control.discretization import period_of

    own = controller.sample if isinstance(controller, StateSpace) else None
    period = own if sample is None else period_of(sample)
    if period is None:
        raise InputError("is missing", key="sample", allowed='a time [s], or a rate as "5 kHz"')
    if own is not None and abs(own - period) > 1e-9 * period:
        raise InputError(
            "is not the time between its samples", key="sample", value=period, allowed=f"{own:.6g} s, that of the law"
        )
    return float(period)


def _law(controller: AnyController, period: float, robot: model.Robot) -> StateSpace | FunctionController:
    """Sampled law or function that is computed at each sample."""
    from flexapod.control import AdaptiveDamping, Controller, FunctionController, Scheduled, StateSpace
    from flexapod.solve.linear.channels import plant_channels

    if isinstance(controller, StateSpace):
        return controller if controller.sample is not None else controller.sampled(period)
    if isinstance(controller, Controller | AdaptiveDamping):
        read, moved = (
            [channel.name for group in groups for channel in plant_channels(group, robot, key)]
            for groups, key in ((READ + READ_OF_PLATFORM * (not robot.platform_fixed), "outputs"), (MOVED, "inputs"))
        )
        return controller.sampled(period, read, moved)
    if not isinstance(controller, FunctionController):
        raise InputError(
            "is no controller",
            key="controller",
            value=type(controller).__name__,
            allowed="one of flexapod.control, a StateSpace, or a flexapod.control.FunctionController",
            next_step="Of a Scheduled: its .following(...) a path" if isinstance(controller, Scheduled) else None,
        )
    return controller


def _sigmas(noise: object, period: float) -> PerChannel:
    """Standard deviations out of these, or out of one-sided densities {"psd": unit^2/Hz}, Eq. (T26.4)."""

    def sigma(given: object) -> object:
        if isinstance(given, Mapping) and set(given) == {"psd"}:
            return float(np.sqrt(quantity(given["psd"], "number", key="noise.psd") / (2 * period)))
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
            raise InputError(
                "is no channel of this controller",
                key=key,
                value=name,
                allowed=", ".join(names),
                next_step=suggest_word(name, names),
            )
        if value is not None:
            unlimited = isinstance(value, float) and value == without
            found[which] = value if unlimited else quantity(value, "number", key=key)
    if not (found >= 0).all():
        raise InputError("is below 0", key=key, value=given)
    return found


def control_remarks(sampled: SampledController | None) -> tuple[str, ...]:
    """Doubt about a controller: one that sums forces alone leaves no stiffness at rest."""
    if sampled is None or sampled.function is not None or not len(sampled.A):
        return ()
    values, left = np.linalg.eig(sampled.A.T)
    summed = np.abs(left[:, np.abs(values - 1) < SUMS].T @ sampled.B) > SUMS
    forces = [name.startswith(("force-sensor:", "drive-force:", "joint-force:")) for name in sampled.readings]
    if not (summed.any(axis=1) & ~summed[:, ~np.array(forces)].any(axis=1)).any():
        return ()
    return (remark("summed forces"),)


def control_results(sampled: SampledController | None, record: Record) -> dict[str, ArraySource]:
    """Readings and outputs of a controller at the stored instants, and its work; empty without one."""
    if sampled is None:
        return {}
    read = len(sampled.readings)
    return {
        "sensor_reading": record.control[:, :read],
        "control_input": record.control[:, read:-1],
        "work_control": record.control[:, -1],
    }


def control_attributes(sampled: SampledController | None) -> dict[str, object]:
    """Time between its samples [s], their delay, and the seed of its noise."""
    if sampled is None:
        return {}
    return {
        "control_sample": sampled.period,
        "control_delay_samples": sampled.delay_samples,
        "control_seed": sampled.seed,
    }


def control_coords(sampled: SampledController | None) -> dict[str, list[str]]:
    """Names of its channels."""
    return {} if sampled is None else {"sensor": list(sampled.readings), "actuator": list(sampled.outputs)}
