"""The one table of result names: dimensions, unit and meaning of every variable of a Dataset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from flexapod.analysis.results.cause_labels import CAUSES
from flexapod.analysis.results.lazy_arrays import LazyArrays
from flexapod.common.lazy_imports import load_module

if TYPE_CHECKING:
    from xarray import Dataset


class Variable(NamedTuple):
    """Dimensions, unit and long name of a result."""

    dims: tuple[str, ...]
    units: str
    long_name: str


#: Labels of all angles that a leg may have: of a crank, at the base, about the leg, at the platform.
ANGLES = ("carriage", "alpha", "beta", "spin", "gamma1", "gamma2", "gamma3")

_TWIST = ["x", "y", "z", "rx", "ry", "rz"]
#: Labels of dimensions that have fixed ones, with what they stand for.
COORDINATES: dict[str, tuple[list[str], str]] = {
    "axis": (list("xyz"), "world axis"),
    "direction": (list("ab"), "lateral direction of the leg"),
    "quaternion": (list("wxyz"), "component of the quaternion"),
    "cause": (list(CAUSES), "cause of a leg's length error"),
    "end": (["base", "platform"], "end of the leg"),
    "bushing": (["gland", "head"], "bushing: in the cylinder's mouth, on the piston's inner end"),
    "joint_angle": (["alpha", "beta"], "angle of a joint"),
    "component": (_TWIST, "translation along and rotation about the world axes"),
    "component_b": (_TWIST, "translation along and rotation about the world axes"),
    "wrench": (["Fx", "Fy", "Fz", "Mx", "My", "Mz"], "force and moment, world axes"),
    "state": (["uncalibrated", "calibrated"], "whether the controller knows the errors of the machine"),
    "plane_axis": (list("XY"), "axis in the plane of motion"),
}

_TA, _TL, _T = ("time", "axis"), ("time", "leg"), ("time",)

_PATH = {
    "com_position_rigid": Variable(_TA, "m", "centre of mass of the payload on the rigid path"),
    "com_position": Variable(_TA, "m", "centre of mass of the payload"),
    "com_deviation": Variable(_TA, "m", "deviation of the centre of mass, flexible minus rigid"),
    "tool_position_rigid": Variable(_TA, "m", "tool point on the rigid path"),
    "tool_position": Variable(_TA, "m", "tool point"),
    "tool_deviation": Variable(_TA, "m", "deviation of the tool point, flexible minus rigid"),
    "rotation_deviation": Variable(_TA, "rad", "rotation vector from the rigid to the flexible platform, world axes"),
    "platform_quaternion": Variable(("time", "quaternion"), "1", "orientation of the platform, platform to world"),
    "platform_quaternion_rigid": Variable(
        ("time", "quaternion"), "1", "orientation of the platform on the rigid path, platform to world"
    ),
    "platform_angular_velocity": Variable(_TA, "rad s-1", "angular velocity of the platform, world axes"),
    **{
        name: Variable(_TA, unit, words)
        for what, frame in (
            ("base_motion", "base that is moved, against the world"),
            ("base_mount", "base plate on its mount, against the floor"),
            ("platform_mount", "plate with the platform joints against the payload, platform axes"),
        )
        for name, unit, words in (
            (f"{what}_displacement", "m", f"displacement of the {frame}"),
            (f"{what}_rotation", "rad", f"roll, pitch, yaw of the {frame}"),
        )
    },
    "base_motion_force": Variable(_TA, "N", "force that moves the base, on it, world axes"),
    "base_motion_moment": Variable(
        _TA, "N m", "moment that moves the base, about its point base_motion.at, world axes"
    ),
    "tool_deviation_base": Variable(_TA, "m", "deviation of the tool point as seen from the base plate, in its axes"),
    "rotation_deviation_base": Variable(
        _TA, "rad", "rotation vector from the rigid to the flexible platform as seen from the base plate, in its axes"
    ),
    "deviation_by_cause": Variable(
        ("time", "cause", "leg", "axis"), "m", "share of a cause in a leg in the deviation of the centre of mass"
    ),
    "deviation_residual": Variable(_TA, "m", "deviation of the centre of mass beyond the sum of its causes"),
}

_COMMAND = {
    "translation_command": Variable(_TA, "m", "commanded surge, sway, heave from home"),
    "translation_command_rate": Variable(_TA, "m s-1", "rate of commanded surge, sway, heave"),
    "translation_command_acceleration": Variable(_TA, "m s-2", "acceleration of commanded surge, sway, heave"),
    "rotation_command": Variable(_TA, "rad", "commanded roll, pitch, yaw"),
    "rotation_command_rate": Variable(_TA, "rad s-1", "rate of commanded roll, pitch, yaw"),
    "rotation_command_acceleration": Variable(_TA, "rad s-2", "acceleration of commanded roll, pitch, yaw"),
}

#: Of the drives, for strokes and sliders; a crank has rad and N m.
DRIVES = {
    "drive_position": Variable(_TL, "m", "place of the drive: stroke, or way of the carriage; of a passive leg too"),
    "drive_command": Variable(_TL, "m", "place of the drive on the rigid path"),
    "drive_force": Variable(_TL, "N", "force of the drive on what it moves"),
    "drive_force_rigid": Variable(_TL, "N", "force of the drive on what it moves, rigid robot"),
}

_LEGS = {
    **DRIVES,
    "held_force": Variable(("time", "leg", "coordinate"), "mixed", "force [N] or moment [N m] on what a joint holds"),
    "held_force_rigid": Variable(
        ("time", "leg", "coordinate"), "mixed", "force [N] or moment [N m] on what a joint holds, rigid robot"
    ),
    "joint_moment_rigid": Variable(
        ("time", "leg", "end", "axis"), "N m", "moment of base on leg and leg on platform, world axes, rigid robot"
    ),
    "joint_moment": Variable(
        ("time", "leg", "end", "axis"), "N m", "moment of the base on the leg, of the leg on the platform, world axes"
    ),
    "guide_force": Variable(
        ("time", "leg", "bushing", "direction"), "N", "force of a bushing on the piston across the leg, its spring's"
    ),
    "guide_overlap": Variable(_TL, "m", "distance of the bushings of the piston"),
    "leg_length_command": Variable(_TL, "m", "joint-to-joint length of the rigid leg"),
    "leg_length": Variable(_TL, "m", "joint-to-joint length of the flexible leg"),
    "leg_stroke": Variable(_TL, "m", "reference length: driven end of the piston plus its unstrained length"),
    "leg_angle": Variable(("time", "leg", "joint_angle"), "rad", "angles of the joints, zero at home but for hinges"),
    "actuator_force_rigid": Variable(_TL, "N", "force of the drive on the piston, rigid robot (Newton-Euler)"),
    "actuator_force": Variable(_TL, "N", "force of the drive on the piston, positive pushes out"),
    "joint_turn": Variable(("time", "leg", "end"), "rad", "angle of the leg at its joint from home"),
    "joint_margin": Variable(("time", "leg", "end"), "rad", "angle left of the largest turn of a joint"),
    "leg_clearance": Variable(_T, "m", "least distance between cylinders and pistons of two legs"),
    "nearest_legs": Variable(("time", "pair"), "1", "numbers of the two legs"),
    "tip_deflection": Variable(("time", "leg", "direction"), "m", "tip of the piston from the cylinder's axis"),
    "lateral_amplitude": Variable(("time", "leg", "direction", "shape"), "m", "amplitude of a lateral shape"),
    "axial_amplitude": Variable(("time", "leg", "axial_shape"), "m", "amplitude of an axial shape"),
    "friction": Variable(("time", "leg", "slide"), "mixed", "friction against what slides [N m], of strokes [N]"),
    "joint_force": Variable(("time", "leg", "axis"), "N", "force of the leg on the platform, world axes"),
    "joint_force_rigid": Variable(
        ("time", "leg", "axis"), "N", "force of the leg on the platform, world axes, rigid robot (Newton-Euler)"
    ),
    "base_force_rigid": Variable(("time", "leg", "axis"), "N", "force of the base on the leg, world axes, rigid robot"),
    "base_moment_rigid": Variable(("time", "leg", "axis"), "N m", "moment of the base on the leg, rigid robot"),
    "leg_length_rate": Variable(_TL, "m s-1", "rate of the joint-to-joint length of the rigid leg"),
    "leg_length_acceleration": Variable(_TL, "m s-2", "acceleration of the joint-to-joint length of the rigid leg"),
    "leg_angle_rigid": Variable(("time", "leg", "joint_angle"), "rad", "angles of the universal joint, rigid robot"),
}

_ENERGY = {
    "energy_kinetic": Variable(_T, "J", "kinetic energy"),
    "energy_potential": Variable(_T, "J", "potential energy of gravity, zero at the base plane"),
    "energy_strain": Variable(_T, "J", "strain energy of legs and drive springs"),
    "energy_dissipated": Variable(_T, "J", "energy dissipated since the start, as exact as the balance closes"),
    "work_drive": Variable(_T, "J", "work of the drives since the start"),
    "work_base": Variable(_T, "J", "work on a base that is moved since the start"),
    "work_control": Variable(_T, "J", "work of a sampled controller's forces since the start, none of it the drives'"),
    "work_external": Variable(_T, "J", "work of the external load since the start"),
    "closure_residual": Variable(_T, "m", "largest gap between a leg's tip and its joint on the platform"),
    "sensor_reading": Variable(("time", "sensor"), "mixed", "last sample of a sensor, from what it was at the start"),
    "control_input": Variable(("time", "actuator"), "mixed", "what a sampled controller holds until the next sample"),
}

_STATIC = {
    "part_stiffness": Variable(("leg", "part"), "N/m", "stiffness of a part along its leg; of a mount as if alone"),
    "leg_stiffness": Variable(("leg",), "N/m", "stiffness along a leg: all its parts in series, mounts left out"),
    "guide_stiffness": Variable(("leg", "bushing"), "N/m", "stiffness of a bushing of the piston across the leg"),
    "guide_turning": Variable(("leg",), "N m/rad", "moment at the gland over the turn of the piston there"),
    "lost_motion": Variable(("leg",), "m", "what the leg lags by the friction of its drive, half of it to and fro"),
    "frequency": Variable(("mode",), "Hz", "undamped natural frequency"),
    "damping_ratio": Variable(("mode",), "1", "damping ratio"),
    "kind": Variable(("mode",), "1", "what mostly moves"),
    "payload_share": Variable(("mode",), "1", "share of the payload in the kinetic energy of the mode"),
    "leg_share": Variable(("mode", "leg"), "1", "share of the leg in the kinetic energy of the mode"),
    "platform_shape": Variable(("mode", "component"), "1", "motion of centre of mass [m] and platform [rad]"),
    "leg_shape": Variable(
        ("mode", "leg", "direction", "station"), "1", "lateral displacement of the leg from the line of its joints [m]"
    ),
    "leg_stretch": Variable(("mode", "leg"), "1", "change of the joint-to-joint length [m]"),
    "stiffness": Variable(("wrench", "component"), "mixed", "stiffness at the tool [N m-1, N, N m], world axes"),
    "stiffness_share": Variable(
        ("leg", "wrench", "component"), "mixed", "share of a leg in the stiffness at the tool [N m-1, N, N m]"
    ),
    "stiffness_turning": Variable(
        ("wrench", "component"), "mixed", "what joint forces and load add to the stiffness when the platform turns"
    ),
    "platform_position": Variable(_TA, "m", "origin of the platform frame"),
    "com_sag": Variable(("axis",), "m", "displacement of the centre of mass by gravity and load"),
}

_MOBILITY = {
    "mobility": Variable((), "1", "motions of the robot, of legs that move by themselves too"),
    "locked": Variable((), "1", "motions left with all drives locked"),
    "redundant": Variable((), "1", "conditions of joints that say what others say"),
    "self_stress": Variable((), "1", "forces that drives and joints can exert against each other"),
    "freedoms": Variable((), "1", "freedoms of all joints together"),
    "gruebler": Variable((), "1", "motions by counting joints and loops"),
    "motions": Variable(("motion",), "1", "name of a motion of the platform"),
    "motion_twist": Variable(
        ("motion_basis", "component"), "mixed", "motions of the platform frame's origin [m] and rotations [rad]"
    ),
    "mobility_nearby": Variable(("posture",), "1", "motions at two displaced poses"),
    "locked_nearby": Variable(("posture",), "1", "motions left with all drives locked at two displaced poses"),
}

_C, _CC = ("component",), ("component", "component_b")
_ACCURACY = {
    "pose_error": Variable(_C, "mixed", "error of the tool's pose [m, rad], as built and warm, exact kinematics"),
    "pose_error_first_order": Variable(_C, "mixed", "error of the tool's pose [m, rad] to first order"),
    "pose_error_by_part": Variable(
        ("error", "leg", "component"), "mixed", "share of an error of a leg in that of the tool's pose [m, rad]"
    ),
    "pose_drift": Variable(("drift_time", "component"), "mixed", "error of the tool's pose [m, rad] as parts warm up"),
    "pose_sigma": Variable(_C, "mixed", "standard deviation of the tool's pose [m, rad] by tolerances"),
    "pose_covariance": Variable(_CC, "mixed", "covariance of the tool's pose [m, rad] by tolerances"),
    "pose_worst": Variable(_C, "mixed", "largest error of the tool's pose [m, rad] by tolerances given as boxes"),
    "pose_sigma_by_tolerance": Variable(
        ("tolerance", "leg", "component"), "mixed", "standard deviation of the tool's pose [m, rad]"
    ),
    "pose_worst_by_tolerance": Variable(
        ("tolerance", "leg", "component"), "mixed", "largest error of the tool's pose [m, rad]"
    ),
    "leg_bow": Variable(("leg",), "m", "largest distance of the leg's axis from the line of its joints, under thrust"),
    "euler_share": Variable(("leg",), "1", "thrust over Euler load of the leg"),
    "sample_mean": Variable(_C, "mixed", "mean error of the tool's pose [m, rad] of the machines drawn"),
    "sample_covariance": Variable(_CC, "mixed", "covariance of the tool's pose [m, rad] of the machines drawn"),
    "sample_largest": Variable(_C, "mixed", "largest error of the tool's pose [m, rad] of the machines drawn"),
    "sample_count": Variable((), "1", "machines drawn"),
}

_FC = ("spectrum_frequency", "component")
_DISTURBED = {
    "vibration_rms": Variable(_C, "mixed", "rms of the tool's vibration [m, rad] relative to the base"),
    "vibration_covariance": Variable(_CC, "mixed", "covariance of the tool's vibration [m, rad] relative to the base"),
    "vibration_psd": Variable(_FC, "mixed", "one-sided spectral density of the tool's vibration [m2 Hz-1, rad2 Hz-1]"),
    "vibration_cumulative": Variable(_FC, "mixed", "rms [m, rad] of the tool's vibration at this frequency and above"),
    "vibration_by_source": Variable(("source", "component"), "mixed", "rms [m, rad] by one disturbance alone"),
    "vibration_by_mode": Variable(("mode", "component"), "mixed", "share [m, rad] of a mode in the rms"),
}

_TC = ("time", "component")
_PLAY = {
    "pressing_force": Variable(
        ("time", "place", "leg"), "mixed", "force [N] that presses a leg together; of a carriage that of its drive"
    ),
    "play_error": Variable(_TC, "mixed", "error of the tool's pose [m, rad] by play, as the forces press it"),
    "play_worst": Variable(_TC, "mixed", "largest error of the tool's pose [m, rad] by play, however it lies"),
    "play_by_place": Variable(("place", "leg", "component"), "mixed", "error of the tool's pose [m, rad] by play"),
    "sign_changes": Variable(("place", "leg"), "1", "changes of sign of the pressing force"),
    "jump_time": Variable(("jump",), "s", "instant at which play changes its side"),
    "jump_place": Variable(("jump",), "1", "where it does"),
    "jump_leg": Variable(("jump",), "1", "leg in which it does"),
    "jump_size": Variable(("jump", "component"), "mixed", "jump of the tool's pose [m, rad]"),
}

_PK = ("part", "kind", "component")
_BUDGET = {
    "budget": Variable(_PK, "mixed", "what a part adds to the error of the tool [m, rad]"),
    "budget_by_leg": Variable(
        ("part", "kind", "leg", "component"), "mixed", "share of a leg in what a part adds to the error [m, rad]"
    ),
    "budget_total": Variable(_PK[1:], "mixed", "all parts together by the rule of the kind [m, rad]"),
    "budget_residual": Variable(_PK[1:], "mixed", "what the rows leave of the whole [m, rad]"),
    "nature": Variable(("part",), "1", "calibratable, repeatable or drifting, of parts with a systematic error"),
    "how": Variable(_PK[:2], "1", "how it was computed"),
    "share": Variable(("part",), "1", "size of a part's worst error of the tool's place, over the sum of all sizes"),
    "worst": Variable(_C, "mixed", "largest error of the tool [m, rad], all kinds at their worst at once"),
    "rss": Variable(_C, "mixed", "root of the sum of the squares of all kinds [m, rad]"),
    "pose_accuracy": Variable(("state", "component"), "mixed", "systematic error and 3 sigma of tolerances [m, rad]"),
    "repeatability_unidirectional": Variable(_C, "mixed", "4 standard deviations from approach to approach [m, rad]"),
    "repeatability_bidirectional": Variable(_C, "mixed", "the same with the reversal value [m, rad]"),
    "worst_time": Variable((), "s", "instant whose pose has the largest static deviation of the tool"),
    "peak_time": Variable(_C, "s", "instant of the largest dynamic deviation"),
}

_ACTUATOR = {
    "length": Variable(_T, "m", "length of the beam outside the hub"),
    "angle": Variable(_T, "rad", "angle of the hub from the horizontal"),
    "length_rate": Variable(_T, "m s-1", "rate of the length outside the hub"),
    "angle_rate": Variable(_T, "rad s-1", "rate of the angle of the hub"),
    "mode_amplitude": Variable(("time", "mode"), "m", "amplitude of a lateral shape"),
    "tip_position": Variable(("time", "plane_axis"), "m", "tip in the plane of motion"),
    "torque": Variable(_T, "N m", "torque on the hub"),
    "force": Variable(_T, "N", "axial force on the beam, positive pushes out"),
    "elevation": Variable(_T, "rad", "angle of the hub towards Z, of an actuator in space"),
    "elevation_rate": Variable(_T, "rad s-1", "rate of the elevation of the hub"),
    "elevation_torque": Variable(_T, "N m", "torque on the hub towards Z"),
    "tip_stretch": Variable(_T, "m", "lengthening of the beam by tension, 0 without EA"),
    "tip_twist": Variable(_T, "rad", "twist of the tip about the beam, 0 without GJ"),
}

#: The variables by what they tell of.
GROUPS: Mapping[str, Mapping[str, Variable]] = {
    "Paths and deviations": _PATH, "Commands": _COMMAND, "Legs and drives": _LEGS, "Energies": _ENERGY,
    "Stiffness and modes": _STATIC, "Mobility": _MOBILITY, "Accuracy of a pose": _ACCURACY, "Play": _PLAY,
    "Error budget": _BUDGET, "Vibration": _DISTURBED, "Single actuator": _ACTUATOR,
}  # fmt: skip

#: Every variable of every Dataset, by name.
VARIABLES: Mapping[str, Variable] = {name: form for group in GROUPS.values() for name, form in group.items()}

#: The actuator's own form of variables that a robot has per leg or with another zero.
ACTUATOR_FORMS = {
    "tip_deflection": Variable(_T, "m", "deflection of the tip in the hub frame"),
    "energy_potential": Variable(_T, "J", "potential energy of gravity, zero at the pivot"),
    "energy_strain": Variable(_T, "J", "strain energy of the beam"),
}

#: Of an actuator in space: towards larger angles, and towards larger elevations.
DIRECTIONS = ("rotation", "elevation")
SPACE_FORMS = {
    "tip_deflection": Variable(("time", "direction"), "m", "deflection of the tip in the hub frame"),
    "mode_amplitude": Variable(("time", "direction", "mode"), "m", "amplitude of a lateral shape"),
    "tip_position": Variable(_TA, "m", "tip, world axes"),
    "angle": Variable(_T, "rad", "angle of the hub about Z"),
    "torque": Variable(_T, "N m", "torque on the hub about Z"),
}

#: Of a single pose.
ONE_POSE_FORMS = {
    "platform_position": Variable(("axis",), "m", "origin of the platform frame"),
    "platform_quaternion": Variable(("quaternion",), "1", "orientation of the platform, platform to world"),
}


_WHOLE = {"nearest_legs"}  # variables of whole numbers

#: Of a single pose: play.
AT_A_POSE = {name: form._replace(dims=form.dims[1:]) for name, form in _PLAY.items() if form.dims[0] == "time"}


def fixed_labels(sizes: Mapping[str, int]) -> dict[str, tuple[object, str]]:
    """Labels of those of some dimensions that need no others from a study, and what they stand for; legs by number."""
    found: dict[str, tuple[object, str]] = {dim: COORDINATES[dim] for dim in COORDINATES if dim in sizes}
    return {"leg": (list(range(1, sizes["leg"] + 1)), "leg"), **found} if "leg" in sizes else found


def dataset(
    values: Mapping[str, ArrayLike],
    coords: Mapping[str, ArrayLike] | None = None,
    attrs: Mapping[str, object] | None = None,
    forms: Mapping[str, Variable] | None = None,
) -> Dataset:
    """Dataset of named arrays; dimensions, units and long names come from the table.

    Parameters
    ----------
    values : mapping
        Arrays by name; of `LazyArrays` what nobody has asked for yet is made when it is read; its sizes are then those
        of ``coords`` and of the arrays before it.
    coords : mapping, optional
        Labels of `time`, `mode`, `station` where these dimensions occur.
    attrs : mapping, optional
        Attributes of the whole Dataset.
    forms : mapping, optional
        Entries that replace those of `VARIABLES`.
    """
    load_module("xarray")
    from flexapod.common.datasets import assemble_dataset, lazy_variable, variable

    forms = forms or {}
    known = {dim: len(given) for dim, (given, _) in COORDINATES.items()} | {"pair": 2}
    known |= {dim: np.size(given) for dim, given in (coords or {}).items()}
    data, sizes = {}, {}
    for name in values:
        dims, units, long_name = forms[name] if name in forms else VARIABLES[name]
        described = {"units": units, "long_name": long_name}
        if isinstance(values, LazyArrays) and values.peek(name) is None:
            own = {dim: (known | sizes)[dim] for dim in dims}
            data[name] = lazy_variable(values, name, own, int if name in _WHOLE else float, described)
        else:
            data[name] = variable(dims, values[name], described)
        sizes |= data[name].sizes
    labels = {dim: (given, {"long_name": words}) for dim, (given, words) in fixed_labels(sizes).items()}
    labels |= {dim: (given, dict(_COORDINATE_ATTRS.get(dim, {}))) for dim, given in (coords or {}).items()}
    return assemble_dataset(data, labels, attrs or {})


_COORDINATE_ATTRS = {
    "time": {"units": "s", "long_name": "time"},
    "leg": {"long_name": "leg"},
    "mode": {"long_name": "mode"},
    "shape": {"long_name": "lateral shape"},
    "axial_shape": {"long_name": "axial shape"},
    "station": {"units": "1", "long_name": "position along the leg: 0 base joint, 1 tip"},
    "joint_angle": {"long_name": "angle of a joint"},
    "cause": {"long_name": "cause of a leg's length error"},
    "part": {"long_name": "part of a leg"},
    "kind": {"long_name": "kind of error"},
    "coordinate": {"long_name": "coordinate of a leg"},
    "slide": {"long_name": "where friction is, and in which direction"},
    "place": {"long_name": "where there is play"},
    "error": {"long_name": "what is not as drawn"},
    "tolerance": {"long_name": "what may not be as drawn"},
    "source": {"long_name": "disturbance"},
    "sensor": {"long_name": "channel that a controller reads"},
    "actuator": {"long_name": "channel that a controller moves"},
    "spectrum_frequency": {"units": "Hz", "long_name": "frequency"},
    "drift_time": {"units": "s", "long_name": "time of the temperatures"},
}
