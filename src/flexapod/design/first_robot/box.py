"""Home height and stroke of a first robot that takes all poses of a box."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from flexapod import model
from flexapod.analysis.checks.envelope import envelope
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.design.first_robot import sizing
from flexapod.design.first_robot.sizing import OPTION, Body, Demand, Joints, Request
from flexapod.kinematics.envelope import LOOKS, Spans, extremes
from flexapod.model import base_circle, platform_circle

STEPS = 50  # trials of a robot, at most
HEIGHT = 4.0  # home height over the largest travel, at first
LOWEST, HIGHEST = 0.01, 100.0  # home heights [m]
LEAST_SINGULAR = 0.1  # singular value in the box
SHARES = 7  # halvings on the way to the largest share of a box

Make = Callable[[Request], str]


def boxed_robot(request: Request, make: Make) -> str:
    """The text of the smallest robot that takes all poses of the box of a request, `make` writes one of a stroke.

    The stroke is twice what the legs stretch or shrink at most, over `sizing.USED`; home grows by `sizing.GROW` until
    parts fit. A home that is given stays.

    Raises
    ------
    InputError
        No robot does it; with the largest box at a home that is given, and the reason.
    """
    demand: Demand = request.demand  # type: ignore[assignment]
    given = not math.isnan(request.home)
    found = _smallest(request, demand, make, [request.home] if given else _homes(demand))
    if isinstance(found, str):
        return found
    raise _too_low(request, demand, make, found) if given else _too_large(request, found)


def robot_of_home(request: Request, make: Make, home: float) -> str | None:
    """The text of the robot of a home height that takes the box; None where parts do not fit."""
    found = _smallest(request, request.demand, make, [home])  # type: ignore[arg-type]
    return found if isinstance(found, str) else None


def _homes(demand: Demand, least: float = LOWEST) -> Iterator[float]:
    """Home heights to try, to four digits."""
    ends = [end for axis in model.AXES[:3] if axis in demand.ranges for end in demand.ranges[axis]]
    home = max(HEIGHT * max(map(abs, ends), default=0.0), LOWEST)
    while home <= HIGHEST:
        if home >= least:
            yield float(f"{home:.4g}")
        home *= sizing.GROW


def _smallest(request: Request, demand: Demand, make: Make, homes: Iterator[float] | list[float]) -> str | InputError:
    """The text of the first robot that takes the box, or why the last that was tried does not."""
    last = InputError("is larger than any robot", key=f"{OPTION} travel", next_step="Give less travel")
    trials = 0
    for home in homes:
        try:
            wish = _with_stroke(replace(request, home=home, demand=demand))
        except InputError as error:  # a body that is too large for it
            last = error
            continue
        if wish is None:
            last = _no_room(request, home)
            continue
        if trials == STEPS:
            break
        trials += 1
        try:
            written = make(wish)
        except InputError as error:
            last = error
            if "home" not in f"{error.key} {error.next_step}":
                break  # a larger robot would not help
            continue
        error = _box_error(written, wish)
        if error is None:
            return written
        last = error
    return last


def _with_stroke(request: Request) -> Request | None:
    """The request with the stroke of its box; None where no piston, however thin, has room for it."""
    joints = sizing.size_joints(request)
    largest = excursion(joints, sizing.size_body(request, joints), request.demand)  # type: ignore[arg-type]
    stroke = float(f"{2 * largest / sizing.USED:.4g}")
    room = sizing.fitting_diameters(joints)
    if not room.size or stroke > sizing.longest_stroke(joints, float(room[0])):
        return None
    return replace(request, stroke=stroke)


def excursion(joints: Joints, body: Body, demand: Demand) -> float:
    """Largest change of a leg's length from home over a box [m], at tilts of a grid and all travel, (T2.50)."""
    half = math.radians(sizing.HALF_ANGLE)
    foot = base_circle(joints.base, half)
    tip = platform_circle(joints.platform, half)
    box = demand.box(body.height)
    spans = Spans(foot=box.pivot + np.array([0.0, 0.0, joints.height]) - foot, arm=tip - box.pivot)
    largest = 0.0
    for one in box.separate():
        least, most, _, _ = extremes(spans, one, one.grid_poses(LOOKS, np.arange(6) >= 3)[:, 3:])
        largest = max(largest, float((most - joints.length).max()), float((joints.length - least).max()))
    return largest


def _box_error(written: str, request: Request) -> InputError | None:
    """Reason why the robot of a text does not take the box; None where it does."""
    study: model.Study = model.loads(written)  # type: ignore[assignment]
    found = envelope(study.robot, request.demand.box(float(study.robot.payload.tool[2])))  # type: ignore[union-attr]
    why = None
    if found.answer == "no":
        why = f"is out of its reach: leg {found.worst.leg} or its joints leave their limits"
    elif found.singularity.value < LEAST_SINGULAR:
        why = f"is too near to a singular pose: singular value {found.singularity.value:.2g} at least"
    elif found.clearance is not None and found.clearance.value < 0:
        why = f"lets legs meet, by {text(-found.clearance.value, 'm')}"
    if why is None:
        return None
    return InputError(why, key=_box_key(request), allowed="a smaller box", next_step="Give less travel or rotation")


def _box_key(request: Request) -> str:
    keys = [key for key in ("travel", "rotation", "tilt", *model.AXES) if key in request.texts]
    return f"{OPTION} {' '.join(keys)}"


def _no_room(request: Request, home: float) -> InputError:
    return InputError(
        f"is too large for legs that go with home = {text(home, 'm')}", key=_box_key(request),
        allowed="a stroke of less than two thirds of the leg", next_step="Give less travel or rotation",
    )  # fmt: skip


def _too_large(request: Request, last: InputError) -> InputError:
    """No robot of any size does it: the reason of the last one that was tried."""
    return InputError(
        f"{last.what}; home grew with the box of poses as far as that helps", key=last.key, value=last.value,
        allowed=last.allowed,
        next_step="Give less travel or rotation, a smaller payload, or drive=hydraulic, or --ideal",
    )  # fmt: skip


def _too_low(request: Request, demand: Demand, make: Make, last: InputError) -> InputError:
    """The home that is given is too low: how much of the box it takes, and the home that all of it needs."""
    needed = _smallest(request, demand, make, _homes(demand, request.home))
    share, step = 0.0, 1.0
    for _ in range(SHARES):
        step /= 2
        ranges = {axis: (low * (share + step), high * (share + step)) for axis, (low, high) in demand.ranges.items()}
        if isinstance(_smallest(request, replace(demand, ranges=ranges), make, [request.home]), str):
            share += step
    best = f"{100 * share:.3g} % of the box on all axes" if share else "no box at all"
    home = "" if isinstance(needed, InputError) else text(_home_of(needed), "m", 4)
    return InputError(
        f"does not go with the box of poses: {best} with this home. With all of it: {last.key} {last.what}",
        key=f"{OPTION} home",
        value=request.texts["home"],
        allowed=f"{home} and more for all of the box" if home else "no home height for all of the box",
        next_step=f"Leave home out, or give home = {home}" if home else "Give less travel or rotation",
    )


def _home_of(written: str) -> float:
    study: model.Study = model.loads(written)  # type: ignore[assignment]
    return study.robot.home_height
