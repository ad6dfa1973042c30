"""Requirements on a first robot, a few quantities as typed, and its sizes."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, suggest_word
from flexapod.common.quantities import text
from flexapod.common.units import quantity
from flexapod.design.first_robot.demand import ALIASES, DEMANDS, RANGE, Demand, parse_demand
from flexapod.model import AXES, MATERIALS, base_circle, platform_circle

OPTION = "--from"
EXAMPLE = "home=300 mm, payload=20 kg, stroke=60 mm"
BOX_EXAMPLE = "travel=15 mm, tilt=3 deg, payload=25 kg"
IDEAL = "ideal"
CHOICES: dict[str, tuple[str, ...]] = {
    "material": tuple(MATERIALS),
    "motion": AXES,
    "drive": ("electric", "hydraulic", IDEAL),
}
_BETWEEN = re.compile(r";|,(?!\d)|\s+(?=[A-Za-z]+\s*=)")  # not the comma of 27,5 mm
_NUMBERS = {  # key: dimension, least, most [SI]
    "home": ("length", 0.01, 100.0),
    "payload": ("mass", 1e-3, 1e6),
    "stroke": ("length", 1e-6, 100.0),
    "base": ("length", 1e-3, 100.0),
    "platform": ("length", 1e-3, 100.0),
    "diameter": ("length", 1e-4, 10.0),
    "duration": ("time", 0.01, 1e4),
}


@dataclass(frozen=True, kw_only=True)
class Request:
    """Requirements on a first robot, SI; None is computed.

    `home`: height of the platform's joints above the base's; `payload`: mass with the platform; `stroke`: of a leg,
    from its shortest to its longest; `base`, `platform`: radii of the joints' circles; `diameter`: of the pistons;
    `duration`: of the motion; `drive`: what the legs are, "ideal" ones have exact drives and joints that do not give
    way; `demand`: what [requirement] says, and the box of poses that home and stroke follow from; `texts`: what was
    typed, by key.
    """

    home: float
    payload: float
    stroke: float | None = None
    base: float | None = None
    platform: float | None = None
    diameter: float | None = None
    duration: float | None = None
    material: str = "steel"
    motion: str = "heave"
    drive: str = "electric"
    demand: Demand | None = None
    texts: dict[str, str] = field(default_factory=dict)


def parse_request(text: str) -> Request:
    """A request from ``"home=300 mm, payload=20 kg, stroke=60 mm"`` or ``"travel=15 mm, tilt=3 deg, payload=25 kg"``.

    Raises
    ------
    InputError
        An unknown key, one that is given twice or missing, a value that is no such quantity or out of range.
    """
    given: dict[str, str] = {}
    for part in filter(None, (" ".join(piece.split()) for piece in _BETWEEN.split(text))):
        key, equals, value = (piece.strip() for piece in part.partition("="))
        key = key.lower()
        known = (*_NUMBERS, *CHOICES, *ALIASES, *DEMANDS)
        if key not in known:
            hint = suggest_word(key, known) or f'For example {OPTION} "{EXAMPLE}"'
            raise InputError("unknown key", key=OPTION, value=key, allowed=", ".join(known), next_step=hint)
        if not equals or not value or key in given:
            what = "is given twice" if key in given else "has no value"
            raise InputError(what, key=f"{OPTION} {key}", next_step=f'For example {OPTION} "{EXAMPLE}"')
        given[key] = value
    demand = parse_demand(given, OPTION)
    _check_given(given, demand)
    most = given if demand is None else {**given, "payload": given["payload"].split(RANGE)[-1].strip()}
    values = {key: _number(key, value) for key, value in most.items() if key in _NUMBERS}
    chosen = {key: _choice(key, given[key]) for key in CHOICES if key in given}
    return Request(**{"home": math.nan, **values}, **chosen, demand=demand, texts=given)  # type: ignore[arg-type]


def _check_given(given: dict[str, str], demand: Demand | None) -> None:
    """Refuse a request without its payload, without home or a box, and a stroke that a box has already."""
    boxed = demand is not None and bool(demand.ranges)
    for key in ("payload",) if boxed else ("home", "payload"):
        if key not in given:
            example = BOX_EXAMPLE if boxed else EXAMPLE
            raise InputError("is missing", key=f"{OPTION} {key}", next_step=f'For example {OPTION} "{example}"')
    if boxed and "stroke" in given:
        raise InputError(
            "follows from the poses that the robot must take", key=f"{OPTION} stroke", value=given["stroke"],
            allowed="a stroke, or travel and rotation", next_step="Leave one of them out",
        )  # fmt: skip


def _number(key: str, value: str) -> float:
    dimension, least, most = _NUMBERS[key]
    number = quantity(value, dimension, key=f"{OPTION} {key}")
    if not least <= number <= most:
        unit = {"length": "m", "mass": "kg", "time": "s"}[dimension]
        words = f"{least:g} to {most:g} {unit}"
        raise InputError("is out of range", key=f"{OPTION} {key}", value=value, allowed=words)
    return number


def _choice(key: str, value: str) -> str:
    if value not in CHOICES[key]:
        hint = suggest_word(value, CHOICES[key])
        words = ", ".join(CHOICES[key])
        raise InputError("is not known", key=f"{OPTION} {key}", value=value, allowed=words, next_step=hint)
    return value


BASE, PLATFORM = 0.6, 0.6  # base radius over home height, platform radius over base radius
HALF_ANGLE = 10.0  # between the joints of a pair, half [deg]: far from the singular hexagons at 30 deg
STROKE = 0.2  # of the home height, where none is given
MOUTH = 0.45  # of the home length
GUIDED, SPARE, FREE = 2.0, 1.0, 2.0  # diameters: guided at the longest, before the base joint, outside at the shortest
DENSITY = 2700.0  # of the payload's body, as of aluminium [kg/m^3]
WIDEST, FLATTEST = 1.5, 0.1  # radius of that body over the larger circle's; height over its radius
SAFETY = 5.0  # Euler load over the largest thrust; yield stress over the largest stress
SLENDER = 30.0  # largest free length over diameter
SHARE = 0.8  # of the half stroke that the motion uses
USED = 0.9  # of the half stroke, by a box of poses that is asked for
GROW = 1.05  # home height over that of the trial before
OUTER, BORE = 2.0, 1.2  # diameters of the cylinder over the piston's
#: Diameters of piston rods [m]: the series of ISO 3320, continued downwards by those of small shafts.
RODS = tuple(d * 1e-3 for d in (
    1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 25, 28, 32, 36, 40, 45, 50, 56, 63, 70, 80, 90, 100, 110,
    125, 140, 160, 180, 200, 220, 250, 280, 320, 360, 400, 450, 500, 560, 630, 700, 800, 900, 1000,
))  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Joints:
    """Radii of the joints' circles, home height and length of a leg at home [m]."""

    base: float
    platform: float
    height: float
    length: float

    @property
    def gap(self) -> float:
        """Distance between the two joints of a platform's pair [m]."""
        return 2 * self.platform * math.sin(math.radians(HALF_ANGLE))

    @property
    def digit(self) -> float:
        """Unit to which lengths are rounded: a hundred-thousandth to a ten-thousandth of the leg [m]."""
        return 10.0 ** (math.floor(math.log10(self.length)) - 4)


