"""Claims of the paper's sections 3 and 4, the robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod import rigid
from flexapod.errors import InputError
from flexapod.study.estimates import section_width
from flexapod.study.paper.claim import (
    ELASTIC_LENGTH,
    IN_PART,
    NOT,
    OPEN,
    PAPER_DEVIATION,
    SIZE,
    Claim,
    axis_motion,
    explained,
    judged,
    left_open,
    peaks,
    roll_and_arm,
    times,
)
from flexapod.study.paper.study import PaperStudy
from flexapod.study.scene import motion_end, robot_study
from flexapod.study.summary import AxisSummary, RobotSummary, summary
from flexapod.study.words import text

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["robot_claims"]

AWAY = 0.05  # distance from the ends of the quintic at which its jump of jerk no longer shows in the forces [s]
TRAVEL, TRAVEL_ROUNDED = 0.26, 0.005  # of a piston, Fig. 7; printed to 10 mm [m]
PER_CENT = 6.0  # Abstract
SHEAR = 2.6 / 0.9  # E / kappa G of a round steel section: 2 (1 + 0.3), kappa = 0.9
ROUNDING = 1e-9  # of a path computed in double precision, relative
VISIBLE = 0.01  # deflection over length: the width of a line in a picture


def robot_claims(result: PaperStudy) -> tuple[Claim, ...]:
    """Slenderness, Figs. 6 to 10, Eqs. 11 and 12, abstract and conclusions."""
    robot = result["robot"]
    return (
        _slender(robot),
        _figure6(robot),
        _figure7(robot, result["robot-radii"]),
        _figure8(result["robot-rigid"]),
        _equations_11_12(robot),
        _figure9(robot),
        _six_per_cent(robot),
        _vibration(robot),
        _lumped(robot, result["robot-lumped"]),
        _figure10(robot, result["modes"]),
    )


def _slender(robot: Dataset) -> Claim:
    diameter = section_width(robot_study(robot).robot.legs[0].piston)
    ratio = diameter / ELASTIC_LENGTH
    lower = _lowered(ratio)
    verdict = judged(ratio < 0.1 and lower < 0.01, ratio < 0.1)
    return Claim(
        where="Section 3",
        says="Diameter below a tenth of the length: Euler-Bernoulli theory is valid",
        ours=f"{100 * ratio:.2g} % of the elastic length",
        verdict=verdict,
        reason=f"Shear and rotary inertia lower the first frequency of such a pinned piston by {100 * lower:.2g} %.",
    )


def _lowered(ratio: float) -> float:
    """Share by which Timoshenko's theory lowers the first frequency of a round pinned beam; diameter over length.

    Smaller root of r^2 s^2 W^4 - [1 + pi^2 (r^2 + s^2)] W^2 + pi^4 = 0 against W = pi^2, with the radius of gyration
    r = d / 4 L and s^2 = r^2 E / (kappa G): Han, Benaroya & Wei (1999), J. Sound Vib. 225(5), 935-988.
    """
    r2 = ratio**2 / 16
    s2 = SHEAR * r2
    half = 0.5 * (1 + np.pi**2 * (r2 + s2))
    squared = np.pi**4 / (half + np.sqrt(half**2 - r2 * s2 * np.pi**4))
    return 1 - float(np.sqrt(squared)) / np.pi**2


def _figure6(robot: Dataset) -> Claim:
    motion = axis_motion(robot_study(robot))
    open_here = left_open("paper-robot", "motion.amplitude", "motion.duration", "motion.profile")
    verdict = OPEN if open_here else judged(motion.type == "roll")
    return Claim(
        where="Fig. 6",
        says="Roll about X; no amplitude, time or law in the text",
        ours=f"{motion.profile.capitalize()} law, 0 to {np.rad2deg(motion.target[3]):.1f} deg in {motion.duration:g} s",
        verdict=verdict,
        reason=explained(
            verdict,
            OPEN,
            "The amplitude is backed out of Eqs. 11-12 and the printed 5 mm, 10 mm and 6 %; law and time are ours.",
        ),
    )


def _figure7(robot: Dataset, radii: Dataset) -> Claim:
    words, found = [], {}
    for name, data in (("diameters", robot), ("radii", radii)):
        command = data.leg_length_command
        travel = float((command.max("time") - command.min("time")).max())
        apart = float((command.max("leg") - command.min("leg")).max())
        found |= {f"read as {name}, 260 mm is the travel": travel}
        found |= {f"read as {name}, 260 mm is the difference between the longest and the shortest leg": apart}
        roll = np.rad2deg(roll_and_arm(data)[0])
        words.append(f"Circles as {name}, {roll:.1f} deg: {1e3 * travel:.0f} mm, legs {1e3 * apart:.0f} mm apart")
    close = [name for name, length in found.items() if abs(length - TRAVEL) <= TRAVEL_ROUNDED]
    verdict = judged("read as diameters, 260 mm is the travel" in close, bool(close))
    no = f"The printed circle diameters allow {1e3 * next(iter(found.values())):.0f} mm at such a roll"
    return Claim(
        where="Fig. 7",
        says="Pistons reach a maximum travel of 260 mm at the end of the roll",
        ours=". ".join(words),
        verdict=verdict,
        reason="; ".join([no, *close]) + ".",
    )


def _figure8(rigid_legs: Dataset) -> Claim:
    gap = np.abs(rigid_legs.actuator_force - rigid_legs.actuator_force_rigid).max("leg")
    largest = float(np.abs(rigid_legs.actuator_force_rigid).max())
    end = motion_end(rigid_legs) or np.inf
    near = (rigid_legs.time < AWAY) | (np.abs(rigid_legs.time - end) < AWAY)
    apart = float(gap.where(~near).max()) / largest
    return Claim(
        where="Fig. 8",
        says="Actuator forces of the rigid robot: Newton-Euler and finite elements agree strongly",
        ours=(f"Newton-Euler and our multibody model differ by {apart:.0e} of the largest force, {largest:.0f} N"),
        verdict=judged(apart < 0.01, apart < 0.1),  # a line's width in the figure; visibly apart
        reason=(
            f"Closer than {1e3 * AWAY:.0f} ms to the ends of the quintic, where its jerk jumps, by "
            f"{100 * float(gap.max()) / largest:.1g} % at a step of {1e3 * rigid_legs.attrs['step']:g} ms; this falls "
            "with the step."
        ),
    )


def _equations_11_12(robot: Dataset) -> Claim:
    study, (_, arm) = robot_study(robot), roll_and_arm(robot)
    R = rigid.poses(study.robot, study.motion, robot.time.values).rotation
    roll = np.arctan2(R[:, 2, 1], R[:, 2, 2])
    rest = robot.com_position_rigid.values[:, 1:] - arm * np.stack([np.cos(roll), np.sin(roll)], axis=1)
    printed, off = (float(np.abs(rest - [0.0, height]).max()) for height in (0.0, study.robot.home_height))
    verdict = judged(printed < ROUNDING * arm, off < ROUNDING * arm)
    so = "So it is" if off < ROUNDING * arm else f"Off by {text(off, 'm')}"
    return Claim(
        where="Eqs. 11-12",
        says="Rigid path of the centre of mass: Y = d cos(theta), Z = d sin(theta)",
        ours=f"{so}, with d = {1e3 * arm:.0f} mm along the platform's y and its height added",
        verdict=verdict,
        reason=explained(
            verdict,
            IN_PART,
            "A payload on top of the platform would have Y = -d sin(theta), Z = d cos(theta) (T2.13); no height is "
            f"given, ours is {study.robot.home_height:g} m.",
        ),
    )


def _axes(robot: Dataset) -> dict[str, AxisSummary]:
    found = summary(robot)
    if isinstance(found, RobotSummary):
        return {a.axis: a for a in found.axes}
    raise InputError("is the result of a single actuator", key="data", allowed="results of a robot")


def _figure9(robot: Dataset) -> Claim:
    found, piston = _axes(robot), robot_study(robot).robot.legs[0].piston
    ours = {axis: found[axis].peak for axis in PAPER_DEVIATION}
    verdict = judged(all(abs(ours[axis] / paper - 1) <= SIZE for axis, paper in PAPER_DEVIATION.items()))
    ratios = ", ".join(f"{axis} is {times(ours[axis], paper)}" for axis, paper in PAPER_DEVIATION.items())
    sag = abs(float(robot.com_deviation.sel(axis="z")[0]))
    return Claim(
        where="Fig. 9, section 4.1",
        says="Flexible actuators move the centre of mass by about 5 mm in Y and 10 mm in Z",
        ours=f"{peaks(robot)}, of which {text(sag, 'm')} in z is sag at rest",
        verdict=verdict,
        reason=explained(
            verdict,
            NOT,
            f"{ratios} than printed. Between ideal joints a piston only stretches, at "
            f"{text(piston.EA / piston.length, 'N/m')}; bending shortens it to second order.",
        ),
    )


def _six_per_cent(robot: Dataset) -> Claim:
    found = {axis: _axes(robot)[axis] for axis in PAPER_DEVIATION}
    shares = {axis: a.per_cent or np.nan for axis, a in found.items()}
    printed = [f"{100 * PAPER_DEVIATION[axis] / a.excursion:.2g} % in {axis}" for axis, a in found.items()]
    return Claim(
        where="Abstract",
        says=f"Deviations of up to {PER_CENT:g} % of the end effector's position",
        ours=", ".join(f"{axis} {share:.2g} %" for axis, share in shares.items()),
        verdict=judged(any(abs(share / PER_CENT - 1) <= SIZE for share in shares.values())),
        reason=(
            "Largest deviation over the rigid travel of the same axis; the printed 5 mm and 10 mm would be "
            f"{' and '.join(printed)}, as an error of the roll would give."
        ),
    )


def _vibration(robot: Dataset) -> Claim:
    parts = np.abs(robot.deviation_by_cause.sum("leg")).max(("time", "axis"))
    bending, stretch = (float(parts.sel(cause=cause)) for cause in ("bending", "axial-strain"))
    tips = text(float(np.abs(robot.tip_deflection).max()), "m", 2)
    verdict = judged(bending >= stretch, bending >= 0.1 * stretch)
    return Claim(
        where="Title, section 4.1",
        says="Lateral vibration of the actuators makes the deviation",
        ours=f"Bending moves the payload by at most {text(bending, 'm', 2)}, stretch by {text(stretch, 'm', 2)}",
        verdict=verdict,
        reason=explained(
            verdict,
            NOT,
            "Universal and spherical joints carry no moment: nothing forces a piston to bend, and its own vibration "
            f"(tips up to {tips} off) shortens the leg by the square of that.",
        ),
    )


def _lumped(robot: Dataset, lumped: Dataset) -> Claim:
    one, whole = (np.abs(data.com_deviation).max("time") for data in (lumped, robot))
    apart = float(np.abs(one / whole - 1).max())
    verdict = judged(apart > 0.5, apart > 0.1)
    return Claim(
        where="Sections 1, 4.1",
        says="Lumped models are less suitable where accuracy matters",
        ours=f"One axial spring a leg: {peaks(lumped)}; all shapes: within {100 * apart:.1g} %",
        verdict=verdict,
        reason=explained(
            verdict,
            NOT,
            "True of one actuator loaded sideways. For this robot's payload a spring along each leg is enough.",
        ),
    )


def _figure10(robot: Dataset, modes: Dataset) -> Claim:
    kinds, frequency = [str(kind) for kind in modes.kind.values], modes.frequency.values
    bending = [f for f, kind in zip(frequency, kinds, strict=True) if kind.endswith("bending")]
    first = f"the first bending of legs {bending[0]:.0f} Hz" if bending else "no leg bends in any"
    tips = float(np.abs(robot.tip_deflection).max())
    verdict = judged(bool(bending) and tips >= VISIBLE * ELASTIC_LENGTH, bool(bending))
    return Claim(
        where="Fig. 10",
        says="At the largest roll a mode of one piston is excited, visibly bent",
        ours=(
            f"There the lowest mode ({kinds[0]}) has {frequency[0]:.0f} Hz, {first}; tips deflect by "
            f"{text(tips, 'm', 2)}"
        ),
        verdict=verdict,
        reason=explained(
            verdict,
            IN_PART,
            f"The modes exist. A roll of {axis_motion(robot_study(robot)).duration:g} s does not excite them to "
            f"anything that shows without magnification: {100 * tips / ELASTIC_LENGTH:.1g} % of the elastic length.",
        ),
    )
