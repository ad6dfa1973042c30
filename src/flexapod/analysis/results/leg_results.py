"""Results of the legs by name: lengths, angles, deflections, forces and moments, for legs of any kind.

Accuracy of forces of a run within a tolerance: estimate over peak, Eq. (T6.34), and a remark on it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from flexapod.analysis.results import legs as by_name
from flexapod.analysis.results.bodies import (
    Drawn,
    body_results,
    draw,
    flexible_axes,
    joint_angle_limits,
    pairs_of_legs,
)
from flexapod.analysis.results.causes import cause_names
from flexapod.analysis.results.element_outputs import element_results
from flexapod.analysis.results.elongations import (
    GUIDED,
    elongations,
    gap_elongations,
    guide_results,
    is_guided,
    tip_displacements,
)
from flexapod.analysis.results.lazy_arrays import ArraySource
from flexapod.analysis.results.remarks import remark
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Record
from flexapod.analysis.results.variables import DRIVES, Variable
from flexapod.common.arrays import Array
from flexapod.kinematics.as_built import built_limbs
from flexapod.kinematics.leg_geometry import COORDINATES, HELD, Limbs
from flexapod.kinematics.robot import rigid_limbs, robot_limbs
from flexapod.kinematics.rotations import exponential, matrix
from flexapod.mechanics.elements.springs import twist_share
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import Robot, Study
from flexapod.solve import result_rows
from flexapod.solve.batch import RestStates
from flexapod.solve.frames import to_world
from flexapod.solve.friction import sliding_jacobian
from flexapod.solve.statics.ideal_robot import idealize_robot, reactions, rigid_system
from flexapod.solve.statics.lost_motion import places_with_friction
from flexapod.solve.system import System

STROKES = ("leg_length_command", "leg_length", "leg_stroke", "actuator_force")
"""Variables of robots whose legs have strokes."""
_BASE_ANGLES = ("alpha", "beta", "spin")


def leg_results(system: System, path: RigidPath, record: Record) -> dict[str, ArraySource]:
    """Lengths, angles, deflections and forces of the legs."""
    robot, shapes, q = path.robot, system.kernel.shapes, record.q
    found = robot_limbs(robot)
    forces, drawn = cache(lambda: _port_forces(system, record)), cache(lambda: draw(robot, system, record))
    length = cache(lambda: flexible_lengths(robot, system, record, drawn()))
    zero, turns = _zero(found), by_name.screw_travel(robot)
    results: dict[str, ArraySource] = {
        "leg_angle": lambda: np.stack([q[..., shapes.index(x)] for x in by_name.angle_names(found).values()], axis=-1),
        "drive_position": lambda: _drive_positions(robot, system, record) / turns + zero,
        "drive_command": lambda: _commands(found, path) / turns + zero,
        "drive_force": lambda: _motor_forces(robot, system, forces()) * turns,
        "tip_deflection": lambda: _tip_deflections(robot, system, q),
        "joint_force": record.lam[..., :3],
    }
    results |= body_results(robot, system.kernel, drawn, length)
    if by_name.has_strokes(robot):
        made = (
            lambda: path.lengths,
            length,
            q[..., shapes.l_index],
            lambda: by_name.stroke_forces(found, drive_forces(robot, system, record)),
        )
        results |= zip(STROKES, made, strict=True)
    if shapes.beam.guide is not None:
        inside = cache(lambda: guide_results(robot, system, q))
        results |= {name: lambda name=name: inside()[name] for name in GUIDED}
    if held := by_name.held_names(found):
        results["held_force"] = lambda: _held_forces(found, system, forces(), held)
    if _bears_moments(found):
        results["joint_moment"] = lambda: _joint_moments(robot, found, system, record, forces())
    if shapes.bristles:
        results["friction"] = record.friction * _by_angle(robot, system)
    if by_name.bending_basis(shapes).count:
        results["lateral_amplitude"] = lambda: by_name.lateral_amplitudes(shapes, q)
    results |= element_results(robot, system, q)
    if shapes.beam.axial.count:
        results["axial_amplitude"] = q[..., shapes.index("c") :][..., : shapes.beam.axial.count]
    return results


def _tip_deflections(robot: Robot, system: System, q: Array) -> Array:
    shapes, moves = system.kernel.shapes, tip_displacements(robot, system, q)
    bent = np.tensordot(by_name.lateral_amplitudes(shapes, q), by_name.bending_basis(shapes).tip, 1)
    return bent + sum(place for place, _ in moves.values())


def rigid_leg_results(path: RigidPath) -> dict[str, Array]:
    """Lengths and angles of the rigid legs, and the ways of their drives."""
    robot, state = path.robot, path.legs
    found = rigid_limbs(robot)
    angles = [state.coordinate(name)[0] for name in by_name.angle_names(found).values()]
    values = {
        "leg_angle_rigid": np.stack(angles, axis=-1),
        "drive_command": _commands(found, path) / by_name.screw_travel(robot) + _zero(found),
    }
    if by_name.has_strokes(robot):
        names = ("leg_length_command", "leg_length_rate", "leg_length_acceleration")
        values |= zip(names, (state.length, state.rate, state.accel), strict=True)
    return values


def rigid_reactions(path: RigidPath) -> dict[str, Array]:
    """Reactions of the rigid robot's joints, other than forces on the platform."""
    robot, on_base = path.robot, (path.forces.base_force, path.forces.base_moment)
    if on_base[0] is not None and on_base[1] is not None:
        return {"base_force_rigid": on_base[0], "base_moment_rigid": on_base[1]}
    states, forces = reactions(path, path.wrench)
    system, found, values = rigid_system(robot), robot_limbs(idealize_robot(robot)), {}
    if held := by_name.held_names(found):
        values["held_force_rigid"] = _held_forces(found, system, forces.held, held)
    if _bears_moments(found):
        states = replace(states, lam=forces.closure)
        values["joint_moment_rigid"] = _joint_moments(idealize_robot(robot), found, system, states, forces.held)
    return values


