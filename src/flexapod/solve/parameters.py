"""Physical parameters of a model as the flat vectors that kernels read."""

import numpy as np

from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES, FREE, Limbs
from flexapod.mechanics.elements.element import LegContext
from flexapod.mechanics.elements.mount import plate_mass
from flexapod.mechanics.elements.springs import viscous
from flexapod.mechanics.elements.trial import refuse_numbers
from flexapod.mechanics.leg import layout
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, PAYLOAD_PARAMETERS, Shapes
from flexapod.model import Actuator, ForceDrive, Leg, Mounted, Robot, ServoDrive, damping_parts
from flexapod.solve.sections import section_parameters

ENDLESS = 1e4  # m, beyond the reach of any leg


def _pack(layout: tuple[tuple[str, int], ...], values: dict[str, object]) -> Array:
    parts = [np.asarray(values[name], dtype=float).ravel() for name, _ in layout]
    for (name, size), part in zip(layout, parts, strict=True):
        if part.size != size:
            raise ValueError(f"parameter {name} needs {size} numbers, got {part.size}")
    return np.concatenate(parts)


def drive_spring(leg: Leg, *, at_rest: bool = False) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] between command and stroke; zero where the stroke is prescribed.

    ``at_rest``: a loop about the stroke is a spring on that, Eq. (T23.55).
    """
    if at_rest and leg.closed_about and leg.screw is not None and not leg.screw.rests:
        return leg.screw.loop_spring
    if leg.gives:
        return 0.0, 0.0  # between command and rotor
    match leg.drive:
        case ServoDrive(stiffness=stiffness, damping=damping):
            return stiffness, damping
        case ForceDrive(feedback=feedback) if feedback is not None:
            return feedback.stiffness, feedback.damping
    return 0.0, 0.0


def leg_parameters(robot: Robot, legs: Limbs, shapes: Shapes, per_loss: float = 0.0, *, at_rest: bool = False) -> Array:
    """Parameters of the legs in kernel order, (legs, size of `layout.leg_parameters`).

    ``per_loss`` [s]: viscous damping over stiffness of a spring of loss factor 1, see `losses`.
    """
    layout_of_legs = layout.leg_parameters(shapes)
    standing = standings(robot, legs, per_loss, at_rest=at_rest)
    rows = (
        _leg(leg, at_rest=at_rest)
        | _place(robot, legs, i)
        | _joints(leg, legs, i, per_loss)
        | (section_parameters(leg, shapes.beam, legs.home[i, COORDINATES.index("l")]) if shapes.beam.sections else {})
        | _of_elements(leg, shapes, standing[i])
        | _inside(leg, per_loss)
        for i, leg in enumerate(robot.legs)
    )
    turns = [COORDINATES.index(name) for name in ("spin", "gamma3")]
    loose = legs.pose_closure & (shapes.has("t") | (legs.state[:, turns] == FREE).all(axis=1))
    # what twists, or turns between two springs, has an inertia: that of a round section where none is given
    with_inertia = zip(rows, robot.legs, loose, strict=True)
    rows = (row | {"piston_axial_inertia": axial_inertia(leg)} if own else row for row, leg, own in with_inertia)
    return np.array([_pack(layout_of_legs, values) for values in rows])


def standings(robot: Robot, legs: Limbs, per_loss: float, *, at_rest: bool) -> list[LegContext]:
    """Circumstances of each leg, for the parameters of its elements."""
    found = []
    for i in range(len(legs)):
        beta = legs.home[i, COORDINATES.index("beta")]
        along = np.array([[np.cos(beta), 0, np.sin(beta)], [0, 1, 0], [-np.sin(beta), 0, np.cos(beta)]])
        axes = {
            "base": (legs.frames[i].T, along),
            "platform": (legs.platform_frames[i].T, legs.leg_frames[i].T),
        }
        length = float(legs.home[i, COORDINATES.index("l")])
        found.append(LegContext(length, per_loss, at_rest, robot, bool(legs.pose_closure[i]), axes))
    return found


def _leg(leg: Leg, *, at_rest: bool) -> dict[str, object]:
    """Bodies and drive of a leg."""
    zeta, damping_time = damping_parts(leg.damping)
    spring = drive_spring(leg, at_rest=at_rest)
    stroke, carriage = (spring if leg.driven == what else (0.0, 0.0) for what in ("stroke", "carriage"))
    foot = leg.carriage
    return {
        "rhoA": leg.piston.rhoA,
        "EI": leg.piston.EI,
        "EA": leg.piston.EA,
        "Lp": leg.piston.length,
        "mouth": leg.cylinder.mouth,
        "piston_axial_inertia": leg.piston.axial_inertia,
        "cylinder_mass": leg.cylinder.mass,
        "cylinder_com": leg.cylinder.com,
        "cylinder_inertia": leg.cylinder.inertia,
        "cylinder_axial_inertia": leg.cylinder.axial_inertia,
        "cylinder_spins": float(leg.letters.stroke != "C"),
        "zeta": zeta,
        "damping_time": damping_time,
        "drive_stiffness": stroke[0],
        "drive_damping": stroke[1],
        "carriage_mass": 0.0 if foot is None else foot.mass,
        "carriage_inertia": 0.0 if foot is None else foot.inertia,
        "carriage_stiffness": carriage[0],
        "carriage_damping": carriage[1],
        "tip_mass": 0.0,
        "tip_inertia": 0.0,
    }


def axial_inertia(leg: Leg) -> float:
    """Inertia of a piston about its axis, as given or 2 rho I L of a round section [kg m^2]."""
    piston = leg.piston
    if piston.sections and not piston.axial_inertia:
        return sum(step.length * step.rhoA * sum(step.EI) / step.EA for step in piston.steps)
    return piston.axial_inertia or 2 * piston.rhoA * piston.length * piston.EI / piston.EA


def _place(robot: Robot, legs: Limbs, i: int) -> dict[str, object]:
    """Parameters of a leg's place at home; frames column by column."""
    return {
        "gravity": robot.gravity,
        "base": legs.base[i],
        "R0": legs.frames[i].T,
        "carriage_axis": legs.carriage_axis[i],
        "carriage_arm": legs.carriage_arm[i],
        "carriage_com": _crank_com(robot.legs[i], legs.carriage_arm[i]),
        "joint": legs.platform[i] - robot.com,
        "platform_frame": legs.platform_frames[i].T,
        "leg_frame": legs.leg_frames[i].T,
        "L_c": legs.L_c,
    }


