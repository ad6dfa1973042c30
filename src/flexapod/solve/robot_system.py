"""Equations of a robot, and a trial of its external elements in numbers at home.

An element whose parts are no number there is reported with class and file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.kinematics.leg_geometry import ABSENT, COORDINATES, DRIVEN, HELD, Limbs
from flexapod.mechanics.elements.element import LegContext
from flexapod.mechanics.elements.registry import kinds_of
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.springs import springs_along
from flexapod.mechanics.elements.trial import hook_error
from flexapod.mechanics.leg.layout import Shapes, columns
from flexapod.mechanics.leg.layout import leg_parameters as leg_layout
from flexapod.model import Robot, Simulation, Study
from flexapod.solve.batch import Rates, matrices_at_rest, residual
from flexapod.solve.kernel import kernel
from flexapod.solve.parameters import leg_parameters, payload_parameters, standings
from flexapod.solve.rigid_motion import rigid_rest
from flexapod.solve.shapes import robot_shapes
from flexapod.solve.system import System

RATE = 1e-3  # m/s, 1/s: of all coordinates of legs that are tried in motion


def try_elements(robot: Robot, system: System) -> None:
    """Refuse elements with tables of their own whose equations are no number at home, at rest or in motion.

    Legs without the element are tried as well: they have its equations with the numbers of `Physics.absent`.

    Raises
    ------
    InputError
        With class and file, the leg, and which energy or force it is.
    """
    if not any(leg.elements for leg in robot.legs):
        return
    x, none = rigid_rest(system, kinematics.RigidPoses(robot, kinematics.home_pose(robot))), np.zeros(6)
    still = np.zeros((1, system.legs, system.ports.size))
    m = matrices_at_rest(system, x, none)
    found = [m.M, m.D, m.K]
    for rate in (0.0, RATE):
        v = np.full(x.q.shape, rate)
        rates = Rates(v=v, v_dot=np.zeros_like(v), u=np.zeros((1, 6)), u_dot=np.zeros((1, 6)))
        found.append(residual(system, x, still, still, none, rates)[0])
        bad = ~np.all([np.isfinite(part[0]).reshape(system.legs, -1).all(axis=1) for part in found], axis=0)
        for i in np.flatnonzero(bad):
            for slot, parts in _without_number(system, x.q[0, i], v[0, i], system.leg_p[i]):
                raise _refused(slot, robot, int(i), parts)


def _without_number(system: System, *values: Array) -> Iterator[tuple[Slot, list[str]]]:
    """External elements with parts that are no number for coordinates, rates and parameters of a leg."""
    from flexapod.mechanics.leg.kernel_functions import parts_of_elements

    for slot, parts in parts_of_elements(system.kernel.shapes, values).items():
        if parts:
            yield slot, parts


def _refused(slot: Slot, robot: Robot, i: int, parts: list[str]) -> Exception:
    there = slot.of(robot.legs[i]) is not None
    hook = "energy" if {"kinetic", "gravity", "strain", "dissipation"} & set(parts) else "damping_force"
    which = f"of leg {i + 1} at home" if there else f"in leg {i + 1}, which is without it"
    names = ", ".join(parts)
    return hook_error(
        slot.kind, hook, f"{names}: {which} a value or a derivative is no number",
        allowed="what has finite values and first and second derivatives, at rest too",
        next_step=None if there else "Say numbers for a leg without it in `absent`: there they are 0 without one",
    )  # fmt: skip


def robot_system(
    robot: Robot,
    simulation: Simulation,
    per_loss: float,
    *,
    at_rest: bool = False,
) -> System:
    """System of a robot as built, in the fidelity and shapes of ``simulation``.

    ``per_loss`` [s]: viscous damping over stiffness of a spring of loss factor 1, see `loss_factor.per_loss`.
    ``at_rest``: loops that sum their errors have left none, Eq. (T23.16).
    """
    legs = kinematics.built_limbs(robot, kinematics.robot_limbs(robot))
    shapes = robot_shapes(robot, simulation, legs)
    standing = standings(robot, legs, per_loss, at_rest=at_rest)
    system = System(
        kernel=kernel(shapes),
        leg_p=leg_parameters(robot, legs, shapes, per_loss, at_rest=at_rest),
        joint_p=np.ascontiguousarray(legs.platform - robot.com),
        payload_p=payload_parameters(robot, shapes, at_rest=at_rest),
        held=_held(robot, legs, shapes, at_rest=at_rest) | _held_by_elements(robot, shapes, standing),
        hub_held=legs.hub_held,
    )
    try_elements(robot, system)
    return system


def without_ripple(robot: Robot) -> Robot:
    """Robot without ripple of its motors and the like: the position at rest within a period is unknown."""
    legs = list(robot.legs)
    for kind in kinds_of(legs):
        for i, leg in enumerate(robot.legs):
            for own in kind.all_of(leg):
                legs[i] = own.without_ripple(legs[i])
    same = all(now is before for now, before in zip(legs, robot.legs, strict=True))
    return robot if same else robot.replace(legs=tuple(legs))


def _held(robot: Robot, legs: Limbs, shapes: Shapes, *, at_rest: bool) -> Mask:
    """Coordinates that follow a table: held by joints or drives, or those of other legs. A ball's gammas are free."""
    held = np.zeros((len(legs), shapes.size), dtype=bool)
    prescribed = np.array([leg.drive.holds and leg.holds_stroke for leg in robot.legs])
    for k, name in enumerate(COORDINATES):
        if shapes.has(name):
            state = legs.state[:, k]
            foreign = (state == ABSENT) & (name in ("chi", "spin"))
            held[:, shapes.index(name)] = (state == HELD) | ((state == DRIVEN) & prescribed) | foreign
    made_up = [leg.drive.holds or at_rest for leg in robot.legs]  # ideally, or at rest
    ends = np.array([leg.measured == "joint-to-joint" for leg in robot.legs]) & made_up
    for name, size in shapes.layout:
        if name in ("c", "u3", "e3") and ends.any():
            held[ends, shapes.index(name) : shapes.index(name) + size] = True
    return held | _held_inside(robot, shapes)


