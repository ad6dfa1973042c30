"""Limits of the paper's study and future work that it names, computed on its own robot.

Feedforward commands, a shaped roll, feedback of forces, friction of joints, tolerances and floor vibration.
Values that the paper does not give are ours, here as constants.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

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
from flexapod.verification.paper.claim import axis_motion, residual_vibration
from flexapod.verification.paper.variants import with_legs

#: Words for commands that make up for more and more, and the orders of `compensate` that do.
COMMANDS: dict[str, Literal[0, 2, "stable-inversion"] | None] = {
    "as it is": None,
    "weight": 0,
    "weight and inertia": 2,
    "weight, inertia and modes": "stable-inversion",
}
SHAPER, SHAPED_MODES = "zv", (1, 6)  # of the payload and of the legs, from the lowest on
MODES = 3  # of the payload, below the first bending of the legs
GAIN, CORNER = 100.0, 0.5  # of the feedback [1/s], and what it leaves to the drives: below that [Hz]
SAMPLE = 1e-4  # s
DRIVE_DAMPING = 1e3  # N s/m, of drives as stiff as the pistons: a thousandth of the critical one and less
BLOW, BLOW_START, BLOW_TIME = 100.0, 0.05, 0.01  # N down on the payload, half a sine from an instant on [s]
RING = 0.6  # s
HZ = np.geomspace(2.0, 300.0, 600)
FRICTION = model.JointFriction(mu=0.1, diameter=0.04)  # plain joints: 0.02 to 0.25
TOLERANCES = model.Tolerances(
    base_joints=model.LengthSpread(sigma=20e-6),
    platform_joints=model.LengthSpread(sigma=20e-6),
    leg_offset=model.LengthSpread(sigma=10e-6),
    EA=model.RatioSpread(sigma=0.02),
    EI=model.RatioSpread(sigma=0.02),
    density=model.RatioSpread(sigma=0.01),
    bow=model.LengthSpread(sigma=0.3e-3),
)
MATERIAL = ("EA", "EI", "density", "bow")  # of these: what is of the pistons themselves
DRAWS = 1000
FLOOR = "VC-C"
_METRE, _SECOND = {"units": "m"}, {"units": "s"}


def _roll() -> model.Study:
    return model.preset("paper-robot")


def _stacked(
    rows: Mapping[str, np.ndarray], dim: str, *more: str
) -> tuple[tuple[str, ...], np.ndarray, dict[str, str]]:
    """Lengths of several cases as a variable."""
    return (dim, *more), np.stack(list(rows.values())), _METRE


def commands_ahead(report: Share) -> Dataset:
    """Path error of the payload under feedforward commands that compensate more and more of what is known.

    Returns
    -------
    xarray.Dataset
        Over `command`, as in `COMMANDS`: `miss` (command, time, axis) [m], of the centre of mass beside the path that
        the rigid robot would take by the study's own motion; `miss_peak` (command, axis).
    """
    study, rows = _roll(), {}
    own = simulate(study)
    for name, order in COMMANDS.items():
        data = own if order is None else simulate(compensate(study, order))  # type: ignore[arg-type]
        rows[name] = data.com_position.values - own.com_position_rigid.values
        report(len(rows) / len(COMMANDS))
    peaks = {name: np.abs(miss).max(axis=0) for name, miss in rows.items()}
    values = {
        "miss": _stacked(rows, "command", "time", "axis"),
        "miss_peak": _stacked(peaks, "command", "axis"),
    }
    coords = {"command": list(rows), "time": ("time", own.time.values, _SECOND), "axis": list("xyz")}
    return Dataset(values, coords, attributes(study))


def shaped_roll(report: Share) -> Dataset:
    """Vibration after the roll, as it is and shaped for the lowest modes.

    Returns
    -------
    xarray.Dataset
        Over `command`: `vibration` (command, time, axis) [m] of the centre of mass from the end of the roll on, about
        its mean; `payload_vibration` and `tip_vibration` (command) [m], from peak to peak, the largest along one
        direction; `longer` (command) [s], what the roll takes more.
    """
    study, rows, columns = _roll(), {}, {name: [] for name in ("payload_vibration", "tip_vibration", "longer")}
    hold, own = axis_motion(study).hold, axis_motion(study).end_time
    time = np.arange(0.0, hold - 1e-9, study.simulation.output_step or 1e-3)
    for count in (0, *SHAPED_MODES):
        quiet = shape(study, SHAPER, modes=count) if count else study
        data = simulate(quiet)
        end = motion_end(data) or 0.0
        off = np.stack([np.interp(end + time, data.time, data.com_deviation[:, i]) for i in range(3)], axis=1)
        rows[f"shaped for {count} mode{'s' * (count > 1)}" if count else "as it is"] = off - off.mean(axis=0)
        columns["payload_vibration"].append(residual_vibration(data, "com_deviation"))
        columns["tip_vibration"].append(residual_vibration(data, "tip_deflection"))
        columns["longer"].append(quiet.motion.end_time - own)
        report(len(rows) / (1 + len(SHAPED_MODES)))
    values = {"vibration": _stacked(rows, "command", "time", "axis")} | {
        name: ("command", found, _SECOND if name == "longer" else _METRE) for name, found in columns.items()
    }
    coords = {"command": list(rows), "time": ("time", time, _SECOND), "axis": list("xyz")}
    return Dataset(values, coords, attributes(study))


def with_drives(study: model.Study) -> model.Study:
    """Study at rest on drives as compliant as its pistons: prescribed ones feel nothing."""

    def change_leg(leg: model.Leg) -> model.Leg:
        return leg.replace(drive=model.ServoDrive(stiffness=leg.piston.EA / leg.piston.length, damping=DRIVE_DAMPING))

    return with_legs(study, change_leg).replace(motion=axis_motion(study).replace(amplitude=0.0))


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
    study, law = with_drives(_roll()), IFF(GAIN, high_pass=CORNER)
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
        "ringing": _stacked(rows, "loop", "time", "axis"),
        "compliance": (("loop", "frequency"), np.array(sizes), {"units": "m N-1"}),
        "mode_frequency": (("loop", "mode"), frequency, {"units": "Hz"}),
        "damping_ratio": (("loop", "mode"), damping, {"units": "1"}),
    }
    coords = {
        "loop": list(rows), "time": ("time", time, _SECOND), "axis": list("xyz"),
        "frequency": ("frequency", HZ, {"units": "Hz"}), "mode": np.arange(1, MODES + 1),
    }  # fmt: skip
    return Dataset(values, coords, attributes(study))


def with_friction(study: model.Study) -> model.Study:
    """Study with plain joints that have friction at both ends of its legs."""

    def change_leg(leg: model.Leg) -> model.Leg:
        base, platform = (joint.replace(friction=FRICTION) for joint in (leg.base_joint, leg.platform_joint))
        return leg.replace(base_joint=base, platform_joint=platform)

    return with_legs(study, change_leg)


def joint_friction(report: Share) -> Dataset:
    """Roll with ideal joints, with friction in joints, and with friction and feedforward without knowledge of it.

    Returns
    -------
    xarray.Dataset
        Over `joints`: `miss` (joints, time, axis) [m] of the centre of mass beside its rigid path, `lost` (joints) [J]
        in damping and friction.
    """
    study = _roll()
    rubbing, ahead = with_friction(study), compensate(study, 2)
    cases = {"ideal": study, "friction": rubbing, "friction, commands ahead": rubbing.replace(motion=ahead.motion)}
    rows, lost, own = {}, [], simulate(study)
    for name, case in cases.items():
        data = simulate(case) if rows else own
        rows[name] = data.com_position.values - own.com_position_rigid.values
        lost.append(float(data.energy_dissipated[-1]))
        report(len(rows) / len(cases))
    values = {"miss": _stacked(rows, "joints", "time", "axis"), "lost": ("joints", lost, {"units": "J"})}
    coords = {"joints": list(rows), "time": ("time", own.time.values, _SECOND), "axis": list("xyz")}
    return Dataset(values, coords, attributes(rubbing))


def _as_made() -> model.Study:
    """Study with tolerances, friction in joints and a vibrating floor."""
    study = with_friction(_roll())
    return study.replace(
        robot=study.robot.replace(tolerances=TOLERANCES),
        disturbance=model.Disturbance(floor=model.Floor.by_curve(FLOOR)),
    )


def tolerances(_: Share) -> Dataset:
    """Spread of the payload's place at home by tolerances, to first order and of random draws (`accuracy`)."""
    return accuracy(_as_made(), draws=DRAWS, seed=1)


def error_budget(_: Share) -> Dataset:
    """Error budget at home of the robot with tolerances, friction and floor vibration (`budget`)."""
    return budget(_as_made())
