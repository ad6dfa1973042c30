"""Variants of the paper's robots: values at keys of a preset's study file, in tables by what they show.

They read in other ways what the paper leaves open or says twice, and show what the deviation depends on.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import product
from typing import Any, Literal, cast

import numpy as np
from xarray import Dataset

from flexapod import kinematics, model
from flexapod.analysis.results.arguments import as_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.rigid_path import path_instants
from flexapod.analysis.results.time_history import Share
from flexapod.common.arrays import Array
from flexapod.common.tables.key_paths import parse_key
from flexapod.common.tables.toml import toml_text
from flexapod.model.file.key_paths import put
from flexapod.verification.paper.claim import ELASTIC_LENGTH, HEIGHT, axis_motion, roll_error
from flexapod.verification.paper.clamped_legs import equilibria_at_rolls
from flexapod.verification.paper.equilibrium_path import trial_along_path
from flexapod.verification.paper.trials import COLUMNS, TRIAL_STEP, trial

Preset = Literal["paper-robot", "paper-robot-radii"]
_UNITS = {"half_angle": "deg", "duration": "s", "drive_stiffness": "N m-1", "arm": "m", "roll": "deg"}


@dataclass(frozen=True, kw_only=True)
class Variant:
    """Variant of a preset: `values` at keys of its study file, then a `change` that no key says."""

    preset: Preset = "paper-robot"
    values: Mapping[str, object] = field(default_factory=dict)
    change: Callable[[model.Study], model.Study] | None = None

    @property
    def study(self) -> model.Study:
        """The study, read from the preset's text with these values in it."""
        study = model.preset(self.preset)
        if self.values:
            data = tomllib.loads(study.source_text)
            for key, value in self.values.items():
                put(data, parse_key(key, what="variant"), value)
            study = cast("model.Study", model.loads(toml_text(data)))
        return study if self.change is None else self.change(study)


@dataclass(frozen=True, kw_only=True)
class VariantTable:
    """Variants side by side.

    Attributes
    ----------
    along : mapping of str to sequence
        Labels by dimension; the variants are their product, the last varies fastest.
    variants : sequence of Variant
    columns : sequence of str
        Names of `COLUMNS`: what the table shows.
    shows : callable
        Columns of a study by name, from the study, their names, and the step of its simulation.
    step : float or None
        [s]; None: that of the study.
    coords : mapping
        More coordinates of the table.
    """

    along: Mapping[str, Sequence[str] | Sequence[float]]
    variants: Sequence[Variant]
    columns: Sequence[str]
    shows: Callable[[model.Study, Sequence[str], float | None], Mapping[str, Any]] = trial
    step: float | None = TRIAL_STEP
    coords: Mapping[str, Any] = field(default_factory=dict)


def compare(table: VariantTable, report: Share) -> Dataset:
    """Columns of a table of variants over its dimensions; with the study of the first one's preset."""
    rows = []
    for variant in table.variants:
        rows.append(table.shows(variant.study, table.columns, table.step))
        report(len(rows) / len(table.variants))
    shape, data = tuple(map(len, table.along.values())), {}
    for name in table.columns:
        values, (unit, _, dims) = np.array([row[name] for row in rows]), COLUMNS[name]
        units = {"units": unit} if unit else {}
        data[name] = ((*table.along, *dims), values.reshape(shape + values.shape[1:]), units)
    coords = {name: coordinate(name, labels) for name, labels in table.along.items()}
    step = {} if table.step is None else {"step": table.step}
    attrs = attributes(model.preset(table.variants[0].preset)) | step
    return Dataset(data, {**coords, "axis": list("xyz"), **table.coords}, attrs)


def coordinate(name: str, labels: Sequence[str] | Sequence[float]) -> tuple[Any, ...]:
    """Coordinate of a table along its own dimension."""
    return name, list(labels), {"units": _UNITS[name]} if name in _UNITS else {}


def extend_strokes(study: model.Study) -> model.Study:
    """Study with mouths and strokes moved just so far that no piston leaves its cylinder on the path."""
    robot, legs = study.robot, []
    longest = float(_lengths(robot, kinematics.poses(robot, study.motion, path_instants(study))).max())
    for leg in robot.legs:
        mouth = max(leg.cylinder.mouth, longest - leg.piston.length)
        stroke = model.Stroke(min=mouth, max=mouth + leg.piston.length)
        legs.append(leg.replace(stroke=stroke, cylinder=leg.cylinder.replace(mouth=mouth)))
    return study.replace(robot=robot.replace(legs=tuple(legs)))