def _zero(found: Limbs) -> Array:
    """Places of the drives, as the study file measures them, at zero of their coordinates, (legs,)."""
    return found.carriage_zero * [name == "chi" for name in by_name.drive_names(found)]


def _port_forces(system: System, record: Record) -> Array:
    """Forces of what holds, drives or pushes coordinates, (T, legs, n) [N, N m]; 0 on the others."""
    forces = np.zeros(record.q.shape)
    forces[..., system.ports] = record.drive
    return forces


def _drive_positions(robot: Robot, system: System, record: Record) -> Array:
    """Positions of the drives, (T, legs): strokes, carriages, travel of rotors; of a servo its end of the spring."""
    shapes, q = system.kernel.shapes, record.q
    found = by_name.drive_values(robot_limbs(robot), shapes, q)
    if not shapes.has("r"):
        return found
    gap = gap_elongations(system, q)
    return found - (np.sum(list(elongations(robot, system, q, ("nut",), gap).values()), axis=0) + gap)


def _motor_forces(robot: Robot, system: System, forces: Array) -> Array:
    """Forces of the drives on what they move, (T, legs): of rotors by their travel."""
    shapes = system.kernel.shapes
    found = by_name.drive_values(robot_limbs(robot), shapes, forces)
    if not shapes.has("r"):
        return found
    rotor = forces[..., shapes.index("r")]
    held = system.held[:, shapes.l_index]  # by the drive, whose rotor turns along
    return np.where([leg.gives for leg in robot.legs], rotor + np.where(held, found, 0.0), found)


def sliding_words(system: System) -> list[str]:
    """Labels of the sliding contacts in a leg: joints with their angles or, of balls, axes; the drive."""
    shapes, found = system.kernel.shapes, []
    for slot, _ in shapes.friction_elements:
        found += [f"{slot.rubs_at} {way}".strip() for way in slot.kind.friction_directions(shapes.has)]
    return found


def _by_angle(robot: Robot, system: System) -> Array:
    """Factors (legs, bristles) by which friction is that of the study file: of screws by their angle."""
    kinds = [slot.kind for slot, count in system.kernel.shapes.friction_elements for _ in range(count)]
    return np.array([[kind.friction_unit(leg) for kind in kinds] for leg in robot.legs])


def drive_forces(robot: Robot, system: System, record: Record) -> Array:
    """Force of every drive on carriage or piston, (T, legs) [N, of cranks N m]; 0 of passive legs."""
    found = by_name.drive_values(robot_limbs(robot), system.kernel.shapes, _port_forces(system, record))
    rubbing = [i for i, leg in enumerate(robot.legs) if leg.screw is not None and leg.screw.friction is not None]
    length = record.q[..., system.kernel.shapes.l_index]
    for i in rubbing:  # what a screw's friction takes of the springs' force before it reaches the piston, Eq. (T19.12)
        found[:, i] -= twist_share(robot.legs[i], length[:, i]) * record.friction[:, i, -1]
    return found


def _commands(found: Limbs, path: RigidPath) -> Array:
    """Places of the drives on the rigid path, (T, legs)."""
    names = by_name.drive_names(found)
    if {*names} == {"l"}:
        return path.lengths
    of = {name: path.legs.coordinate(name)[0] for name in {*names}}
    return np.stack([of[name][:, i] for i, name in enumerate(names)], axis=1)


