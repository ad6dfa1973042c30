"""Outputs of a linear model by states and inputs: places, forces, sensors, Eqs. (T20.17)-(T20.23)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.rotations import exponential, matrix
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.solve.batch import matrices_at_rest
from flexapod.solve.kernel import evaluate
from flexapod.solve.linear.channels import PlantChannel
from flexapod.solve.linear.first_order import FirstOrder
from flexapod.solve.linear.plant import Plant, carried_masses, leg_lines
from flexapod.solve.linear.second_order import SecondOrder, point_motion
from flexapod.solve.statics.stiffness import tool_motion


@dataclass(frozen=True, kw_only=True)
class PlantOutputs:
    """A plant at one pose with its motions by states and inputs, columns (n + m)."""

    plant: Plant
    second: SecondOrder
    first: FirstOrder
    inputs: Sequence[PlantChannel]

    def row(self, channel: PlantChannel) -> Array:
        """An output by states and inputs, (n + m,)."""
        i, axis = channel.leg, channel.axis
        match channel.group:
            case "tool":
                return (tool_motion(self.plant.robot, self.plant.x.pose)[0] @ self._hub(self.first.place))[axis]
            case "com":
                return self._hub(self.first.place)[axis]
            case "tool-base" | "com-base":
                return self._from_base(channel.group == "tool-base")[axis]
            case "stroke":
                return self._leg(self.place, i)[self._moved(i)]
            case "encoder":
                return self._measured(i)
            case "drive-force" | "force-sensor:drive":
                return self._drive(i)
            case "joint-force":
                return self.closure[i, axis]
            case "force-sensor:platform":
                return self._along(i, self.closure[i, :3], self.plant.x.lam[0, i, :3])
            case "force-sensor:base":
                return self._at_base(i)
            case _:
                return self._acceleration(channel)

    def _hub(self, of: Array) -> Array:
        return self.second.flat[0, self.plant.system.legs * self.plant.system.n :] @ of

    def _from_base(self, tool: bool) -> Array:
        """Displacement and turn of the tool, or the centre of mass, from the base plate on its mount, world axes."""
        robot, x = self.plant.robot, self.plant.x
        motion = tool_motion(robot, x.pose)[0]
        found = motion @ self._hub(self.first.place) if tool else np.zeros((6, self.first.place.shape[1]))
        found[:3] = found[:3] if tool else self._hub(self.first.place)[:3]
        if robot.base_mount is None:
            return found
        f = self.plant.system.kernel.shapes.index("f")
        base, at, (_, pitch, yaw) = self._leg(self.place, 0)[f : f + 6], x.q[0, 0, f : f + 3], x.q[0, 0, f + 3 : f + 6]
        turns = exponential(np.array([[0, 0, yaw], [0, pitch, 0]]))
        axes = np.stack([turns[0] @ turns[1][:, 0], turns[0][:, 1], [0.0, 0.0, 1.0]], axis=1)  # of roll, pitch, yaw
        arm = matrix(x.pose[:, 3:])[0] @ (robot.tool - robot.com) if tool else np.zeros(3)
        turn = axes @ base[3:]
        found[:3] -= base[:3] + np.cross(turn.T, x.pose[0, :3] + arm - robot.base_mount.at - at).T
        found[3:] -= turn
        return found

    def _leg(self, flat: Array, i: int) -> Array:
        n = self.plant.system.n
        return flat[i * n : (i + 1) * n]

    def _moved(self, i: int) -> int:
        """Coordinate that the drive of a leg moves, of a passive one its stroke."""
        shapes = self.plant.system.kernel.shapes
        return shapes.index("chi") if self.plant.robot.legs[i].driven == "carriage" else shapes.l_index

    def by_coordinates(self, places: Sequence[PlantChannel]) -> Array:
        """Outputs that are places by flat coordinates, (p, size)."""
        size = self.plant.system.size
        free = replace(
            self.first, A=np.zeros((size, size)), place=np.eye(size), rate=np.zeros((size, size)),
            acceleration=np.zeros((size, size)),
        )  # fmt: skip
        flat = PlantOutputs(
            plant=self.plant, second=replace(self.second, flat=np.eye(size)[None]), first=free, inputs=()
        )
        return np.array([flat.row(channel) for channel in places]).reshape(len(places), size)

    @cached_property
    def place(self) -> Array:
        """All flat coordinates, (size, n + m)."""
        return self.second.flat[0] @ self.first.place

    @cached_property
    def rate(self) -> Array:
        """Rates of all flat coordinates, by states and inputs."""
        return self.second.flat[0] @ self.first.rate

    @cached_property
    def balance(self) -> Array:
        """Forces that closures and held coordinates have to balance, (size, n + m), Eq. (T20.17)."""
        s, f = self.second, self.first
        found = s.on_acceleration[0] @ f.acceleration + s.on_rate[0] @ f.rate + s.on_place[0] @ f.place
        found[:, f.A.shape[1] :] -= s.forces[0]
        return found

    @cached_property
    def closure(self) -> Array:
        """Forces of the closures, (legs, rows, n + m), Eq. (T20.18); of least norm where nothing elastic decides."""
        system, G = self.plant.system, self.jacobian
        counts = ~system.fixed_mask
        legs = counts[: system.legs * system.n].reshape(system.legs, system.n)
        legs[:, system.shared_coordinates] = False
        for name in ("w", "j"):
            if system.kernel.shapes.has(name):
                legs[:, system.kernel.shapes.index(name)] = False
        found = np.linalg.lstsq(G[:, counts].T, -self.balance[counts], rcond=1e-12)[0]
        return np.asarray(found, dtype=np.float64).reshape(system.legs, system.rows, -1)

    @cached_property
    def jacobian(self) -> Array:
        """Jacobian of the closures, (legs rows, size)."""
        system, m = self.plant.system, self.plant.m
        G = np.zeros((system.legs * system.rows, system.size))
        for i in range(system.legs):
            G[i * system.rows : (i + 1) * system.rows, i * system.n : (i + 1) * system.n] = m.J[0, i]
        G[:, system.legs * system.n :] = -m.P[0].reshape(len(G), 6)
        return G

    @cached_property
    def _held(self) -> Array:
        """Forces that hold coordinates, (size, n + m)."""
        return self.balance + self.jacobian.T @ self.closure.reshape(len(self.jacobian), -1)

    def _drive(self, i: int) -> Array:
        """Force of a drive on what it moves, behind its rotor, before the piston's mass, Eq. (T20.19)."""
        system, robot, at = self.plant.system, self.plant.robot, self._moved(i)
        found = np.zeros(self.balance.shape[1])
        if system.held[i, at]:
            found = found + self._leg(self._held, i)[at]
        elif self.plant.port[i] == at:
            name = dict(zip((system.kernel.shapes.index(x) for x, _ in system.kernel.shapes.drives),
                            (x for _, x in system.kernel.shapes.drives), strict=True))[at]  # fmt: skip
            layout = leg_parameters(system.kernel.shapes)
            k, c = (float(system.leg_p[i, columns(layout, f"{name}_{x}")][0]) for x in ("stiffness", "damping"))
            found = -k * self._leg(self.place, i)[at] - c * self._leg(self.rate, i)[at]
            for by, x in ((k, self.first.place), (c, self.first.rate)):
                found += (
                    by * x[self.second.names.index(f"command:{i + 1}")]
                    if f"command:{i + 1}" in self.second.names
                    else 0.0
                )
            found[self.first.A.shape[1] :] += [c.group == "drive" and c.leg == i for c in self.inputs]
        if robot.legs[i].gives:
            K, D = self._elastic
            r = system.kernel.shapes.index("r")
            found = found + K[i, r] @ self._leg(self.place, i) + D[i, r] @ self._leg(self.rate, i)
        return found

    @cached_property
    def _elastic(self) -> tuple[Array, Array]:
        """K and D (legs, n, n) of compliant parts, without loops on rotors."""
        system = self.plant.system
        layout, p = leg_parameters(system.kernel.shapes), system.leg_p.copy()
        for name in ("rotor_stiffness", "rotor_damping"):
            p[:, columns(layout, name)] = 0.0
        m = matrices_at_rest(replace(system, leg_p=p), self.plant.x, self.plant.locked.acts.wrench)
        return m.K[0], m.D[0]

    def _measured(self, i: int) -> Array:
        """Measurement of the encoder of a drive, Eq. (T23.52)."""
        system, leg = self.plant.system, self.plant.robot.legs[i]
        own = self._leg(self.place, i)
        if leg.closed_about == "joint-to-joint":
            n = system.n
            *_, slope = evaluate(
                system.kernel, "leg_loop", system.legs, [self.plant.x.q[0], system.leg_p], [(n, n), (n, n), (1,), (n,)]
            )
            return slope[i] @ own
        return own[system.kernel.shapes.index("r") if leg.gives and leg.measured == "rotor" else self._moved(i)]

    def _along(self, i: int, force: Array, at_rest: Array) -> Array:
        """A force (3, n + m) along the line of the joints of a leg, which turns what there is at rest, (T20.26)."""
        line, by_q = (x[0, i] for x in self._lines)
        length = float(np.linalg.norm(line))
        e, moved = line / length, by_q @ self._leg(self.place, i)
        return e @ force + (at_rest - e * (e @ at_rest)) @ moved / length

    @cached_property
    def _lines(self) -> tuple[Array, Array]:
        return leg_lines(self.plant.system, self.plant.x.q)

    def _at_base(self, i: int) -> Array:
        """Force of the base on a leg along it, all masses of the leg behind it, Eq. (T20.20)."""
        robot, n = self.plant.robot, self.first.A.shape[1]
        M, own = (x[0, i, :3] for x in self._carried)
        found = self.closure[i, :3] + M @ self._leg(self.second.flat[0], i) @ self.first.acceleration
        for k, c in enumerate(self.inputs):
            if c.group == "floor":
                found[:, n + k] += own[:, c.axis]
        mass = float(own[0, 0])
        if robot.base_mount is not None:
            f, share = self.plant.system.kernel.shapes.index("f"), self._plate_mass / robot.count
            plate = self._leg(self.second.flat[0], i)[f : f + 3] @ self.first.acceleration
            for k, c in enumerate(self.inputs):
                if c.group == "floor":
                    plate[:, n + k] += _carried_point(robot.base_mount.at - self.second.about)[:, c.axis]
            found, mass = found - share * plate, mass - share
        for c in self.inputs:
            if c.group == "floor" and c.name in self.second.names and c.axis >= 3:  # weight turns in axes of the floor
                turn = self.first.place[self.second.names.index(c.name)]
                found += mass * np.outer(np.cross(np.eye(3)[c.axis - 3], robot.gravity), turn)
        return self._along(i, found, self.plant.x.lam[0, i, :3] - mass * robot.gravity)

    @cached_property
    def _carried(self) -> tuple[Array, Array]:
        if self.plant.robot.plane is not None:
            raise InputError(
                "is known of robots in space", key="outputs", value="force-sensor:base",
                allowed="of robots in a plane force-sensor:drive, force-sensor:platform, joint-force",
            )  # fmt: skip
        return carried_masses(self.plant, self.second.about)

    @cached_property
    def _plate_mass(self) -> float:
        system = self.plant.system
        of_leg = system.leg_p[:, columns(leg_parameters(system.kernel.shapes), "base_plate_mass")]
        return float(of_leg.sum())

    def _acceleration(self, channel: PlantChannel) -> Array:
        """Reading of an accelerometer on the platform: absolute acceleration less gravity, Eq. (T20.21)."""
        at, axis, n = channel.at if channel.at is not None else np.zeros(3), channel.axis, self.first.A.shape[1]
        motion = point_motion(self.plant, at)[0]
        found = motion @ self._hub(self.first.acceleration)
        x, g = self.plant.x.pose[0], self.plant.robot.gravity
        turn = tool_motion(self.plant.robot, self.plant.x.pose)[0][3:] @ self._hub(self.first.place)
        place = x[:3] + matrix(x[None, 3:])[0] @ at - self.second.about
        for k, c in enumerate(self.inputs):
            if c.group == "floor":
                found[:, n + k] += _carried_point(place)[:, c.axis]
                if c.name in self.second.names:
                    turn[c.axis - 3] += self.first.place[self.second.names.index(c.name)]
        return (found + np.cross(np.eye(3), g).T @ turn)[axis] if g.any() else found[axis]


def _carried_point(place: Array) -> Array:
    """Acceleration (3, 6) of a place (3,) of a base by its own and its angular acceleration."""
    return np.concatenate([np.eye(3), np.cross(np.eye(3), place).T], axis=1)