def _crank_com(leg: Leg, arm: Array) -> Array:
    """Centre of mass of a crank from its shaft at home, (3,)."""
    if leg.carriage is None or not leg.carriage.com:
        return np.zeros(3)
    return leg.carriage.com / np.linalg.norm(arm) * arm


def _joints(leg: Leg, legs: Limbs, i: int, per_loss: float) -> dict[str, object]:
    """Springs at the joints of a leg, where they are slack (at home), and their dampers."""
    home = dict(zip(COORDINATES, legs.home[i], strict=True))
    values: dict[str, object] = {}
    for end, joint in (("base", leg.base_joint), ("gamma", leg.platform_joint)):
        springs = (joint.bending, joint.bending, joint.torsion)
        values[f"{end}_stiffness"] = [k or 0.0 for k in springs]
        values[f"{end}_damping"] = [
            viscous(k, joint.damping or 0.0, joint.loss, per_loss) if k else 0.0 for k in springs
        ]
    return {
        **values,
        "base_home": [home[name] for name in ("alpha", "beta", "spin")],
        "gamma_home": [home[name] for name in ("gamma1", "gamma2", "gamma3")],
    }


def _of_elements(leg: Leg, shapes: Shapes, standing: LegContext) -> dict[str, object]:
    found: dict[str, object] = {}
    known = dict(layout.leg_parameters(shapes))
    for element in shapes.elements:
        given = element.numbers(leg, standing)
        if element.kind.at:
            refuse_numbers(element, given, known)
        found |= given
    return found