def _held_inside(robot: Robot, shapes: Shapes) -> Mask:
    """Coordinates at and within the mouth of legs without bushings, of rigid cylinders, and across a planar robot."""
    held: Mask = np.zeros((len(robot.legs), shapes.size), dtype=bool)
    for i, leg in enumerate(robot.legs):
        there = {"g": leg.guide is not None, "h": leg.guide is not None, "k": leg.cylinder.section is not None}
        for name, size in shapes.layout:
            if name[0] in there and name[1:] in ("a", "b"):
                at = shapes.index(name)
                held[i, at : at + size] = not there[name[0]] or (robot.plane is not None and name[1] == "a")
    return held


def _held_by_elements(robot: Robot, shapes: Shapes, standing: Sequence[LegContext]) -> Mask:
    """Coordinates that elements let follow a table: one of their own if all that have it do, others if any does."""
    held: Mask = np.zeros((len(robot.legs), shapes.size), dtype=bool)
    sizes = dict(shapes.layout)
    for i, leg in enumerate(robot.legs):
        holds = [(dict(element.coordinates), element.prescribed(leg, standing[i])) for element in shapes.elements]
        for name in {name for _, names in holds for name in names}:
            own = [name in names for has, names in holds if name in has]
            other = any(name in names for has, names in holds if name not in has)
            at = shapes.index(name)
            held[i, at : at + sizes[name]] = other or (bool(own) and all(own))
    return held


def rotor_loop_system(robot: Robot, simulation: Simulation, per_loss: float) -> System:
    """The robot's equations in motion with loops as springs and dampers on their rotors, which act at once.

    ``per_loss``: as of `robot_system`.
    """
    system = robot_system(robot, simulation, per_loss)
    layout, leg_p, held = leg_layout(system.kernel.shapes), system.leg_p.copy(), system.held.copy()
    for i, leg in enumerate(robot.legs):
        if leg.screw is not None and leg.screw.loops:
            for name, value in zip(("rotor_stiffness", "rotor_damping"), leg.screw.loop_spring, strict=True):
                leg_p[i, columns(layout, name)] = value
    for name in ("j", "w"):
        if system.kernel.shapes.has(name):
            held[:, system.kernel.shapes.index(name)] = True
    return replace(system, leg_p=leg_p, held=held)


def refuse_massless(study: Study) -> None:
    """Raise InputError if parts without mass leave coordinates that nothing but their stiffness determines."""
    simulation = study.simulation
    for i, leg in enumerate(study.robot.legs, start=1):
        still = leg.strut is not None or (leg.drive.holds and leg.holds_stroke)
        soft = {spring.at for spring in springs_along(leg)} - ({"base"} if leg.cylinder.mass else set())
        alone = simulation.axial_shapes(study.robot.legs[0].axial_modes) - still + len(soft & {"base", "platform"})
        if "base" in soft and not (still or simulation.lateral_shapes):
            raise InputError(
                f"of leg {i} has no mass between a base joint that gives way and a stroke that is free: along the leg "
                "both move the piston alone, which has statics and modes, but no motion in time",
                file=study.path,
                key="leg.cylinder.mass",
                value=0,
                allowed="0 in modes, stiffness, maps; in time with prescribed strokes or ideal base joints",
                next_step="Give a small mass, as 1e-3 kg: steps need not follow what is that light",
            )
        if leg.piston.rhoA == 0 and (simulation.lateral_shapes or alone > 0):
            raise InputError(
                f"of leg {i} leaves shapes of the piston without mass: they have statics, but no motion in time",
                file=study.path,
                key="leg.piston.rhoA",
                value=0,
                allowed='0 in modes, stiffness, maps; in time with "rigid", or "lumped" and prescribed strokes',
                next_step="Give a small rhoA, as 1e-6 kg/m: steps need not follow what is that light",
            )
