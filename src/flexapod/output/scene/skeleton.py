"""The neutral mechanism: joints, rails, cranks, legs and platform of any robot, placed at a pose.

Figures, reports, the page and exporters read it; nothing in it knows how many legs there are, or of which kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexapod import kinematics, model
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import limbs
from flexapod.kinematics.rotations import exponential
from flexapod.model.study.home import carriage_home, foot

STATIONS = 25  # points of a drawn piston
RAIL = 0.35  # of a strut's length: how far a rail without ends is drawn to either side of home
FLAT = 0.1  # height over size
BAR = 0.06  # of the robot's size: half the length of a hinge's axis as it is drawn


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A robot in the world at an instant [m].

    `base`, `platform`: joints (legs, 3); `piston`: lines from the mouth of the cylinder, of a strut from the base
    joint, to the tip (legs, n, 3); `com`, `centre` (3,): of the payload's mass, of the platform's frame; `rotation`
    (3, 3): platform to world; `guides` (carriages, 2, 3): rails from end to end, cranks from shaft to base joint;
    `hinges` (hinges, 2, 3): short lines along the axes of revolute joints and shafts. `heads` (guided legs, 2, 3):
    pistons in bushings from gland to head. `plates` (2, 6): displacement and turn, about the origin, of the base plate
    on its mount, world axes, and of the joints' plate against the payload, platform axes; `frames` (legs, 3, 3): of the
    base joints, which cranks turn.
    """

    skeleton: Skeleton
    base: Array
    platform: Array
    piston: Array
    com: Array
    centre: Array
    rotation: Array
    guides: Array
    hinges: Array
    heads: Array
    plates: Array
    frames: Array

    @property
    def radii(self) -> Array:
        """Radii of the pistons at the points of `piston`, (legs, n) [m]; nan where no section is given."""
        lines = np.linalg.norm(np.diff(self.piston, axis=1), axis=2)
        from_tip = np.cumsum(lines[:, ::-1], axis=1)[:, ::-1]
        legs = zip(self.skeleton.robot.legs, np.pad(from_tip, ((0, 0), (0, 1))), strict=True)
        return np.array([_radius(leg.piston, xi) for leg, xi in legs])

    @property
    def mouth(self) -> Array:
        """Mouths of the cylinders, (legs, 3)."""
        return self.piston[:, 0]

    @property
    def height(self) -> float:
        """Height from the lowest to the highest joint; of a robot that lies flat its largest extent [m]."""
        reach = np.ptp(np.vstack([self.base, self.platform]), axis=0)
        return float(reach[2] if reach[2] > FLAT * reach.max() else reach.max())

    @property
    def points(self) -> Array:
        """All that limits a picture has to hold, (n, 3)."""
        parts = (self.base, self.platform, self.com, self.guides)
        return np.vstack([part.reshape(-1, 3) for part in parts])


