"""Judge of a study's requirement: each key over the box of poses, the states and the motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import cast

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.envelope import signed_singularity
from flexapod.analysis.checks.reachability import REACHED, REASONS, Codes
from flexapod.analysis.description.residual_vibration import RestingRobot, expected_vibration
from flexapod.analysis.description.robot_description import describe_legs
from flexapod.analysis.description.screw_description import describe_screws
from flexapod.analysis.error_budget.rows import names_of_rows
from flexapod.analysis.pose_values import PoseRequest, Values, batch_values
from flexapod.analysis.requirements.box import RequiredBox, box_of, box_reach
from flexapod.analysis.requirements.drives import (
    accelerations,
    has_force_limits,
    motion_shares,
    rate_limits,
    rest_shares,
    shaft_shares,
    speeds,
)
from flexapod.analysis.requirements.errors import ErrorTerms
from flexapod.analysis.requirements.judgements import HOME, Judgement, worst_of
from flexapod.analysis.requirements.states import COLD, LoadState, as_drawn, states_of
from flexapod.analysis.results.bodies import clearance
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError
from flexapod.common.ranking import first_largest
from flexapod.model import AXES, LeastStiffness, Requirement, Study
from flexapod.solve.modal.elastic_robot import ElasticRobot

ERRORS = (
    "pose_accuracy", "pose_accuracy_calibrated", "pose_accuracy_corrected", "repeatability",
    "minimum_incremental_motion",
)  # fmt: skip
UNITS = {
    "first_frequency": "Hz", "velocity": "m/s", "angular_velocity": "rad/s", "acceleration": "m/s^2",
    "settling_time": "s", "life": "s", "clearance": "m",
}  # fmt: skip
AT_MOST = (*ERRORS, "settling_time")
GUIDED = "the legs guide the platform: the directions in which it moves change with the pose"


class Judge:
    """A study with a requirement; what several keys need is computed once, when it is asked for."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.wanted: Requirement = study.requirement  # type: ignore[assignment]
        self.box: RequiredBox | None = box_of(study.robot, self.wanted) if self.wanted.has_box else None

    @cached_property
    def points(self) -> Array:
        """Home and the corners of the box, (P, 6)."""
        return np.concatenate([HOME[None], np.zeros((0, 6)) if self.box is None else self.box.corners])

    @cached_property
    def trial_points(self) -> Array:
        """Poses at which rigid measures are looked at, (P, 6): home, three values of each axis of the box."""
        return np.concatenate([HOME[None], np.zeros((0, 6)) if self.box is None else self.box.trial_points])

    def poses(self, points: Array) -> kinematics.Poses:
        """Poses of points of the box."""
        robot = self.study.robot
        return kinematics.poses_from_home(robot, points) if self.box is None else self.box.poses(points)

    @cached_property
    def states(self) -> list[LoadState]:
        """States, cold and warm, with the most payload and the least."""
        return states_of(self.study)

    @cached_property
    def loads(self) -> list[LoadState]:
        """One state of each payload."""
        return [state for state in self.states if state.heat == self.states[0].heat]

    @cached_property
    def batches(self) -> list[tuple[Codes, Values]]:
        """Codes and values of home and the corners in each state; raises as `batch_values`."""
        return [self._batch(state.study) for state in self.states]

    def _batch(self, study: Study) -> tuple[Codes, Values]:
        errors = any(getattr(self.wanted, name) is not None for name in ERRORS)
        request = PoseRequest(
            direction=np.array([0.0, 0.0, 1.0]), acceleration=None, frequencies=1, terms=errors,
            compliance=self.wanted.stiffness is not None,
        )  # fmt: skip
        elastic = ElasticRobot(study.robot, study.simulation, study.load)
        return batch_values(study, elastic, kinematics.RigidPoses(study.robot, self.poses(self.points)), request)

    def findings(self) -> list[Judgement]:
        """Findings of all keys, in the order of the table."""
        found: list[Judgement] = []
        if self.box is not None:
            found += self._reach(self.box)
        for name in self.wanted.names:
            if name in ("travel", "rotation"):
                continue
            if name == "stiffness":
                found += [
                    self._protected(one, self._elastic)
                    for one in _stiffnesses(cast("LeastStiffness", self.wanted.stiffness))
                ]
                continue
            one = Judgement(
                name=name,
                unit="m" if name in ERRORS else UNITS.get(name, "1"),
                wanted=getattr(self.wanted, name),
                at_most=name in AT_MOST,
            )
            found.append(self._protected(one, self._way(name)))
        return found

    def _way(self, name: str) -> Callable[[Judgement], Judgement]:
        ways = {
            "velocity": self._speed, "angular_velocity": self._speed, "acceleration": self._acceleration,
            "settling_time": self._settling, "force_margin": self._force, "buckling_factor": self._buckling,
            "stress_factor": self._stress, "life": self._life, "clearance": self._clearance,
            "singularity": self._singularity,
        }  # fmt: skip
        return ways.get(name, self._elastic)

    def _protected(self, asked: Judgement, way: Callable[[Judgement], Judgement]) -> Judgement:
        """A finding, or that there is none where it cannot be computed."""
        try:
            return way(asked)
        except FlexapodError as error:
            return asked.without_number(str(error))

    # where the legs reach

    def _reach(self, box: RequiredBox) -> list[Judgement]:
        """The box: one verdict for both keys, as the size that is reached in proportion."""
        reach, found = box_reach(box), []
        for name, part, unit in (("travel", slice(3), "m"), ("rotation", slice(3, 6), "rad")):
            if getattr(self.wanted, name) is None:
                continue
            wanted = float(np.abs([box.low[part], box.high[part]]).max())
            found.append(
                Judgement(
                    name=name, unit=unit, wanted=wanted, at_most=False, found=wanted * reach.scale,
                    sure=reach.sure, pose=reach.worst, leg=reach.leg, why=reach.reason,
                )
            )  # fmt: skip
        return found

    # about the equilibrium

    def _elastic(self, asked: Judgement) -> Judgement:
        if why := self._nothing_named(asked.name):
            return asked.without_number(why)
        values = np.array([self._values(asked.name, k) for k in range(len(self.states))])
        found = self._worst(asked, values, self.states, self.points)
        if asked.name in ERRORS and found.pose is not None:
            state, pose = self._place(values, at_most=True)
            return _with(found, part=self._terms(state).largest_parts(asked.name, pose))
        return found

    def _nothing_named(self, name: str) -> str:
        """Reason why the study has no number for an error; empty where it has."""
        robot = self.study.robot
        if name == "pose_accuracy" and robot.tolerances is None and robot.geometry is None:
            return "the study has no [tolerances]: what differs between machines is not known"
        if name in ERRORS and not names_of_rows(self.study):
            return "nothing that the study names moves the tool off its place"
        if name in ("repeatability", "minimum_incremental_motion") and not any(
            self._terms(k).components(name).any() for k in range(len(self.states))
        ):
            return "the study names neither play nor friction nor anything that differs between approaches"
        return ""

    def _terms(self, state: int) -> ErrorTerms:
        values, parts = self.batches[state][1], names_of_rows(self.states[state].study)
        corrected = self.wanted.pose_accuracy_corrected is not None
        sag, sag_parts = self._sag(parts) if corrected else (None, None)
        return ErrorTerms(
            parts=parts, terms=values["error_terms"], whole=values["systematic"], sag=sag, sag_parts=sag_parts
        )

    @cached_property
    def _nominal(self) -> tuple[tuple[str, ...], Values]:
        """Parts and values of the robot as drawn under its own payload."""
        study = as_drawn(self.study)
        return names_of_rows(study), self._batch(study)[1]

    def _sag(self, parts: tuple[str, ...]) -> tuple[Array, Array]:
        """Sag that the controller takes off, (P, 6), and what of it is of each of `parts`, (P, parts, 6)."""
        names, values = self._nominal
        of_parts = np.zeros((len(self.points), len(parts), 6))
        for k, name in enumerate(names):
            if name in parts:
                of_parts[:, parts.index(name)] = values["error_terms"][:, 1, k]
        return values["systematic"], of_parts

    def _values(self, name: str, state: int) -> Array:
        """Values of a key at home and the corners, (P,)."""
        values = self.batches[state][1]
        if name in ERRORS:
            return self._terms(state).size(name)
        if name == "stiffness":
            return values["stiffness_least"]
        if name.startswith("stiffness."):
            with np.errstate(divide="ignore"):  # out of its plane a planar robot does not give way
                return 1 / values["compliance"][:, AXES.index(name.partition(".")[2])]
        found = values["frequency"][:, 0] if values["frequency"].shape[1] else np.full(len(self.points), np.nan)
        growth = values.get("loop_growth")
        return found if growth is None else np.where(growth > 0, np.nan, found)  # of unstable loops of the drives

    @staticmethod
    def _place(values: Array, *, at_most: bool) -> tuple[int, int]:
        state, pose = np.unravel_index(worst_of(values.ravel(), at_most=at_most) or 0, values.shape)
        return int(state), int(pose)

    def _worst(self, asked: Judgement, values: Array, states: list[LoadState], points: Array) -> Judgement:
        """Worst of values (states, P), the first of which is at home; incomplete where some are NaN."""
        if worst_of(values.ravel(), at_most=asked.at_most) is None:
            return asked.without_number(self._why_not())
        state, pose = self._place(values, at_most=asked.at_most)
        complete = not bool(np.isnan(values).any())
        warm = [k for k, other in enumerate(states) if other.heat != COLD and other.mass == states[state].mass]
        return _with(
            asked, found=float(values[state, pose]), complete=complete, pose=points[pose], state=states[state].words,
            home=float(values[warm[0], 0]) if warm else np.nan, home_state=states[warm[0]].words if warm else "",
            why="" if complete else self._why_not(),
        )  # fmt: skip

    def _why_not(self) -> str:
        """Reason why some poses have no values."""
        codes = np.concatenate([code for code, _ in self.batches])
        off = codes[codes != REACHED]
        if not off.size:
            return "it cannot be computed at all poses"
        return f"{len(off)} of {len(codes)} poses have no equilibrium to judge: {REASONS[int(off[0])].words}"

    # of the rigid robot

    def _speed(self, asked: Judgement) -> Judgement:
        if kinematics.rigid_limbs(self.study.robot).guides:
            return asked.without_number(GUIDED)
        if not np.isfinite(rate_limits(self.study.robot)).any():
            return asked.without_number("the drives have no limits of their speed: give leg.drive.limits")
        at = kinematics.RigidPoses(self.study.robot, self.poses(self.trial_points))
        return self._of_legs(asked, speeds(at, turning=asked.name == "angular_velocity"), self.trial_points)

    def _acceleration(self, asked: Judgement) -> Judgement:
        if kinematics.rigid_limbs(self.study.robot).guides:
            return asked.without_number(GUIDED)
        if not has_force_limits(self.study.robot):
            return asked.without_number("the drives have no limits of their force: give leg.drive.limits")
        found = [accelerations(state.study, self.poses(self.points)) for state in self.loads]
        worst = int(np.argmin([values.min() for values in found]))
        return _with(self._of_legs(asked, found[worst], self.points), state=self.loads[worst].words)

    def _of_legs(self, asked: Judgement, values: Array, points: Array) -> Judgement:
        """Least of values (P, legs)."""
        pose, leg = np.unravel_index(first_largest(-values), values.shape)
        return _with(
            asked, found=float(values[pose, leg]), pose=points[pose], leg=int(leg) + 1, home=float(values[0].min())
        )

    def _clearance(self, asked: Judgement) -> Judgement:
        robot, path = self.study.robot, self.poses(self.trial_points)
        at = kinematics.RigidPoses(robot, path)
        nearest = clearance(robot, path.place(robot.platform_joints), at.directions, at.reach.length)
        if nearest is None:
            return asked.without_number("no two legs could meet but at a joint")
        if np.isnan(nearest.gap).any():
            return asked.without_number("legs do not reach all poses of the box")
        k = first_largest(-nearest.gap)
        return _with(
            asked, found=float(nearest.gap[k]), pose=self.trial_points[k], leg=int(nearest.legs[k][0]) + 1,
            part=f"legs {nearest.legs[k][0] + 1} and {nearest.legs[k][1] + 1}", home=float(nearest.gap[0]),
        )  # fmt: skip

    def _singularity(self, asked: Judgement) -> Judgement:
        at = kinematics.RigidPoses(self.study.robot, self.poses(self.trial_points))
        if at.reach.lost.any():
            return asked.without_number("legs do not reach all poses of the box")
        least = signed_singularity(at)
        k = first_largest(-least)
        return _with(asked, found=float(least[k]), pose=self.trial_points[k], home=float(least[0]))

    # along the motion

    @cached_property
    def _paths(self) -> list[RigidPath]:
        return [RigidPath(state.study) for state in self.loads]

    def _settling(self, asked: Judgement) -> Judgement:
        found, motion = [], self.study.motion
        for state in self.states:
            study = state.study
            elastic = ElasticRobot(study.robot, study.simulation, study.load)
            rest = RestingRobot(study, elastic, min(motion.end_time - motion.hold, study.duration))
            expected = expected_vibration(rest, self.wanted.settling_band)
            if expected is None:
                return asked.without_number("no vibration after the motion can be estimated")
            found.append(expected.settling)
        worst = first_largest(np.array(found))
        return _with(asked, found=found[worst], state=self.states[worst].words, place="after the motion")

    def _force(self, asked: Judgement) -> Judgement:
        if not has_force_limits(self.study.robot):
            return asked.without_number("the drives have no limits of their force: give leg.drive.limits")
        shares = [motion_shares(path) for path in self._paths]
        return self._factor(
            asked, shares, lambda k: rest_shares(self.study.robot, self.batches[k][1]["actuator_force"])
        )

    def _buckling(self, asked: Judgement) -> Judgement:
        shares = []
        for path in self._paths:
            legs = np.array([leg.euler_share.value for leg in describe_legs(path)])
            for screw in describe_screws(path):
                legs[screw.leg - 1] = max(legs[screw.leg - 1], screw.buckling.value)
            shares.append(legs)
        robot, length = self.study.robot, kinematics.RigidPoses(self.study.robot, self.poses(self.points)).reach.length

        def resting(k: int) -> Array:
            values = self.batches[k][1]
            return np.column_stack([shaft_shares(robot, length, values["actuator_force"]), values["euler_share"]])

        return self._factor(asked, shares, resting)

    def _factor(self, asked: Judgement, along: list[Array], resting: Callable[[int], Array]) -> Judgement:
        """Least of limits over needs: shares (legs,) `along` the motion with each payload, (P, any) at rest."""
        k, leg = np.unravel_index(first_largest(np.array(along)), np.shape(along))
        most, found = along[k][leg], _with(asked, leg=int(leg) + 1, state=self.loads[k].words, place="on the motion")
        complete, why = True, ""
        for state, label in enumerate(self.states):
            shares = resting(state)
            if np.isnan(shares).any():
                complete, why = False, self._why_not()
            if np.nanmax(shares, initial=0.0) > most:
                pose, leg = np.unravel_index(np.nanargmax(shares), shares.shape)
                most = float(shares[pose, leg])
                number = int(leg) + 1 if leg < self.study.robot.count else 0  # the last of pistons: of some leg
                found = _with(asked, leg=number, state=label.words, pose=self.points[pose])
        return _with(found, found=1 / most if most > 0 else np.inf, complete=complete, why=why)

    def _stress(self, asked: Judgement) -> Judgement:
        found: list[tuple[float, int, str]] = []
        for state, path in zip(self.loads, self._paths, strict=True):
            for leg in describe_legs(path):
                if leg.stress is None or leg.stress.yield_stress is None:
                    return asked.without_number(f"section or yield stress of the piston of leg {leg.leg} is not known")
                most = leg.stress.total.value
                found.append((leg.stress.yield_stress / most if most > 0 else np.inf, leg.leg, state.words))
        least = min(found, key=lambda entry: entry[0])
        return _with(asked, found=least[0], leg=least[1], state=least[2], place="on the motion")

    def _life(self, asked: Judgement) -> Judgement:
        found: list[tuple[float, int, str]] = []
        for state, path in zip(self.loads, self._paths, strict=True):
            screws = describe_screws(path)
            if not screws:
                return asked.without_number("the robot has no screws")
            if missing := [one.leg for one in screws if one.hours is None]:
                return asked.without_number(
                    f"leg {missing[0]} has no dynamic load rating, or does not turn in the motion"
                )
            found += [(3600 * (one.hours or 0.0), one.leg, state.words) for one in screws]
        least = min(found, key=lambda entry: entry[0])
        return _with(asked, found=least[0], leg=least[1], state=least[2], place="the motion repeated")


def _with(base: Judgement, /, **changes: object) -> Judgement:
    """A finding with more of what was found."""
    return replace(base, **changes)  # type: ignore[arg-type]


def _stiffnesses(asked: LeastStiffness) -> list[Judgement]:
    """Stiffnesses that are asked, in the weakest direction and by axis."""
    return [
        Judgement(
            name="stiffness" if axis == "each" else f"stiffness.{axis}",
            unit="N m/rad" if axis in AXES[3:] else "N/m",
            wanted=least,
            at_most=False,
        )
        for axis, least in asked.by_axis.items()
    ]