def _lengths(robot: model.Robot, path: kinematics.Poses) -> Array:
    """Lengths (T, n) from joint to joint on a path [m]."""
    return kinematics.leg_lengths(robot.base_joints, robot.platform_joints, path.position, path.rotation)


HALF_ANGLES = (5.0, 10.0, 15.0, 20.0, 25.0, 27.0, 28.0, 29.0)  # deg; at 30 deg both circles are regular hexagons


def half_angle(preset: Preset, angle: float, **values: object) -> Variant:
    """Variant with other half-angles of the joint pairs [deg], base and platform alike, and other `values`."""
    circles = {
        f"robot.{end}": {"radius": radius, "half_angle": float(np.deg2rad(angle))}
        for end, radius in _radii(model.preset(preset).robot).items()
    }
    return Variant(preset=preset, values={**circles, **values}, change=extend_strokes)


def _radii(robot: model.Robot) -> dict[str, float]:
    """Radii [m] of the circles on which the joints of base and platform lie."""
    ends = {"base": robot.base_joints, "platform": robot.platform_joints}
    return {end: float(np.linalg.norm(joints[0])) for end, joints in ends.items()}


def half_angles(preset: Preset) -> VariantTable:
    """Half-angles of the joint pairs, with the equilibrium along the path and its frequency."""
    return VariantTable(
        along={"half_angle": HALF_ANGLES},
        variants=[half_angle(preset, angle) for angle in HALF_ANGLES],
        columns=("verdict", "deviation_peak", "force_peak", "load_share", "lowest_frequency", "sag"),
        shows=trial_along_path,
    )


MODULI = (20.0, 4.0, 3.5, 3.1)  # GPa; of 200 a digit lost, then towards and past the load under which legs buckle
CUBE = "com-cube"
#: Readings of Fig. 7: preset, turn [deg], and whether it goes to both sides of home. The first is the preset itself.
TRAVELS: dict[str, tuple[Preset, float, bool]] = {
    "diameters": ("paper-robot", 26.6, False),
    "diameters-both-sides": ("paper-robot", 26.6, True),
    "radii": ("paper-robot-radii", 30.0, False),
    "radii-both-sides": ("paper-robot-radii", 30.0, True),
    "radii-60-deg": ("paper-robot-radii", 60.0, False),
}
GUIDED = 0.15  # of a piston at home, as in the preset [m]


def readings() -> dict[str, Variant]:
    """Readings of the paper's values by name: none is left out because it was thought unlikely."""
    robot = model.preset("paper-robot").robot
    payload, rod, beam = robot.payload, robot.legs[0].cylinder, model.preset("paper-actuator").actuator
    mouth = float(robot.home_lengths[0]) - (ELASTIC_LENGTH - GUIDED)  # the cylinder: a uniform rod up to it
    uniform = {"mouth": mouth, "com": mouth / 2, "inertia": rod.mass * mouth**2 / 12}
    weak = {"EI": beam.EI, "EA": 12 * beam.EI / HEIGHT**2, "rhoA": beam.rhoA}  # about the weak axis of the beam
    heights = {"com-on-top": float(np.linalg.norm(payload.com)), CUBE: cube_edge(payload) / 2}
    values: dict[str, dict[str, object]] = {
        "table-2": {"leg.piston": {"length": robot.legs[0].piston.length, **weak}},
        **{f"modulus-{E:g}": {"leg.piston.E": f"{E:g} GPa"} for E in MODULI},
        **{name: {"payload.com": [0.0, 0.0, height]} for name, height in heights.items()},
        "inertia-of-platform": {"payload.inertia": nearest_body(inertia_about_com(payload)).tolist()},
    }
    whole = {"leg.piston.length": ELASTIC_LENGTH, **{f"leg.cylinder.{key}": x for key, x in uniform.items()}}
    return {
        "inextensible": Variant(values={"leg.axial_modes": 0}),
        "elastic-length": Variant(values=whole, change=extend_strokes),
        **{name: Variant(values=given) for name, given in values.items()},
        **{name: _travel(*reading) for name, reading in TRAVELS.items()},
    }