@dataclass(frozen=True, kw_only=True)
class Body:
    """The payload as a solid cylinder that stands on the platform: mass [kg], radius and height [m]."""

    mass: float
    radius: float
    height: float

    @property
    def inertia(self) -> tuple[float, float, float]:
        """Principal moments about the centre of mass [kg m^2]."""
        across = self.mass * (3 * self.radius**2 + self.height**2) / 12
        return across, across, self.mass * self.radius**2 / 2


@dataclass(frozen=True, kw_only=True)
class SizedLeg:
    """Lengths of a leg [m]: shortest, longest; mouth, piston's length and diameter."""

    shortest: float
    longest: float
    mouth: float
    piston: float
    diameter: float


def size_joints(request: Request) -> Joints:
    """Circles in proportion to the home height where they are not given."""
    base = request.base or round_significant(BASE * (request.home if request.platform is None else _wider(request)))
    platform = request.platform or round_significant(PLATFORM * base)
    half = math.radians(HALF_ANGLE)
    across = platform_circle(platform, half) - base_circle(base, half)
    length = float(np.hypot(np.linalg.norm(across[0]), request.home))
    return Joints(base=base, platform=platform, height=request.home, length=length)


def _wider(request: Request) -> float:
    """Home height, or what a given platform is in proportion to, if that is more."""
    return max(request.home, (request.platform or 0.0) / (BASE * PLATFORM))


