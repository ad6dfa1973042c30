"""Robots with flexible pistons in MuJoCo: pistons as rows of rigid pieces with springs between them.

A beam of n elements bends, stretches and twists in the middle of each, by springs EI/h, EA/h, GJ/h; what lies between
two middles is a rigid rod. Legs are open trees; closures are multipliers (`mujoco_trees`). Rest and frequencies come
from forces and inertia that MuJoCo computes, stiffness from differences of these forces, so that weight and thrust act
on frequencies as they do in the engine. The error falls with n^2.
"""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.linalg import eigh, null_space
from tests.oracles.mechanisms import Body, Chain, Joint, Mechanism, _revolved, unit
from tests.oracles.mujoco_trees import Tree


def with_beam(leg, *, EI, EA, GJ, rhoA, mouth, length, n, m=2):
    """The chain with its piston (the last body) as a beam, and the stiffness of every joint of the new chain.

    The joints before the piston stay, and those behind its tip (the ball); the drive stays where it is.
    """
    along, end = unit(leg.tip - leg.base), leg.ball * 3
    first, last = leg.joints[: len(leg.joints) - end], leg.joints[len(leg.joints) - end :]
    bodies, joints, stiff = list(leg.bodies[:-1]), list(first), [0.0] * len(first)
    span = float(np.linalg.norm(leg.tip - leg.base))
    x = np.cross(along, [1.0, 0, 0])
    x = unit(x)
    y = np.cross(along, x)
    guided, free = length - (span - mouth), span - mouth
    middles = [(span - length + guided * (k + 0.5) / m, guided / m, False) for k in range(m if guided > 1e-12 else 0)]
    middles += [(mouth + free * (k + 0.5) / n, free / n, True) for k in range(n)]
    cuts = [span - length, *(place for place, _, _ in middles), span]
    for k in range(len(cuts) - 1):
        low, high = cuts[k], cuts[k + 1]
        mass = rhoA * (high - low)
        centre = leg.base + along * (low + high) / 2
        bodies.append(Body(*_revolved(mass, centre, along, mass * (high - low) ** 2 / 12, 1e-9), len(joints)))
        if k < len(middles):
            place, h, bends = middles[k]
            point = leg.base + along * place
            joints.append(Joint("P", along, point, "stretch"))
            stiff.append(EA / h)
            if bends:
                joints += [Joint("R", axis, point, "bend") for axis in (x, y)]
                stiff += [EI / h] * 2
                if np.isfinite(GJ):
                    joints.append(Joint("R", along, point, "twist"))
                    stiff.append(GJ / h)
    return Chain((*joints, *last), tuple(bodies), leg.drive, leg.base, leg.tip, leg.ball), np.array(stiff)


class Flexible(Tree):
    """A mechanism of chains with springs, its drives locked."""

    def __init__(self, mechanism: Mechanism, stiffness):
        super().__init__(mechanism)
        self.k = np.concatenate([*stiffness, np.zeros(6)])
        starts = np.r_[0, np.cumsum(self.counts)]
        self.locked = [starts[i] + leg.drive for i, leg in enumerate(mechanism.legs) if leg.drive is not None]

    def _rows(self):
        """Closures and locked drives."""
        return np.concatenate([self.closures(), np.eye(self.size)[self.locked]])

    def _pull(self, q, lam):
        """Forces that are left of weight, springs and multipliers."""
        self._place(q)
        self.data.qvel[:] = 0
        self.data.qacc[:] = 0
        mujoco.mj_inverse(self.model, self.data)
        return self.data.qfrc_inverse + self.k * q - self._rows().T @ lam

    def _stiffness(self, q, lam, h=1e-6):
        K = np.empty((self.size, self.size))
        for i in range(self.size):
            step = h * np.eye(self.size)[i]
            K[:, i] = (self._pull(q + step, lam) - self._pull(q - step, lam)) / (2 * h)
        return (K + K.T) / 2

    def rest(self, tolerance=1e-11):
        """Coordinates and multipliers at rest under weight."""
        q, lam = np.zeros(self.size), np.zeros(len(self.closures()) + len(self.locked))
        for _ in range(20):
            r = self._pull(q, lam)
            gap = np.r_[self.gaps(), q[self.locked]]
            if np.abs(gap).max() < tolerance and np.abs(r).max() < 1e-6:
                return q, lam
            K = self._stiffness(q, lam)
            self._place(q)
            A = self._rows()
            saddle = np.block([[K, -A.T], [A, np.zeros((len(A), len(A)))]])
            step = np.linalg.lstsq(saddle, -np.r_[r, gap], rcond=1e-14)[0]
            q, lam = q + step[: self.size], lam + step[self.size :]
        raise ValueError("no rest")

    def frequencies(self, count):
        """The first frequencies [Hz] about the place of rest, and the sag of the platform's coordinates."""
        q, lam = self.rest()
        K = self._stiffness(q, lam)
        self._place(q)
        mujoco.mj_forward(self.model, self.data)
        M = np.empty((self.size, self.size))
        mujoco.mj_fullM(self.model, self.data, M)
        N = null_space(self._rows(), rcond=1e-10)
        values = eigh(N.T @ K @ N, N.T @ M @ N, eigvals_only=True, subset_by_index=[0, count - 1])
        return np.sqrt(values) / (2 * np.pi), q[-6:]
