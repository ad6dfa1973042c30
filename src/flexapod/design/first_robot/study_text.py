"""The study file of a first robot: every value with its reason."""

from __future__ import annotations

import math
from dataclasses import dataclass
from textwrap import wrap
from typing import Protocol

from flexapod import model
from flexapod.design.first_robot import sizing
from flexapod.design.first_robot.sizing import Body, Joints, Request, SizedLeg
from flexapod.model import MATERIALS

WIDTH = 110  # of a comment
LEG = "[leg]                        # all six legs alike; write [[leg]] six times for unequal ones"


class Parts(Protocol):
    """Components of the legs, where these are more than ideal."""

    sources: tuple[str, ...]

    def leg(self, plan: Plan) -> list[str]:
        """The table of the legs."""
        ...

    def tables(self, plan: Plan) -> list[str]:
        """Further tables, each behind an empty line: temperatures and tolerances of the machine."""
        ...


@dataclass(frozen=True, kw_only=True)
class Plan:
    """All that the file says: request, joints, payload's body, leg, `amplitude` [m or rad] and `duration` [s].

    `parts`: None of ideal joints and drives; `slow`: why the motion takes as long.
    """

    request: Request
    joints: Joints
    body: Body
    leg: SizedLeg
    amplitude: float
    duration: float
    parts: Parts | None = None
    slow: str = "joints of the platform accelerate by 1 m/s^2 at most"


def write_study_text(plan: Plan) -> str:
    """The commented study file."""
    request, parts = plan.request, plan.parts
    asked = ", ".join(f"{key}={value}" for key, value in request.texts.items())
    return "\n".join([
        *comment_lines(f'A first robot, from "{asked}".'),
        *comment_lines(
            "Values are marked as given, computed or chosen, with the reason. It is a beginning: put in what you know "
            "better, then `flexapod check` says what it means. Numbers are in SI units; text carries its unit."
        ),
        *(line for source in (parts.sources if parts else ()) for line in comment_lines(source)),
        "", *_robot(plan), "", *_payload(plan.body), "", *(parts.leg(plan) if parts else _leg(plan)), "",
        *_motion(plan), "", *(parts.tables(plan) if parts else ()), *_requirement(request),
        "[simulation]",
        'fidelity = "assumed-modes"   # legs bend and stretch; "lumped" (stretch only) is faster',
        "modes = 3                    # shapes per lateral plane; `flexapod converge` says which number will do",
        'tolerance = 1e-4             # relative error of the step control; or step = "0.5 ms"',
        "",
    ])  # fmt: skip


def comment_lines(text: str) -> list[str]:
    """Lines of comment."""
    return [f"# {line}" for line in wrap(text, WIDTH)]


def value_origin(value: object, computed: str) -> str:
    """Origin of a value as text: given, or how it was computed."""
    return "given" if value else f"computed, {computed}"


def stroke_origin(request: Request) -> str:
    """Origin of the stroke as text: given, or how it was computed."""
    if request.demand is not None and request.demand.ranges:
        left = 50 * (1 - sizing.USED)
        return (
            "computed, twice what the legs stretch or shrink at most over the box of [requirement], and "
            f"{left:g} % of it left at either end"
        )
    return value_origin(request.stroke, f"{sizing.STROKE:g} of the home height")


def _requirement(request: Request) -> list[str]:
    return [] if request.demand is None else [*request.demand.lines, ""]


def _robot(plan: Plan) -> list[str]:
    request, joints = plan.request, plan.joints
    base = value_origin(request.base, f"{sizing.BASE:g} of the home height: legs lean and hold sideways as well")
    platform = value_origin(request.platform, f"{sizing.PLATFORM:g} of the base's radius")
    height = value_origin(
        "home" in request.texts or not request.texts,
        f"the least, in steps of {100 * (sizing.GROW - 1):.0f} %, whose legs have room for their stroke",
    )
    angle = f'half_angle = "{sizing.HALF_ANGLE:g} deg"'
    return [
        "[robot]",
        'type = "6-UPS"               # universal joint on the base, prismatic leg, spherical joint on the platform',
        f'base     = {{ radius = "{length_text(joints.base)}", {angle} }}   # {base}',
        f'platform = {{ radius = "{length_text(joints.platform)}", {angle} }}   # {platform}',
        *comment_lines("half_angle: chosen, joints in close pairs are far from the singular arrangement at 30 deg"),
        f'home_height = "{length_text(joints.height)}"   # {height}; legs are then {1e3 * joints.length:.4g} mm long',
        "gravity = [0, 0, -9.81]      # m/s^2, z up",
    ]