class Skeleton:
    """A robot as it is drawn: what does not change with its pose.

    `joints`: letters of the joints of each leg at base and platform, U, S, R, F, or "" where the leg is part of the
    platform; `com`, `tool` (3,): of the payload in platform axes, without one the frame's origin; `guided`: legs with a
    carriage.
    """

    def __init__(self, robot: model.Robot) -> None:
        self.robot: model.Robot = robot
        self.joints: tuple[tuple[str, str], ...] = tuple((x.letters.base, x.letters.platform) for x in robot.legs)
        self.com: Array = robot.com
        self.tool: Array = robot.tool
        self.guided: NDArray[np.int64] = np.array(
            [i for i, leg in enumerate(robot.legs) if leg.carriage is not None], dtype=int
        )
        self._home_carriages = robot.home_carriages
        self._mouth = np.array([leg.cylinder.mouth for leg in robot.legs])

    @cached_property
    def size(self) -> float:
        """A length that stands for the robot's size [m]: the largest extent of its joints at home."""
        robot = self.robot
        return float(np.ptp(np.vstack([robot.base_joints, robot.home_bases, robot.home_tips]), axis=0).max())

    @cached_property
    def home(self) -> Scene:
        """The undeformed robot at home."""
        return self.scene_at(self.robot.home_position, self.robot.home_rotation)

    @cached_property
    def _limbs(self) -> kinematics.Limbs:
        return limbs(self.robot)

    @cached_property
    def _sided(self) -> list[tuple[int, model.Carriage, float]]:
        """Legs whose carriage a strut places: number, carriage on the side where it is at home, length of the strut."""
        found = []
        for i in self.guided:
            leg, base, tip = self.robot.legs[i], self.robot.base_joints[i], self.robot.home_tips[i]
            if leg.strut is not None and leg.carriage is not None:
                upper = leg.carriage.replace(side=1, home=None)
                at = carriage_home(base, upper, tip, leg.strut.length)
                above = at is not None and abs(at - self._home_carriages[i]) < 1e-6
                found.append((int(i), upper if above else upper.replace(side=-1), leg.strut.length))
        return found

    def carriages(self, tips: Array) -> Array:
        """Positions of the carriages (legs,) [m, rad] where the rigid legs end in `tips` (legs, 3)."""
        found = np.array(self._home_carriages)
        for i, carriage, length in self._sided:
            place = carriage_home(self.robot.base_joints[i], carriage, tips[i], length)
            found[i] = found[i] if place is None else place
        return found

    def axial_distances(self, length: Array) -> Array:
        """Distances of the drawn points of pistons from their base joints, (legs, n) [m], at lengths (legs,)."""
        mouth = self._mouth[:, None]
        return mouth + (length[:, None] - mouth) * np.linspace(0.0, 1.0, STATIONS)

    def lateral_offsets(self, line: Array, tip: Array, length: Array) -> Array:
        """Offsets of the pistons from the lines of their joints, (legs, 2, n) [m].

        `line` (legs, 2, n): offsets from the axes of the cylinders at n points spread evenly from mouth to tip [m];
        `tip` (legs, 2): those of the tips, every cylinder leans so that its tip meets the platform; `length` (legs,):
        joint to joint [m].
        """
        return line - tip[:, :, None] * (self.axial_distances(length) / length[:, None])[:, None]

    def bases(self, carriages: Array) -> Array:
        """Base joints (legs, 3) where the carriages are at positions (legs,)."""
        robot = self.robot
        places = zip(robot.base_joints, robot.legs, carriages, strict=True)
        return np.array([foot(base, leg.carriage, float(position)) for base, leg, position in places])

    def lengths(self, centre: Array, R: Array, carriages: Array | None = None) -> Array:
        """Joint-to-joint lengths at a pose, (legs,) [m]."""
        tips = centre + self.robot.platform_joints @ R.T
        return np.linalg.norm(tips - self.bases(self.carriages(tips) if carriages is None else carriages), axis=1)

    def scene_at(
        self,
        centre: Array,
        R: Array,
        com: Array | None = None,
        offset: Array | None = None,
        carriages: Array | None = None,
        plates: Array | None = None,
    ) -> Scene:
        """The robot with its platform frame's origin at `centre`, turned by `R`.

        `com` (3,) of the payload, None: where a rigid platform carries it; `offset` (legs, 2, STATIONS): pistons off
        the lines of their joints [m], see `lateral_offsets`, None: straight legs; `carriages` (legs,), None: where
        rigid legs put them; `plates` (2, 6), see `Scene`, None: on mounts that do not move.
        """
        plates = np.zeros((2, 6)) if plates is None else plates
        tips = centre + _on_plate(self.robot.platform_joints, plates[1]) @ R.T
        carriages = self.carriages(tips) if carriages is None else carriages
        base = _on_plate(self.bases(carriages), plates[0])
        chord = tips - base
        length = np.linalg.norm(chord, axis=1)
        axis = chord / length[:, None]
        lines = base[:, None] + self.axial_distances(length)[:, :, None] * axis[:, None]
        frames = self._frames(carriages)
        if offset is not None:
            turned = kinematics.leg_rotations(frames, *kinematics.joint_angles(frames, axis[None]))[0]
            lines = lines + np.einsum("ixd,idn->inx", turned[:, :, :2], offset)
        return Scene(
            skeleton=self,
            base=base,
            platform=tips,
            piston=lines,
            com=centre + R @ self.com if com is None else com,
            centre=centre,
            rotation=R,
            guides=self._guides(base, carriages),
            hinges=self._hinges(base, frames, tips, R),
            heads=self._heads(base, axis, length),
            plates=plates,
            frames=frames,
        )

    def _heads(self, base: Array, axis: Array, length: Array) -> Array:
        legs = self.robot.legs
        ends = [(leg.cylinder.mouth, length[i] - leg.piston.length) for i, leg in enumerate(legs)]
        found = [base[i] + np.outer(ends[i], axis[i]) for i, leg in enumerate(legs) if leg.guide is not None]
        return np.array(found).reshape(-1, 2, 3)

    def _frames(self, carriages: Array) -> Array:
        """Axes of the base joints, (legs, 3, 3): cranks turn them."""
        frames = np.array(self._limbs.frames)
        for i in self.guided:
            carriage = self.robot.legs[i].carriage
            if carriage is not None and carriage.kind == "crank":
                turn = (carriages[i] - self._home_carriages[i]) * carriage.unit
                frames[i] = exponential(turn) @ frames[i]
        return frames

    def _guides(self, base: Array, carriages: Array) -> Array:
        found = []
        for i in self.guided:
            leg, start = self.robot.legs[i], self.robot.base_joints[i]
            carriage, home = leg.carriage, self._home_carriages[i]
            if carriage is None:
                continue
            if carriage.kind == "crank":
                found.append([start, base[i]])
                continue
            reach = RAIL * (leg.strut.length if leg.strut else self.size)
            ends = (carriage.stroke.min, carriage.stroke.max) if carriage.stroke else (home - reach, home + reach)
            low, high = min(ends[0], carriages[i]), max(ends[1], carriages[i])
            found.append([start + low * carriage.unit, start + high * carriage.unit])
        return np.array(found).reshape(-1, 2, 3)

    def _hinges(self, base: Array, frames: Array, tips: Array, R: Array) -> Array:
        found = []
        for i, (lower, upper) in enumerate(self.joints):
            carriage = self.robot.legs[i].carriage
            if carriage is not None and carriage.kind == "crank":
                found.append((self.robot.base_joints[i], carriage.unit))
            if lower == "R":
                found.append((base[i], frames[i, :, 0]))
            if upper == "R":
                found.append((tips[i], R @ self._limbs.platform_frames[i][:, 0]))
        half = BAR * self.size
        return np.array([[place - half * axis, place + half * axis] for place, axis in found]).reshape(-1, 2, 3)


