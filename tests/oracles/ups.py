"""Rigid legs of n-UPS between servos on a floor that moves: Newton and Euler by hand, in NumPy alone.

Twelve numbers say where all is: displacement of the payload's centre of mass and small turns from its attitude at rest,
both in axes of the floor; displacement of a point of the floor and small turns about it, in axes of the world. At rest
forces are functions of these and of accelerations; derivatives are those of complex steps, exact to rounding.
"""

from dataclasses import dataclass

import numpy as np

STEP = 1e-30
REL, FLOOR = slice(0, 6), slice(6, 12)


def rotation(angles):
    """Of small turns about x, y, z in a row, of complex ones too."""
    (a, b, c), (x, y, z) = np.cos(angles), np.sin(angles)
    about_x, about_y = np.array([[1, 0, 0], [0, a, -x], [0, x, a]]), np.array([[b, 0, y], [0, 1, 0], [-y, 0, b]])
    return about_x @ about_y @ np.array([[c, -z, 0], [z, c, 0], [0, 0, 1]])


def slope(of, at):
    """Derivatives of a function of numbers (n,), its own axes first."""
    each = [np.imag(of(at + 1j * STEP * one)) / STEP for one in np.eye(len(at))]
    return np.stack(each, axis=-1)


@dataclass
class Hexapod:
    """Legs and payload: places in axes of the floor, of the payload from its centre of mass in axes of its own."""

    base: np.ndarray
    joints: np.ndarray
    tool: np.ndarray
    mass: float
    inertia: np.ndarray
    cylinder: tuple  # mass, centre from the base joint, transverse inertia about it
    piston: tuple  # mass, length
    stiffness: float
    damping: float
    gravity: np.ndarray
    load: np.ndarray  # at the tool, in axes of the world
    about: np.ndarray  # point about which the floor turns
    place: np.ndarray
    attitude: np.ndarray
    command: np.ndarray  # of strokes

    def rest(self):
        """Step to the equilibrium under weight and load."""
        for _ in range(30):
            net = lambda y: self.net(np.concatenate([y, np.zeros(6)]), np.zeros(12))  # noqa: E731
            step = -np.linalg.solve(slope(net, np.zeros(6)), net(np.zeros(6)))
            self.place, self.attitude = self.place + step[:3], rotation(step[3:]) @ self.attitude
            if np.abs(step).max() < 1e-14:
                return
        raise AssertionError("no equilibrium")

    def world(self, y):
        """From points of the floor, by their places in its axes, to the world; and its axes."""
        axes = rotation(y[9:])
        return (lambda at: self.about + y[6:9] + (at - self.about) @ axes.T), axes

    def platform(self, y, at):
        """A point of the payload in axes of the floor."""
        return self.place + y[:3] + at @ (rotation(y[3:6]) @ self.attitude).T

    def legs(self, y):
        """Base joints and unit vectors in the world, lengths."""
        to, _ = self.world(y)
        foot, tip = to(self.base), to(self.platform(y, self.joints))
        length = np.sqrt(((tip - foot) ** 2).sum(axis=1))
        return foot, (tip - foot) / length[:, None], length

    def bodies(self, y):
        """Centres of mass of cylinders and pistons in the world."""
        foot, u, length = self.legs(y)
        return foot + self.cylinder[1] * u, foot + (length - self.piston[1] / 2)[:, None] * u

    def forces(self, y, a, more=0.0):
        """Forces on platform and base (legs, 3), along strokes (legs,), in axes of the world; ``more``: on strokes."""
        (m1, d1, I1), (m2, L) = self.cylinder, self.piston
        _, u, length = self.legs(y)
        moved = lambda of: slope(of, np.zeros(12)) @ a if a.any() else np.zeros((len(u), 3))  # noqa: E731
        felt1, felt2 = (moved(lambda y, k=k: self.bodies(y)[k]) - self.gravity for k in (0, 1))
        turned = np.cross(u, moved(lambda y: self.legs(y)[1]))
        push = self.stiffness * (self.command - length) + more
        # of the whole leg about its base joint: tip takes -F, s x m (a - g) + I u x u''
        moment = d1 * m1 * np.cross(u, felt1) + (length - L / 2)[:, None] * m2 * np.cross(u, felt2)
        moment = moment + (I1 + m2 * L**2 / 12) * turned
        across = np.cross(u, moment) / length[:, None]  # -l u x F = moment, so that F = u x moment / l across
        on_platform = across + (push - m2 * (felt2 * u).sum(axis=1))[:, None] * u
        return on_platform, on_platform + m1 * felt1 + m2 * felt2, push

    def net(self, y, a, more=0.0, wrench=0.0):
        """What is left of forces and moments on the payload about its centre, axes of the world; 0 if it moves so."""
        _, axes = self.world(y)
        R = axes @ rotation(y[3:6]) @ self.attitude
        centre = lambda y: self.world(y)[0](self.platform(y, np.zeros(3)))  # noqa: E731
        force = self.forces(y, a, more)[0]
        w = self.load + wrench
        arm, tool = self.joints @ R.T, R @ self.tool
        moment = np.cross(arm, force).sum(axis=0) + np.cross(tool, w[:3]) + w[3:]
        inertia = R @ self.inertia @ R.T
        linear = slope(centre, np.zeros(12)) @ a if a.any() else np.zeros(3)
        return np.concatenate([
            force.sum(axis=0) + w[:3] + self.mass * (self.gravity - linear),
            moment - inertia @ (axes @ a[3:6] + a[9:]),
        ])  # fmt: skip

    def seen(self, y, a, point, more=0.0):
        """Outputs by name, in axes of the floor; of accelerometers in those of the payload at rest, turned with it."""
        _, axes = self.world(y)
        platform, base, push = self.forces(y, a, more)
        _, u, length = self.legs(y)
        at = lambda y: self.world(y)[0](self.platform(y, point))  # noqa: E731
        felt = (slope(at, np.zeros(12)) @ a if a.any() else np.zeros(3)) - self.gravity
        return {
            "tool": np.concatenate([self.platform(y, self.tool), y[3:6]]),
            "com": self.platform(y, np.zeros(3)),
            "stroke": length,
            "encoder": length,
            "drive-force": push,
            "force-sensor:drive": push,
            "joint-force": (platform @ axes).ravel(),
            "force-sensor:platform": (platform * u).sum(axis=1),
            "force-sensor:base": (base * u).sum(axis=1),
            "accelerometer": felt @ axes @ rotation(y[3:6]),
        }

    def response(self, hz, point):
        """Outputs by name, (outputs, inputs, f): wrench, force along world axes at the tool's point, command, floor."""
        s, n, none = 2j * np.pi * np.asarray(hz), len(self.base), np.zeros(12)
        K = -slope(lambda y: self.net(y, none), none)
        M = -np.stack([self.net(none, one) - self.net(none, none) for one in np.eye(12)], axis=1)
        J = slope(lambda y: self.legs(y)[2], none)[:, REL]
        by_push = np.stack([self.net(none, none, one) - self.net(none, none) for one in np.eye(n)], axis=1)
        by_wrench = np.stack([self.net(none, none, 0.0, one) - self.net(none, none) for one in np.eye(6)], axis=1)
        base = self.seen(none, none, point)
        names = list(base)
        at = lambda y, a, more: np.concatenate(list(self.seen(y, a, point, more).values()))  # noqa: E731
        # complex steps pass through `slope` of accelerations only where these are 0
        by_y = slope(lambda y: at(y, none, np.zeros(n)), none)
        by_a = np.stack([at(none, one, np.zeros(n)) - at(none, none, np.zeros(n)) for one in np.eye(12)], axis=1)
        by_more = np.stack([at(none, none, one) - at(none, none, np.zeros(n)) for one in np.eye(n)], axis=1)
        found = []
        for x in s:
            spring = self.stiffness + x * self.damping
            dynamic = x**2 * M[:, REL] + K[:, REL] + x * self.damping * by_push @ J
            # columns: wrench, command by its second derivative, floor by its accelerations; what strokes feel besides
            put = np.hstack([by_wrench, by_push * spring / x**2, -(M[:, FLOOR] + K[:, FLOOR] / x**2)])
            q = np.linalg.solve(dynamic, put)
            floor = np.hstack([np.zeros((6, 6 + n)), np.eye(6)]) / x**2
            y = np.vstack([q, floor])
            more = -x * self.damping * J @ q
            more[:, 6 : 6 + n] += np.eye(n) * spring / x**2
            found.append(by_y @ y + by_a @ (x**2 * y) + by_more @ more)
        H, rows, k = np.stack(found, axis=-1), {}, 0
        for name in names:
            rows[name] = H[k : k + len(base[name])]
            k += len(base[name])
        return rows