def _held_forces(found: Limbs, system: System, forces: Array, held: list[str]) -> Array:
    at = [system.kernel.shapes.index(name) for name in held]
    whose = found.state[:, [COORDINATES.index(name) for name in held]] == HELD
    return np.where(whose, forces[..., at], 0.0)


def leg_labels(robot: Robot, *, rigid: bool = False) -> dict[str, ArrayLike]:
    """Labels of the dimensions whose size depends on the robot; with `rigid` those of the rigid path."""
    found = (rigid_limbs if rigid else robot_limbs)(robot)
    labels: dict[str, ArrayLike] = {"joint_angle": list(by_name.angle_names(found))}
    if not rigid:
        labels["cause"] = list(cause_names(robot))
    held = by_name.held_names(found)
    return {**labels, "coordinate": held} if held else labels


def absent_variables(robot: Robot) -> set[str]:
    """Variables of legs and frames that a simulation of this robot does not have."""
    found = robot_limbs(robot)
    none = set() if by_name.has_strokes(robot) else {*STROKES, "actuator_force_rigid"}
    none |= set() if by_name.held_names(found) else {"held_force"}
    none |= set() if np.isfinite(joint_angle_limits(robot)).any() else {"joint_margin"}
    none |= set() if is_guided(robot) else {"guide_force", "guide_overlap"}
    none |= set() if pairs_of_legs(robot) else {"leg_clearance", "nearest_legs"}
    none |= set() if places_with_friction(robot) else {"friction"}
    none |= _absent_frames(robot)
    return none if _bears_moments(found) else {*none, "joint_moment"}


def _absent_frames(robot: Robot) -> set[str]:
    frames = ("base_motion", "base_mount", "platform_mount")
    none = {f"{x}_{of}" for x in frames if getattr(robot, x) is None for of in ("displacement", "rotation")}
    if robot.base_motion is None:
        none |= {"work_base", "base_motion_force", "base_motion_moment"}
    return none if robot.base_mount is not None else none | {"tool_deviation_base", "rotation_deviation_base"}


def drive_forms(robot: Robot) -> dict[str, Variable]:
    """Variables of drives in the units that they have: a crank and a screw have rad and N m."""
    found = robot_limbs(robot)
    cranks = [name == "chi" and found.carriage == "crank" for name in by_name.drive_names(found)]
    turns = {crank or leg.screw is not None for crank, leg in zip(cranks, robot.legs, strict=True)}
    if True not in turns:
        return {}
    units = {"m": "rad", "N": "N m"} if len(turns) == 1 else {"m": "mixed", "N": "mixed"}
    return {name: form._replace(units=units[form.units]) for name, form in DRIVES.items()}


def flexible_lengths(robot: Robot, system: System, record: Record, at: Drawn) -> Array:
    """Joint-to-joint lengths of the flexible robot, (T, legs) [m], Eq. (T8.1)."""
    built = built_limbs(robot, robot_limbs(robot))
    base, platform = by_name.base_points(built, _carriages(system, record.q)), built.platform - robot.com
    if system.kernel.library is not None:
        base = base if base.ndim == 3 else base[None]
        return result_rows.lengths(system.kernel, at.place, at.rotation, base, platform)
    tips = at.place[:, None] + platform @ at.rotation.swapaxes(1, 2)
    return np.linalg.norm(tips - base, axis=-1)


def _carriages(system: System, q: Array) -> Array | None:
    shapes = system.kernel.shapes
    return q[..., shapes.index("chi")] if shapes.has("chi") else None


def _bears_moments(found: Limbs) -> bool:
    angles = [k for k, name in enumerate(COORDINATES) if name in _BASE_ANGLES]
    return bool(found.pose_closure.any() or (found.state[:, angles] == HELD).any())


def _joint_moments(robot: Robot, found: Limbs, system: System, record: Record | RestStates, forces: Array) -> Array:
    """Moments of the base on the legs and of the legs on the platform, world axes, (T, legs, 2, 3) [N m].

    About the leg's own axis that of the base counts only where the leg has a turn about it as a coordinate.
    """
    rates = {}
    if isinstance(record, Record):
        rates = dict(zip(damped_angles(system), np.moveaxis(record.rate, -1, 0), strict=True))
    rubs = record.friction if isinstance(record, Record) else None
    base = _base_moments(found, system, record.q, rates, forces, rubs)
    base = to_world(system, robot, record.q, base)
    if system.rows < 6:
        return np.stack([base, np.zeros_like(base)], axis=2)
    turn = matrix(record.pose[:, 3:])[:, None] @ found.platform_frames
    on_platform = found.L_c * (turn @ record.lam[..., 3:, None])[..., 0]  # (T13.14) where Q = 1
    return np.stack([base, on_platform], axis=2)


