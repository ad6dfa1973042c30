"""Claims of the paper's sections 3 and 4, the robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod import rigid
from flexapod.study.paper.claim import (
    ELASTIC_LENGTH,
    HOLDS,
    IN_PART,
    NOT,
    OPEN,
    PAPER_DEVIATION,
    Claim,
    axis_motion,
    peaks,
    roll_and_arm,
)
from flexapod.study.paper.study import PaperStudy
from flexapod.study.scene import motion_end, robot_study
from flexapod.study.summary import AxisSummary, RobotSummary, summary
from flexapod.study.words import number, text

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["robot_claims"]

AWAY = 0.05  # distance from the ends of the quintic at which its jump of jerk no longer shows in the forces [s]


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
    diameter = robot_study(robot).robot.legs[0].piston.diameter or np.nan
    return Claim(
        where="Section 3",
        says="Diameter below a tenth of the length: Euler-Bernoulli theory is valid",
        ours=f"{100 * diameter / ELASTIC_LENGTH:.2g} % of the elastic length",
        verdict=HOLDS,
        reason="Shear and rotary inertia lower the first bending frequency of such a piston by less than 1 %.",
    )


def _figure6(robot: Dataset) -> Claim:
    motion = axis_motion(robot_study(robot))
    return Claim(
        where="Fig. 6",
        says="Roll about X; no amplitude, time or law in the text",
        ours=f"Quintic law, 0 to {np.rad2deg(motion.target[3]):.1f} deg in {motion.duration:g} s",
        verdict=OPEN,
        reason="The amplitude is backed out of Eqs. 11-12 and the printed 5 mm, 10 mm and 6 %; law and time are ours.",
    )


def _figure7(robot: Dataset, radii: Dataset) -> Claim:
    words = []
    for name, data in (("diameters", robot), ("radii", radii)):
        command = data.leg_length_command
        travel = float((command.max("time") - command.min("time")).max())
        apart = float((command.max("leg") - command.min("leg")).max())
        roll = np.rad2deg(roll_and_arm(data)[0])
        words.append(f"Circles as {name}, {roll:.1f} deg: {1e3 * travel:.0f} mm, legs {1e3 * apart:.0f} mm apart")
    return Claim(
        where="Fig. 7",
        says="Pistons reach a maximum travel of 260 mm at the end of the roll",
        ours=". ".join(words),
        verdict=IN_PART,
        reason=(
            "The printed circle diameters do not allow it at such a roll; read as radii, 260 mm is the difference "
            "between the longest and the shortest leg."
        ),
    )


def _figure8(rigid_legs: Dataset) -> Claim:
    gap = np.abs(rigid_legs.actuator_force - rigid_legs.actuator_force_rigid).max("leg")
    largest = float(np.abs(rigid_legs.actuator_force_rigid).max())
    end = motion_end(rigid_legs) or np.inf
    near = (rigid_legs.time < AWAY) | (np.abs(rigid_legs.time - end) < AWAY)
    return Claim(
        where="Fig. 8",
        says="Actuator forces of the rigid robot: Newton-Euler and finite elements agree strongly",
        ours=(
            f"Newton-Euler and our multibody model differ by {float(gap.where(~near).max()) / largest:.0e} of the "
            f"largest force, {largest:.0f} N"
        ),
        verdict=HOLDS,
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
    off = float(np.abs(rest - [0.0, study.robot.home_height]).max())
    return Claim(
        where="Eqs. 11-12",
        says="Rigid path of the centre of mass: Y = d cos(theta), Z = d sin(theta)",
        ours=f"So it is, with d = {1e3 * arm:.0f} mm along the platform's y and its height added{_beyond(off)}",
        verdict=IN_PART,
        reason="A payload on top of the platform would have Y = -d sin(theta), Z = d cos(theta); no height is given.",
    )


def _beyond(off: float) -> str:
    return "" if off < 1e-12 else f" (within {text(off, 'm', 1)})"


def _axes(robot: Dataset) -> dict[str, AxisSummary]:
    found = summary(robot)
    assert isinstance(found, RobotSummary)  # noqa: S101  data of a robot
    return {a.axis: a for a in found.axes}


def _figure9(robot: Dataset) -> Claim:
    found, piston = _axes(robot), robot_study(robot).robot.legs[0].piston
    ratios = " and ".join(number(value / found[axis].peak, 2) for axis, value in PAPER_DEVIATION.items())
    sag = abs(float(robot.com_deviation.sel(axis="z")[0]))
    return Claim(
        where="Fig. 9, section 4.1",
        says="Flexible actuators move the centre of mass by about 5 mm in Y and 10 mm in Z",
        ours=f"{peaks(robot)}, of which {text(sag, 'm')} in z is sag at rest",
        verdict=NOT,
        reason=(
            f"{ratios} times smaller. Between ideal joints a piston only stretches, at "
            f"{text(piston.EA / piston.length, 'N/m')}; bending shortens it to second order."
        ),
    )


def _six_per_cent(robot: Dataset) -> Claim:
    found = _axes(robot)
    shares = ", ".join(f"{axis} {found[axis].per_cent or np.nan:.2g} %" for axis in PAPER_DEVIATION)
    return Claim(
        where="Abstract",
        says="Deviations of up to 6 % of the end effector's position",
        ours=shares,
        verdict=NOT,
        reason="Largest deviation over the rigid travel of the same axis; 6 % would be that of an error in the roll.",
    )


def _vibration(robot: Dataset) -> Claim:
    parts = np.abs(robot.deviation_by_cause.sum("leg")).max(("time", "axis"))
    bending, stretch = (text(float(parts.sel(cause=cause)), "m", 2) for cause in ("bending", "axial-strain"))
    tips = text(float(np.abs(robot.tip_deflection).max()), "m", 2)
    return Claim(
        where="Title, section 4.1",
        says="Lateral vibration of the actuators makes the deviation",
        ours=f"Bending moves the payload by at most {bending}, stretch by {stretch}",
        verdict=NOT,
        reason=(
            "Universal and spherical joints carry no moment: nothing forces a piston to bend, and its own vibration "
            f"(tips up to {tips} off) shortens the leg by the square of that."
        ),
    )


def _lumped(robot: Dataset, lumped: Dataset) -> Claim:
    one, whole = (np.abs(data.com_deviation).max("time") for data in (lumped, robot))
    apart = 100 * float(np.abs(one / whole - 1).max())
    return Claim(
        where="Sections 1, 4.1",
        says="Lumped models are less suitable where accuracy matters",
        ours=f"One axial spring a leg: {peaks(lumped)}; all shapes: within {apart:.1g} %",
        verdict=NOT,
        reason="True of one actuator loaded sideways. For this robot's payload a spring along each leg is enough.",
    )


def _figure10(robot: Dataset, modes: Dataset) -> Claim:
    kinds = [str(kind) for kind in modes.kind.values]
    first = next(i for i, kind in enumerate(kinds) if kind.endswith("bending"))
    frequency = modes.frequency.values
    tips = text(float(np.abs(robot.tip_deflection).max()), "m", 2)
    return Claim(
        where="Fig. 10",
        says="At the largest roll a mode of one piston is excited, visibly bent",
        ours=(
            f"There the lowest mode ({kinds[0]}) has {frequency[0]:.0f} Hz, the first bending of legs "
            f"{frequency[first]:.0f} Hz; tips deflect by {tips}"
        ),
        verdict=IN_PART,
        reason="The modes exist. A roll of 1 s does not excite them to anything that shows without magnification.",
    )
