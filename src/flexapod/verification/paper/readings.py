"""Readings of the paper: other values for what it leaves open or says in two ways, one robot each; a tripod."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod import model
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.verification.paper.claim import ELASTIC_LENGTH, HEIGHT, axis_motion
from flexapod.verification.paper.trials import extend_strokes

MODULI = (20.0, 4.0, 3.5, 3.1)  # GPa; of 200 a digit lost, then towards and past the load under which legs buckle
CUBE = "com-cube"
#: Readings of Fig. 7: preset, turn [deg], and whether it goes to both sides of home. The first is the preset itself.
TRAVELS = {
    "diameters": ("paper-robot", 26.6, False),
    "diameters-both-sides": ("paper-robot", 26.6, True),
    "radii": ("paper-robot-radii", 30.0, False),
    "radii-both-sides": ("paper-robot-radii", 30.0, True),
    "radii-60-deg": ("paper-robot-radii", 60.0, False),
}
GUIDED = 0.15  # of a piston at home, as in the preset [m]


def readings() -> dict[str, model.Study]:
    """The readings by name, all of the preset `paper-robot` but for those that say otherwise."""
    study = robot_preset("paper-robot")
    payload = study.robot.payload
    edge = cube_edge(payload)
    return {
        "inextensible": with_legs(study, lambda leg: leg.replace(axial_modes=0)),
        "elastic-length": with_whole_piston(study, ELASTIC_LENGTH),
        "table-2": with_legs(study, lambda leg: leg.replace(piston=_beam_of_table_2(leg.piston.length))),
        **{f"modulus-{E:g}": with_modulus(study, 1e9 * E) for E in MODULI},
        "com-on-top": _with_com(study, float(np.linalg.norm(payload.com))),
        CUBE: _with_com(study, edge / 2),
        "inertia-of-platform": _with_payload(study, payload.replace(inertia=_nearest_body(inertia_about_com(payload)))),
        **{name: _travelling(*reading) for name, reading in TRAVELS.items()},
    }


def cube_edge(payload: model.Payload) -> float:
    """Edge of the cube with the payload's mass and largest moment of inertia [m]: I = m a^2 / 6."""
    return float(np.sqrt(6 * payload.inertia.max() / payload.mass))


def inertia_about_com(payload: model.Payload) -> Array:
    """Inertia (3, 3) about the centre of mass, were the given one about the platform's centre [kg m^2]."""
    d = payload.com
    return payload.inertia - payload.mass * (d @ d * np.eye(3) - np.outer(d, d))


def with_whole_piston(study: model.Study, length: float) -> model.Study:
    """Pistons of this whole length [m], guided at home as before; cylinders are uniform rods up to their mouths."""
    home = study.robot.home_lengths[0]

    def change_leg(leg: model.Leg) -> model.Leg:
        mouth = home - (length - GUIDED)
        rod = leg.cylinder.replace(mouth=mouth, com=mouth / 2, inertia=leg.cylinder.mass * mouth**2 / 12)
        return leg.replace(piston=leg.piston.replace(length=length), cylinder=rod, stroke=None)

    return with_legs(study, change_leg)


def with_modulus(study: model.Study, E: float) -> model.Study:
    """Pistons of the same section and density with another elastic modulus [Pa]."""
    return with_legs(study, lambda leg: leg.replace(piston=leg.piston.replace(E=E)))


def _beam_of_table_2(length: float) -> model.Piston:
    """A piston with the bending stiffness and mass of the single actuator's beam, about its weak axis."""
    beam = model.preset("paper-actuator").actuator
    return model.Piston(length=length, EI=beam.EI, EA=12 * beam.EI / HEIGHT**2, rhoA=beam.rhoA)


def _travelling(preset: str, turn: float, both_sides: bool) -> model.Study:
    """A roll to an angle [deg] in the preset's time, or from that angle on one side to the other in twice the time."""
    study = robot_preset(preset)
    motion, roll = axis_motion(study), float(np.deg2rad(turn))
    if not both_sides:
        return extend_strokes(study.replace(motion=motion.replace(amplitude=roll)))
    time = motion.duration
    points = (model.Waypoint(time=time, roll=-roll), model.Waypoint(time=3 * time, roll=roll))
    way = model.WaypointMotion(points=points, hold=motion.hold)
    return extend_strokes(study.replace(motion=way, simulation=study.simulation.replace(duration=way.end_time)))


def _nearest_body(inertia: Array) -> Array:
    """The inertia with its largest principal moment lowered to the sum of the others, if it is larger."""
    moments, axes = np.linalg.eigh(inertia)
    moments[2] = min(moments[2], moments[0] + moments[1])
    return axes * moments @ axes.T


def _with_com(study: model.Study, height: float) -> model.Study:
    """Centre of mass and tool at a height above the platform's centre [m]."""
    up = [0.0, 0.0, height]
    return _with_payload(study, study.robot.payload.replace(com=up, tool=up))


def _with_payload(study: model.Study, payload: model.Payload) -> model.Study:
    return study.replace(robot=study.robot.replace(payload=payload))


def with_legs(study: model.Study, change: Callable[[model.Leg], model.Leg]) -> model.Study:
    """Study with every leg changed."""
    return study.replace(robot=study.robot.replace(legs=tuple(change(leg) for leg in study.robot.legs)))


def robot_preset(name: str) -> model.Study:
    """A preset of a robot.

    Raises
    ------
    InputError
        The name of another preset.
    """
    study = model.preset(name)
    if isinstance(study, model.Study):
        return study
    raise InputError("is the preset of a single actuator", key="preset", value=name, allowed="presets of robots")


def actuator_preset() -> model.ActuatorStudy:
    """The preset of the single actuator.

    Raises
    ------
    InputError
        It is that of a robot.
    """
    study = model.preset("paper-actuator")
    if isinstance(study, model.ActuatorStudy):
        return study
    raise InputError("is the preset of a robot", key="preset", value="paper-actuator")


ANGLES = np.deg2rad([0.0, 120.0, 240.0])  # of the hinges, which lie along the circle


def tripod() -> model.Study:
    """Three of the legs of `paper-robot-radii` on hinges, with its circles, height, payload and roll."""
    study = robot_preset("paper-robot-radii")
    robot, motion = study.robot, axis_motion(study)
    out = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(3)])
    hinges = (model.Joint(axis=np.array([-y, x, 0.0])) for x, y, _ in out)
    legs = tuple(leg.replace(chain="RPS", base_joint=hinge) for leg, hinge in zip(robot.legs, hinges, strict=False))
    base, platform = (np.linalg.norm(joints, axis=1)[0] for joints in (robot.base_joints, robot.platform_joints))
    three = robot.replace(type="3-RPS", base_joints=base * out, platform_joints=platform * out, legs=legs)
    return extend_strokes(study.replace(robot=three, motion=motion.replace(independent=("heave", "roll", "pitch"))))
