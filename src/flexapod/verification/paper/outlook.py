"""Limits of the paper's study and future work that it names, computed on its own robot.

Feedforward commands, a shaped roll, feedback of forces, friction of joints, tolerances and floor vibration.
Values that the paper does not give are ours, here as constants.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from xarray import Dataset

from flexapod import model
from flexapod.analysis.error_budget import budget
from flexapod.analysis.linear import linearize
from flexapod.analysis.pose_errors.pose_accuracy import accuracy
from flexapod.analysis.results.attributes import attributes, motion_end
from flexapod.analysis.results.time_history import Share
from flexapod.analysis.simulation import simulate
from flexapod.commissioning.feedforward import compensate, shape
from flexapod.control.controllers import IFF
from flexapod.verification.paper.claim import axis_motion
from flexapod.verification.paper.trials import trial_columns
from flexapod.verification.paper.variants import Variant, VariantTable, compare

#: Commands that make up for more and more.
COMMANDS = {
    "as it is": Variant(),
    "weight": Variant(change=partial(compensate, order=0)),
    "weight and inertia": Variant(change=partial(compensate, order=2)),
    "weight, inertia and modes": Variant(change=partial(compensate, order="stable-inversion")),
}
SHAPER, SHAPED_MODES = "zv", (1, 6)  # of the payload and of the legs, from the lowest on
MODES = 3  # of the payload, below the first bending of the legs
GAIN, CORNER = 100.0, 0.5  # of the feedback [1/s], and what it leaves to the drives: below that [Hz]
SAMPLE = 1e-4  # s
DRIVE_DAMPING = 1e3  # N s/m, of drives as stiff as the pistons: a thousandth of the critical one and less
BLOW, BLOW_START, BLOW_TIME = 100.0, 0.05, 0.01  # N down on the payload, half a sine from an instant on [s]
RING = 0.6  # s
HZ = np.geomspace(2.0, 300.0, 600)
FRICTION = {"mu": 0.1, "diameter": 0.04}  # plain joints: 0.02 to 0.25
TOLERANCES = {
    "base_joints": 20e-6, "platform_joints": 20e-6, "leg_offset": 10e-6,
    "EA": 0.02, "EI": 0.02, "density": 0.01, "bow": 0.3e-3,
}  # fmt: skip
MATERIAL = ("EA", "EI", "density", "bow")  # of these: what is of the pistons themselves
DRAWS = 1000
FLOOR = "VC-C"
RUBBING = {f"leg.{end}_joint.friction": FRICTION for end in ("base", "platform")}


def _know_no_friction(study: model.Study) -> model.Study:
    """Study with commands ahead of time of the robot with ideal joints."""
    return study.replace(motion=compensate(model.preset("paper-robot"), 2).motion)


JOINTS = {
    "ideal": Variant(),
    "friction": Variant(values=RUBBING),
    "friction, commands ahead": Variant(values=RUBBING, change=_know_no_friction),
}
#: With tolerances, friction in joints and a vibrating floor.
AS_MADE = Variant(values={**RUBBING, "tolerances": TOLERANCES, "disturbance.floor": FLOOR})
_SECOND = {"units": "s"}


def _compare_paths(along: str, variants: Mapping[str, Variant], columns: Sequence[str], report: Share) -> Dataset:
    """Table of variants by the way of the payload beside the path that the rigid robot takes by the preset's motion."""
    own = simulate(model.preset("paper-robot"))

    def beside_path(study: model.Study, _: Sequence[str], __: float | None) -> dict[str, Any]:
        data = own if study.source_text == own.attrs["study"] else simulate(study)
        miss = data.com_position.values - own.com_position_rigid.values
        lost = float(data.energy_dissipated[-1])
        return {"miss": miss, "miss_peak": np.abs(miss).max(axis=0), "lost": lost}

    table = VariantTable(
        along={along: list(variants)},
        variants=list(variants.values()),
        columns=columns,
        shows=beside_path,
        step=None,
        coords={"time": ("time", own.time.values, _SECOND)},
    )
    return compare(table, report)


def commands_ahead(report: Share) -> Dataset:
    """Path error of the payload under feedforward commands that compensate more and more of what is known.

    Returns
    -------
    xarray.Dataset
        Over `command`, as in `COMMANDS`: `miss` (command, time, axis) [m], of the centre of mass beside the path that
        the rigid robot would take by the study's own motion; `miss_peak` (command, axis).
    """
    return _compare_paths("command", COMMANDS, ("miss", "miss_peak"), report)