def size_body(request: Request, joints: Joints) -> Body:
    """A body as wide as the platform, or as high as wide where it would be higher otherwise.

    Raises
    ------
    InputError
        It is wider than the robot.
    """
    m = request.payload
    compact = (m / (2 * math.pi * DENSITY)) ** (1 / 3)  # half as wide as high
    widest = WIDEST * max(joints.base, joints.platform)
    if compact > widest:
        most = 2 * math.pi * DENSITY * widest**3
        raise InputError(
            f"is too much for a robot of this size: a body of that mass is {text(2 * compact, 'm')} wide and high",
            key=f"{OPTION} payload",
            value=request.texts.get("payload", m),
            allowed=f"at most {most:.3g} kg with home = {text(request.home, 'm')}",
            next_step=f"Give a larger home, {text(1.01 * compact / WIDEST / BASE, 'm')} or more, or a smaller payload",
        )
    radius = round_significant(max(compact, joints.platform))
    height = max(m / (math.pi * DENSITY * radius**2), FLATTEST * radius)
    return Body(mass=m, radius=radius, height=round_significant(height))


def longest_stroke(joints: Joints, diameter: float) -> float:
    """The longest stroke of a leg whose piston slides out of a cylinder no longer than itself [m].

    Drawn in, the piston has `stroke` + `GUIDED` diameters in the cylinder, `SPARE` are free before the base joint, and
    `FREE` are outside; all that is as long as the shortest leg, half a stroke shorter than at home.
    """
    return (joints.length - (GUIDED + SPARE + FREE) * diameter) / 1.5


def size_leg(joints: Joints, stroke: float, diameter: float) -> SizedLeg | None:
    """Lengths of a leg for a stroke about home; None if it does not fit."""
    if stroke > longest_stroke(joints, diameter):
        return None
    digit = joints.digit
    shortest = round_down(joints.length - stroke / 2, digit)
    longest = round_up(joints.length + stroke / 2, digit)
    least, most = longest - shortest + (GUIDED + SPARE) * diameter, shortest - FREE * diameter
    mouth = round_down(max(min(MOUTH * joints.length, most), least), digit)
    piston = round_up(longest - mouth + GUIDED * diameter, digit)
    return SizedLeg(shortest=shortest, longest=longest, mouth=mouth, piston=piston, diameter=diameter)


def leg_stroke(request: Request) -> float:
    """Stroke of a leg [m]: given, or a share of the home height."""
    return request.stroke or round_significant(STROKE * request.home)


def cylinder_inertia(leg: SizedLeg, density: float) -> tuple[float, float, float]:
    """Mass [kg], centre of mass [m] and transverse inertia [kg m^2] of a tube from the base joint to the mouth."""
    outer, bore = OUTER * leg.diameter / 2, BORE * leg.diameter / 2
    mass = density * math.pi * (outer**2 - bore**2) * leg.mouth
    return mass, leg.mouth / 2, mass * (3 * (outer**2 + bore**2) + leg.mouth**2) / 12


def fitting_diameters(joints: Joints) -> Array:
    """Diameters that leave the cylinders of a pair a quarter of their width between them, (n,) [m]."""
    return np.array([d for d in RODS if 1.25 * OUTER * d <= joints.gap])


def round_significant(value: float) -> float:
    """Round to three significant digits."""
    return float(f"{value:.3g}")


def round_down(value: float, digit: float) -> float:
    """Round down to a multiple of `digit`."""
    return round(math.floor(value / digit) * digit, 12)


def round_up(value: float, digit: float) -> float:
    """Round up to a multiple of `digit`."""
    return round(math.ceil(value / digit) * digit, 12)