def _inside(leg: Leg, per_loss: float) -> dict[str, object]:
    """Bushings of the piston and bending of the cylinder; without them a piece of no mass that never ends."""
    guide, cylinder, piston = leg.guide, leg.cylinder, leg.piston
    section = cylinder.section
    EI, _, rhoA = cylinder.beam
    body = cylinder.body or Mounted(mass=0.0)
    springs = [] if guide is None else [guide.gland, guide.head]
    return {
        "guide_reach": cylinder.mouth + piston.length if guide is not None else ENDLESS,
        "guide_rhoA": piston.rhoA if guide is not None else 0.0,
        "guide_EI": piston.EI if guide is not None else 0.0,
        "guide_stiffness": springs or [0.0, 0.0],
        "guide_damping": [viscous(k, guide and guide.damping, guide and guide.loss, per_loss) for k in springs]
        or [0.0, 0.0],
        "cylinder_length": cylinder.mouth if EI else 1.0,
        "cylinder_EI": EI,
        "cylinder_rhoA": rhoA,
        "cylinder_turning": rhoA * section.second_moment / section.area if section is not None else 0.0,
        "mounted_mass": body.mass,
        "mounted_com": body.com,
        "mounted_inertia": body.inertia,
    }


def payload_parameters(robot: Robot, shapes: Shapes, *, at_rest: bool = False) -> Array:
    """Parameters of the payload, and of the plate below it where it stands on a mount; tool from its CoM."""
    load, below = robot.payload, robot.platform_mount
    mass, inertia = (0.0, np.zeros((3, 3))) if below is None else plate_mass(robot, below, at_rest=at_rest)
    if load is None:  # a fixed platform: without weight, and what does not move needs no mass
        mass = {"mass": 1.0, "inertia": np.eye(3), "gravity": np.zeros(3), "tool": np.zeros(3)}
        return _pack(PAYLOAD_PARAMETERS, mass)
    return _pack(
        layout.payload_parameters(shapes),
        {
            "mass": load.mass,
            "inertia": load.inertia.T,
            "gravity": robot.gravity,
            "tool": load.tool - load.com,
            "plate_mass": mass,
            "plate_inertia": inertia,
            "plate_weighs": 0.0 if below is None else below.mass,
            "plate_at": 0.0 if below is None else below.at - robot.com,
        },
    )


#: Axes of the planar actuator's leg frame in the plane of motion (X right, Y up): z_leg = X, x_leg = Y, so y_leg = Z.
PLANE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


#: ... in space: alpha turns about Z, beta towards Z, so x_leg = Z, z_leg = X, y_leg = -Y.
SPACE = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])


def actuator_parameters(actuator: Actuator, shapes: Shapes) -> Array:
    """Parameters of a single actuator in kernel order, (1, any)."""
    values: dict[str, object] = dict.fromkeys((name for name, size in LEG_PARAMETERS if size == 1), 0.0)
    zeta, damping_time = damping_parts(actuator.damping)
    values |= {
        "rhoA": actuator.rhoA,
        "EI": actuator.EI,
        "EA": actuator.EA or 1.0,  # of an inextensible beam no axial shape reads it
        "GJ": actuator.GJ,
        "piston_axial_inertia": actuator.axial_inertia,
        "Lp": actuator.length,
        "mouth": actuator.hub_radius,
        "cylinder_inertia": actuator.hub_inertia,
        "cylinder_axial_inertia": actuator.hub_axial_inertia,
        "zeta": zeta,
        "damping_time": damping_time,
        "gravity": -actuator.gravity * np.array([0.0, 0.0, 1.0] if actuator.space else [0.0, 1.0, 0.0]),
        "base": np.zeros(3),
        "R0": (SPACE if actuator.space else PLANE).T,
        "tip_mass": actuator.tip_mass,
        "tip_inertia": actuator.tip_inertia,
        "tip_axial_inertia": actuator.tip_axial_inertia,
    }
    return _pack(layout.leg_parameters(shapes), values)[None, :]