def _payload(body: Body) -> list[str]:
    moments = ", ".join(f"{moment:.4g}" for moment in body.inertia)
    density = body.mass / (math.pi * body.radius**2 * body.height)
    shape = f"{length_text(2 * body.radius)} wide and {length_text(body.height)} high ({density:.3g} kg/m^3)"
    return [
        "[payload]                    # the platform and all it carries",
        f'mass = "{body.mass:.10g} kg"   # given',
        *comment_lines(f"inertia, com, tool: computed for a solid cylinder that stands on the platform, {shape}"),
        f"inertia = [{moments}]   # kg m^2 about the centre of mass",
        f'com = [0, 0, "{length_text(body.height / 2)}"]   # the middle, from the platform\'s centre',
        f'tool = [0, 0, "{length_text(body.height)}"]   # the top: the point you care about',
    ]


def _leg(plan: Plan) -> list[str]:
    request, leg = plan.request, plan.leg
    mass, com, inertia = sizing.cylinder_inertia(leg, MATERIALS[request.material].density)
    diameter = value_origin(
        request.diameter,
        f"the thinnest rod of the series of ISO 3320 that is {sizing.SAFETY:g} times safe against buckling at its "
        f"longest, and against yield, and is no longer outside than {sizing.SLENDER:g} times its width",
    )
    return [
        LEG,
        f'cylinder = {{ mass = "{mass:.4g} kg", com = "{length_text(com)}", inertia = {inertia:.4g}, '
        f'mouth = "{length_text(leg.mouth)}" }}',
        *comment_lines(
            f"mouth: computed, {sizing.MOUTH:g} of the leg at home, but as deep as the piston needs when drawn in, and "
            "two widths of the piston stay outside"
        ),
        *comment_lines(
            f"mass, com, inertia: computed for a tube of {request.material} from the base joint to the mouth, twice as "
            "wide as the piston"
        ),
        f'piston = {{ diameter = "{length_text(leg.diameter)}", length = "{length_text(leg.piston)}", '
        f'material = "{request.material}" }}',
        *comment_lines(f"diameter: {diameter}"),
        *comment_lines("length: computed, as far as it comes out and two widths that stay guided"),
        *comment_lines(material_words(request)),
        f'stroke = {{ min = "{length_text(leg.shortest)}", max = "{length_text(leg.longest)}" }}   # joint to joint',
        *comment_lines(f"stroke: {stroke_origin(request)}; half of it either way from home"),
        "damping = 0.005              # chosen: 0.5 % of the critical one is usual for bare metal",
        'drive = { type = "prescribed" }  # chosen: the stroke follows its command exactly; or "servo", "force"',
    ]


def material_words(request: Request) -> str:
    """Origin of the material as text: given, or chosen and the others."""
    others = ", ".join(name for name in MATERIALS if name != request.material)
    return f"material: {'given' if 'material' in request.texts else f'chosen, or {others}'}"


def _motion(plan: Plan) -> list[str]:
    request = plan.request
    turning = request.motion in model.AXES[3:]
    amplitude = f"{math.degrees(plan.amplitude):.6g} deg" if turning else length_text(plan.amplitude)
    others = " ".join(axis for axis in model.AXES if axis != request.motion)
    seconds = f'"{plan.duration:.6g} s"'
    slow = value_origin(request.duration, plan.slow)
    return [
        "[motion]",
        f'type = "{request.motion}"   # {"given" if "motion" in request.texts else "chosen"}; or {others}',
        f'amplitude = "{amplitude}"   # computed, {100 * sizing.SHARE:g} % of what the stroke allows from home',
        f"duration = {seconds}   # {slow}",
        f"hold = {seconds}   # as long: shows the vibration after the motion",
        'profile = "quintic"          # from rest to rest with a continuous acceleration',
    ]


def length_text(value: float) -> str:
    """Length as text in m or mm."""
    return f"{value:.10g} m" if value >= 1 else f"{1e3 * value:.10g} mm"