def _on_plate(points: Array, plate: Array) -> Array:
    """Points (n, 3) of a plate that is displaced and turned (6,)."""
    return points @ exponential(plate[3:]).T + plate[:3] if plate.any() else points


def _radius(piston: model.Piston, xi: Array) -> Array:
    """Radii of a piston at distances from its tip [m]."""
    parts = piston.parts[::-1]
    ends = np.cumsum([0.0, *(length for length, _ in parts)])
    places = [end - piston.length * 1e-9 * side for k, end in enumerate(ends) for side in (1, -1)][1:-1]
    depths = [max(at.depth) for _, samples in parts for at in (samples[-1], samples[0])]
    found = 0.5 * np.interp(xi, places, depths)
    return found if min(depths) > 0 else np.full_like(found, np.nan)


def convex_hull(points: Array) -> NDArray[np.intp]:
    """The corners of the hull of about coplanar points (n, 3) in their order; of points on a line all of them."""
    arms = points - points.mean(axis=0)
    first, second, _ = np.linalg.svd(arms)[2]
    flat = np.stack([arms @ first, arms @ second], axis=1)
    order = np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))
    while len(order) > 3:
        before, after = flat[np.roll(order, 1)] - flat[order], flat[np.roll(order, -1)] - flat[order]
        inward = before[:, 1] * after[:, 0] - before[:, 0] * after[:, 1] < -1e-9 * np.ptp(flat) ** 2
        if not inward.any():
            break
        order = np.delete(order, inward.argmax())
    return order