def readings_table() -> VariantTable:
    """Readings of the paper's values, one robot each."""
    variants = readings()
    return VariantTable(
        along={"reading": list(variants)},
        variants=list(variants.values()),
        columns=("verdict", "deviation_peak", "tip_peak", "force_peak", "load_share", "travel", "apart",
                 "stretch_stiffness"),
    )  # fmt: skip


def cube_edge(payload: model.Payload) -> float:
    """Edge of the cube with the payload's mass and largest moment of inertia [m]: I = m a^2 / 6."""
    return float(np.sqrt(6 * payload.inertia.max() / payload.mass))


def inertia_about_com(payload: model.Payload) -> Array:
    """Inertia (3, 3) about the centre of mass, were the given one about the platform's centre [kg m^2]."""
    d = payload.com
    return payload.inertia - payload.mass * (d @ d * np.eye(3) - np.outer(d, d))


def nearest_body(inertia: Array) -> Array:
    """The inertia with its largest principal moment lowered to the sum of the others, if it is larger."""
    moments, axes = np.linalg.eigh(inertia)
    moments[2] = min(moments[2], moments[0] + moments[1])
    return axes * moments @ axes.T


def _travel(preset: Preset, turn: float, both_sides: bool) -> Variant:
    """A roll to an angle [deg] in the preset's time, or from that angle on one side to the other in twice the time."""
    values: dict[str, object] = {"motion.amplitude": f"{turn:g} deg"}
    if both_sides:
        points = [{"time": time, "roll": f"{roll:g} deg"} for time, roll in (("1 s", -turn), ("3 s", turn))]
        values = {"motion": {"type": "waypoints", "hold": "1 s", "points": points}, "simulation.duration": "4 s"}
    return Variant(preset=preset, values=values, change=extend_strokes)


DURATIONS = (0.25, 0.5, 1.0, 2.0)  # s; from four times as fast as the preset to half as fast
SERVO_STIFFNESS = (3e5, 1e7)  # N/m; so soft that the payload sags by the size the paper prints; a usual ball screw


def assumptions(report: Share) -> Dataset:
    """Largest deviation of the robot under other durations of the motion and with yielding drives.

    Returns
    -------
    xarray.Dataset
        `deviation_by_duration` (duration, axis), `deviation_by_drive` (drive_stiffness, axis) [m]; `sag_by_drive`: the
        part of the latter that is there at rest, before the motion;
        `length_error` (leg) [m]: what the legs would have to be off for the paper's deviation.
    """
    share = len(DURATIONS) / (len(DURATIONS) + len(SERVO_STIFFNESS))
    study = model.preset("paper-robot")
    durations = VariantTable(
        along={"duration": DURATIONS},
        variants=[Variant(values={"motion.duration": x, "simulation.duration": x + 1.0}) for x in DURATIONS],
        columns=("deviation_peak",),
    )
    drives = VariantTable(
        along={"drive_stiffness": SERVO_STIFFNESS},
        variants=[Variant(values={"leg.drive": _servo(x, study.robot.payload.mass)}) for x in SERVO_STIFFNESS],
        columns=("deviation_peak", "home_sag"),
    )
    found = compare(durations, lambda done: report(share * done)).rename(deviation_peak="deviation_by_duration")
    others = compare(drives, lambda done: report(share + (1 - share) * done))
    found = found.assign(others.rename(deviation_peak="deviation_by_drive", home_sag="sag_by_drive"))
    return found.assign(length_error=("leg", _needed_errors(study), {"units": "m"}), leg=np.arange(1, 7))


def _servo(stiffness: float, mass: float) -> dict[str, object]:
    """Drive with a spring, damped at about a tenth of critical for a sixth of the payload."""
    return {"type": "servo", "stiffness": stiffness, "damping": 0.2 * float(np.sqrt(stiffness * mass / 6))}