def shaped_roll(report: Share) -> Dataset:
    """Vibration after the roll, as it is and shaped for the lowest modes.

    Returns
    -------
    xarray.Dataset
        Over `command`: `vibration` (command, time, axis) [m] of the centre of mass from the end of the roll on, about
        its mean; `payload_vibration` and `tip_vibration` (command) [m], from peak to peak, the largest along one
        direction; `longer` (command) [s], what the roll takes more.
    """
    study = model.preset("paper-robot")
    own, counts = axis_motion(study), (0, *SHAPED_MODES)
    time = np.arange(0.0, own.hold - 1e-9, study.simulation.output_step or 1e-3)

    def after_roll(quiet: model.Study, columns: Sequence[str], _: float | None) -> dict[str, Any]:
        data = simulate(quiet)
        end = motion_end(data) or 0.0
        off = np.stack([np.interp(end + time, data.time, data.com_deviation[:, i]) for i in range(3)], axis=1)
        own_columns = {"vibration": off - off.mean(axis=0), "longer": quiet.motion.end_time - own.end_time}
        return trial_columns(data, columns) | own_columns

    table = VariantTable(
        along={"command": [f"shaped for {n} mode{'s' * (n > 1)}" if n else "as it is" for n in counts]},
        variants=[Variant(change=partial(shape, kind=SHAPER, modes=n) if n else None) for n in counts],
        columns=("vibration", "payload_vibration", "tip_vibration", "longer"),
        shows=after_roll,
        step=None,
        coords={"time": ("time", time, _SECOND)},
    )
    return compare(table, report)


def joint_friction(report: Share) -> Dataset:
    """Roll with ideal joints, with friction in joints, and with friction and feedforward without knowledge of it.

    Returns
    -------
    xarray.Dataset
        Over `joints`: `miss` (joints, time, axis) [m] of the centre of mass beside its rigid path, `lost` (joints) [J]
        in damping and friction.
    """
    return _compare_paths("joints", JOINTS, ("miss", "lost"), report)


def _at_rest() -> model.Study:
    """Study at rest on drives as compliant as its pistons: prescribed ones feel nothing."""
    piston = model.preset("paper-robot").robot.legs[0].piston
    drive = {"type": "servo", "stiffness": piston.EA / piston.length, "damping": DRIVE_DAMPING}
    return Variant(values={"leg.drive": drive, "motion.amplitude": 0}).study


def _struck(study: model.Study) -> model.Study:
    """Study with a blow from above on its payload."""
    share = np.linspace(0.0, 1.0, 21)
    time = np.concatenate([[0.0], BLOW_START + BLOW_TIME * share, [RING]])
    wrench = np.zeros((len(time), 6))
    wrench[2:-2, 2] = -BLOW * np.sin(np.pi * share[1:-1])
    return study.replace(load=model.Load(wrench=model.CsvWrench(time=time, wrench=wrench)))


def force_feedback(report: Share) -> Dataset:
    """Ringing after a blow, compliance and modes, without and with integral force feedback of each drive.

    Returns
    -------
    xarray.Dataset
        Over `loop`: `ringing` (loop, time, axis) [m] of the centre of mass from its place at rest, by the march with a
        sampled controller; of the linear model `compliance` (loop, frequency) [m/N], the size of the payload's
        upward motion by an upward force, and of its lowest modes `mode_frequency` [Hz], `damping_ratio` (loop, mode).
    """
    study, law = _at_rest(), IFF(GAIN, high_pass=CORNER)
    plant = linearize(study, inputs=["drive", "wrench"], outputs=["tool", "force-sensor:drive"])
    loops = {"open": plant, "force feedback": plant.close(law)}
    report(0.3)
    rows, sizes, lowest, time = {}, [], [], np.zeros(0)
    for name, loop in loops.items():
        closed = {} if name == "open" else {"controller": law, "sample": SAMPLE}
        data = simulate(_struck(study), duration=RING, step=SAMPLE, **closed)  # type: ignore[arg-type]
        rows[name], time = (data.com_position - data.com_position[0]).values, data.time.values
        sizes.append(np.abs(loop.select("wrench:fz", "tool:z").at(HZ)).ravel())
        found = loop.damp()
        found = found.isel(mode=np.flatnonzero(found.damping_ratio.values < 1)[:MODES])
        lowest.append((found.frequency.values, found.damping_ratio.values))
        report(0.3 + 0.35 * len(rows))
    frequency, damping = np.transpose(lowest, (1, 0, 2))
    values = {
        "ringing": (("loop", "time", "axis"), np.stack(list(rows.values())), {"units": "m"}),
        "compliance": (("loop", "frequency"), np.array(sizes), {"units": "m N-1"}),
        "mode_frequency": (("loop", "mode"), frequency, {"units": "Hz"}),
        "damping_ratio": (("loop", "mode"), damping, {"units": "1"}),
    }
    coords = {
        "loop": list(rows), "time": ("time", time, _SECOND), "axis": list("xyz"),
        "frequency": ("frequency", HZ, {"units": "Hz"}), "mode": np.arange(1, MODES + 1),
    }  # fmt: skip
    return Dataset(values, coords, attributes(study))


def tolerances(_: Share) -> Dataset:
    """Spread of the payload's place at home by tolerances, to first order and of random draws (`accuracy`)."""
    return accuracy(AS_MADE.study, draws=DRAWS, seed=1)


def error_budget(_: Share) -> Dataset:
    """Error budget at home of the robot with tolerances, friction and floor vibration (`budget`)."""
    return budget(AS_MADE.study)