def damped_angles(system: System) -> list[int]:
    """Coordinates of a leg, angles at its base joint, whose springs are damped in some leg."""
    shapes = system.kernel.shapes
    if not shapes.has("gamma1") or not _of_base(system, "damping").any():
        return []
    return [shapes.index(name) for name in _BASE_ANGLES if shapes.has(name)]


def _base_moments(
    found: Limbs, system: System, q: Array, rates: dict[int, Array], forces: Array, rubs: Array | None
) -> Array:
    shapes = system.kernel.shapes
    turn, axes = _turned_by_cranks(found, system, q), []
    about = np.zeros((*q.shape[:2], 3))
    on_angles = None if rubs is None or not shapes.bristles else _on_coordinates(system, q, rubs)
    for k, (name, unit) in enumerate(zip(_BASE_ANGLES, np.eye(3), strict=True)):
        axes.append((turn @ unit[:, None])[..., 0])
        if not shapes.has(name):
            continue
        angle = q[..., shapes.index(name)]
        about[..., k] = np.where(system.held[:, shapes.index(name)], forces[..., shapes.index(name)], 0.0)
        about[..., k] -= _springs(system, k, angle, rates.get(shapes.index(name), 0.0))
        if on_angles is not None:
            about[..., k] -= on_angles[..., shapes.index(name)]
        turn = turn @ exponential(angle[..., None] * unit)
    return np.asarray(np.linalg.solve(np.stack(axes, axis=-2), about[..., None])[..., 0], dtype=np.float64)


def _on_coordinates(system: System, q: Array, rubs: Array) -> Array:
    """Friction (T, legs, bristles) on the coordinates of the legs, (T, legs, n)."""
    parts = [
        (sliding_jacobian(system, part).swapaxes(-1, -2) @ force[..., None])[..., 0]
        for part, force in zip(*(np.array_split(x, len(x) // 500 + 1) for x in (q, rubs)), strict=True)
    ]
    return np.concatenate(parts)


def _turned_by_cranks(found: Limbs, system: System, q: Array) -> Array:
    """Frames of the base joints, (T, legs, 3, 3)."""
    frames = np.broadcast_to(found.frames, (*q.shape[:2], 3, 3))
    if found.carriage != "crank":
        return frames
    return exponential(q[..., system.kernel.shapes.index("chi"), None] * found.carriage_axis) @ frames


def _springs(system: System, k: int, angle: Array, rate: Array | float) -> Array:
    """Moment with which spring and damper of a base joint's angle resist, (T, legs)."""
    if not system.kernel.shapes.has("gamma1"):
        return np.zeros_like(angle)
    stiffness, home, damping = (_of_base(system, name)[:, k] for name in ("stiffness", "home", "damping"))
    return stiffness * (angle - home) + damping * rate


def _of_base(system: System, name: str) -> Array:
    """A parameter of the angles at the base joints, (legs, 3)."""
    return system.leg_p[:, columns(leg_parameters(system.kernel.shapes), f"base_{name}")]


BEYOND = 10.0  # tolerances that forces may be off by without a remark
INSTANTS = 200  # of a record that tell the peak
FINEST = 1e-8  # tolerance that is advised at most: rounding is not far


def force_error(robot: Robot, system: System, record: Record) -> float | None:
    """Estimated error of the legs' forces over their peak, as of a run within a tolerance; None where none is known."""
    if record.force_error is None or system.rows < 3:
        return None
    some = record.part(slice(None, None, max(1, len(record.time) // INSTANTS)))
    along = np.einsum("tli,tli->tl", some.lam[..., :3], flexible_axes(robot, system, some))
    peak = float(np.abs(along).max())
    return record.force_error / peak if peak > 0 else None


def force_warnings(study: Study, error: float | None) -> list[str]:
    """A remark where forces are beyond ten times the tolerance, with the one that would do.

    Errors of vibrations that steps begin to follow fall with the root of the tolerance, later with the tolerance.
    """
    tolerance = study.simulation.tolerance
    if error is None or tolerance is None or error <= BEYOND * tolerance:
        return []
    finer = tolerance * (BEYOND * tolerance / error) ** 2
    digit = 10.0 ** np.floor(np.log10(max(finer, FINEST)))
    advised = np.floor(max(finer, FINEST) / digit * (1 + 1e-9)) * digit
    finest = f"{advised:.0e}".replace("e-0", "e-")
    return [remark("inexact forces", error=100 * error, times=error / tolerance, tolerance=finest)]