def _needed_errors(study: model.Study) -> Array:
    """Leg-length errors (n,) [m] that move the CoM by the paper's deviation."""
    robot, roll = study.robot, axis_motion(study).target[3]
    rolls = (roll + roll_error(float(np.linalg.norm(robot.payload.com))), roll)
    off, there = (_lengths(robot, as_pose(robot, [0.0, 0.0, 0.0, x, 0.0, 0.0]))[0] for x in rolls)
    return off - there


#: Outer and inner diameter [mm]: the paper's, hollow ones of the same width, thinner ones.
PISTONS = ((27.0, 0.0), (27.0, 16.0), (27.0, 22.0), (27.0, 25.0), (20.0, 0.0), (15.0, 0.0), (10.0, 0.0))


def light_pistons() -> VariantTable:
    """Lighter and lighter pistons of the same material and length, with their `outer` and `inner` diameters [mm]."""
    widths = zip(("outer", "inner"), np.transpose(PISTONS), strict=True)
    return VariantTable(
        along={"piston": [piston_words(*pair) for pair in PISTONS]},
        variants=[piston(*pair) for pair in PISTONS],
        columns=("piston_mass", "payload_vibration", "tip_vibration", "lowest_frequency", "deviation_peak"),
        step=None,
        coords={name: ("piston", column) for name, column in widths},
    )


def piston(outer: float, inner: float) -> Variant:
    """Variant with round pistons of other diameters [mm]."""
    hollow = {"leg.piston.inner_diameter": f"{inner:g} mm"} if inner else {}
    return Variant(values={"leg.piston.diameter": f"{outer:g} mm", **hollow})


def piston_words(outer: float, inner: float) -> str:
    """A piston by its diameters [mm]."""
    return f"{outer:g} mm, {inner:g} mm hollow" if inner else f"{outer:g} mm"


#: Robots whose legs are clamped to the platform in place of ball joints: preset, and how many of the legs are.
CLAMPED: dict[str, tuple[Preset, int]] = {
    "diameters": ("paper-robot", 6),
    "radii": ("paper-robot-radii", 6),
    "diameters-one": ("paper-robot", 1),
    "radii-one": ("paper-robot-radii", 1),
}
ROLLS = tuple(map(float, range(31)))  # deg; each equilibrium is sought from the one before
ARMS = (0.2, 0.3, 0.373, 0.45, 0.6)  # m, of the centre of mass from the platform's centre
SHAPES = 6  # per plane: the static shapes of a force and of a moment at the tip, and those of thrust


def clamped_legs(arms: Sequence[float] = ARMS, rolls: Sequence[float] = ROLLS) -> VariantTable:
    """Equilibria with clamped legs over the circles' readings, the place of the centre of mass, and the roll."""
    return VariantTable(
        along={"reading": list(CLAMPED), "arm": arms},
        variants=[_clamped(*reading, arm) for reading, arm in product(CLAMPED.values(), arms)],
        columns=("deviation", "off_axis", "slope", "shortening", "leg_force", "stress"),
        shows=partial(equilibria_at_rolls, rolls),
        step=None,
        coords={"roll": coordinate("roll", rolls)},
    )


def _clamped(preset: Preset, count: int, arm: float) -> Variant:
    """Variant with the first `count` legs clamped, the centre of mass beside the platform's centre, in y [m]."""
    kind = {"robot.type": "6-UPF"} if count == 6 else {"robot.type": f"{count}-UPF+{6 - count}-UPS", "leg[1].count": 1}
    values = {**kind, "payload.com": [0.0, arm, 0.0], "simulation.modes": SHAPES}
    return Variant(preset=preset, values=values, change=extend_strokes)


def tripod() -> Variant:
    """Three of the legs of `paper-robot-radii` on hinges along the circle, with its height, payload and roll."""
    angles = np.deg2rad([0.0, 120.0, 240.0])
    out = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(3)])
    radii = _radii(model.preset("paper-robot-radii").robot)
    values = {
        "robot.type": "3-RPS",
        **{f"robot.{end}.joints": (radius * out).tolist() for end, radius in radii.items()},
        **{f"leg[{i}].base_joint.axis": [-y, x, 0.0] for i, (x, y, _) in enumerate(out.tolist(), start=1)},
        "motion.independent": ["heave", "roll", "pitch"],
    }
    return Variant(preset="paper-robot-radii", values=values, change=extend_strokes)
