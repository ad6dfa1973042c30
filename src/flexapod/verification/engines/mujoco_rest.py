"""Model in MuJoCo at rest: equilibria of its springs, drives and loops, and the compliance of its tool."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexapod.common.arrays import Array
from flexapod.verification.engines.mujoco_forces import mujoco_module

STEP = 1e-7  # m, rad: of differences
SMALL = 1e-6  # m, rad: motion of the tool by which compliance is measured
ROUNDING = 1e-14  # m, rad: a last step of Newton's
MOST_ITERATIONS = 40


class MujocoStatics:
    """A model from MJCF text with a body `payload`, a site `tool` on it and a keyframe, where it starts.

    All is MuJoCo's: `mj_forward` says which accelerations are left, with loops as soft as the file makes them.
    """

    payload: int
    home: Array

    def __init__(self, text: str) -> None:
        self.mujoco: Any = mujoco_module()
        self.model: Any = self.mujoco.MjModel.from_xml_string(text)
        self.model.opt.tolerance, self.model.opt.iterations = 0, 50
        self.data: Any = self.mujoco.MjData(self.model)
        self.mujoco.mj_resetDataKeyframe(self.model, self.data, 0)
        self.payload, self.home = self.model.body("payload").id, self.data.qpos.copy()

    def residual_forces(self, q: Array, wrench: Array) -> Array:
        """Forces on all coordinates (n,) that are not in balance at rest, with a wrench (6,) at the tool."""
        model, data = self.model, self.data
        data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = q, 0.0, 0.0
        self.mujoco.mj_kinematics(model, data)
        arm = data.site("tool").xpos - data.xipos[self.payload]
        data.xfrc_applied[self.payload] = np.r_[wrench[:3], wrench[3:] + np.cross(arm, wrench[:3])]
        self.mujoco.mj_forward(model, data)
        found = np.zeros(model.nv)
        self.mujoco.mj_mulM(model, data, found, data.qacc)
        return found

    def force_gradient(self, q: Array) -> Array:
        """Gradient of the residual forces by the coordinates, (n, n), by central differences."""
        still, size = np.zeros(6), self.model.nv
        rows = [self.residual_forces(self._moved(q, sign * STEP * x), still) for x in np.eye(size) for sign in (1, -1)]
        return np.array([(a - b) / (2 * STEP) for a, b in zip(rows[::2], rows[1::2], strict=True)]).T

    def equilibrium(self, q: Array, wrench: Array, slopes: Array) -> Array:
        """Coordinates at which all is in balance, by Newton from `q`."""
        for _ in range(MOST_ITERATIONS):
            step = np.asarray(np.linalg.solve(slopes, -self.residual_forces(q, wrench)), dtype=float)
            q = self._moved(q, step)
            if np.abs(step).max() < ROUNDING:
                break
        return q

    def compliance(self, expected: Array) -> Array:
        """Motions of the tool (6, k) by unit wrenches, those k whose compliance `expected` (6,) is not 0.

        Displacement and turn along and about world axes; forces are such that the tool moves by a micrometre.
        """
        middle = self.equilibrium(self.home, np.zeros(6), self.force_gradient(self.home))
        slopes, columns = self.force_gradient(middle), []
        for k in np.flatnonzero(expected):
            force = SMALL / expected[k] * np.eye(6)[k]
            (p, R), (o, S) = (self._tool(self.equilibrium(middle, sign * force, slopes)) for sign in (1, -1))
            turn = (R @ S.T - S @ R.T) / 2
            columns.append(np.r_[p - o, turn[2, 1], turn[0, 2], turn[1, 0]] / (2 * force[k]))
        return np.array(columns).T

    def _moved(self, q: Array, step: Array) -> Array:
        q = q.copy()
        self.mujoco.mj_integratePos(self.model, q, step, 1.0)
        return q

    def _tool(self, q: Array) -> tuple[Array, Array]:
        self.data.qpos[:] = q
        self.mujoco.mj_kinematics(self.model, self.data)
        return self.data.site("tool").xpos.copy(), self.data.site("tool").xmat.reshape(3, 3).copy()
