"""The same mechanisms in MuJoCo: open trees, cut at the platform, and multipliers of the equalities that close them.

MuJoCo gives the inertia forces of the trees (`mj_inverse`), Jacobians and their rates; a ball is three equalities of
points (its "connect"), any other end six of bodies (its "weld"). Positions are closed with its own Jacobians.
"""

from __future__ import annotations

import mujoco
import numpy as np

LEAST = 1e-12  # kg, kg m^2: MuJoCo takes no body without mass


def _n(values):
    return " ".join(repr(float(x)) for x in np.ravel(values))


def _inertial(body):
    i = body.inertia
    full = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
    return f'<inertial pos="{_n(body.com)}" mass="{_n([max(body.mass, LEAST)])}" fullinertia="{_n(full)}"/>'


def _links(chain, count):
    """Joints between neighbouring bodies, with the body they carry: (joints, body or None), the last one is the tip."""
    links, before = [], 0
    for after in sorted({body.after for body in chain.bodies} | {count}):
        bodies = [body for body in chain.bodies if body.after == after]
        links.append((chain.joints[before:after], bodies))
        before = after
    return links


def _tree(chain, name, count):
    """Nested bodies; every frame is the world's at home, so that points and axes stand as they are."""
    text, ends = "", ""
    for i, (joints, bodies) in enumerate(_links(chain, count)):
        text += f'<body name="{name}_{i}">\n'
        ends += "</body>\n"
        for j in joints:
            kind = "hinge" if j.kind == "R" else "slide"
            text += f'<joint type="{kind}" axis="{_n(j.axis)}" pos="{_n(j.point)}"/>\n'
        if not bodies:
            text += f'<inertial pos="{_n(chain.tip)}" mass="{LEAST}" diaginertia="{LEAST} {LEAST} {LEAST}"/>\n'
        for k, body in enumerate(bodies):
            text += _inertial(body) if k == 0 else f'<body name="{name}_{i}_{k}">{_inertial(body)}</body>'
    return text + ends, f"{name}_{len(_links(chain, count)) - 1}"


class Tree:
    """A mechanism as MuJoCo has it."""

    def __init__(self, mechanism):
        self.mechanism = mechanism
        self.counts = [len(leg.joints) - 3 * leg.ball for leg in mechanism.legs]
        parts = [_tree(leg, f"leg{i}", n) for i, (leg, n) in enumerate(zip(mechanism.legs, self.counts, strict=True))]
        hub, _ = _tree(mechanism.platform, "hub", 6)
        xml = "\n".join([
            "<mujoco>",
            f'<compiler angle="radian" autolimits="false" boundmass="{LEAST}" boundinertia="{LEAST}" '
            'balanceinertia="false"/>',
            f'<option gravity="{_n(mechanism.gravity)}"><flag contact="disable"/></option>',
            "<worldbody>", *(text for text, _ in parts), hub, "</worldbody>", "</mujoco>",
        ])  # fmt: skip
        self.model = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.model)
        self.tips = [self.model.body(name).id for _, name in parts]
        self.hub = self.model.body("hub_0").id
        self.size = self.model.nv

    def _jacobian(self, body, point, rate=False):
        place, turn = np.zeros((3, self.size)), np.zeros((3, self.size))
        (mujoco.mj_jacDot if rate else mujoco.mj_jac)(self.model, self.data, place, turn, point, body)
        return place, turn

    def _point(self, body, home):
        return self.data.xpos[body] + self.data.xmat[body].reshape(3, 3) @ home

    def closures(self, rate=False):
        """Matrix of the equalities (or its rate): points of tips less those of the platform, then turns."""
        rows = []
        for leg, tip in zip(self.mechanism.legs, self.tips, strict=True):
            point = self._point(self.hub, leg.tip)
            one, other = self._jacobian(tip, point, rate), self._jacobian(self.hub, point, rate)
            rows += [a - b for a, b in zip(one, other, strict=True)][: 1 if leg.ball else 2]
        return np.concatenate(rows)

    def gaps(self):
        """Distances of the equalities; turns from the skew part."""
        rows = []
        for leg, tip in zip(self.mechanism.legs, self.tips, strict=True):
            rows.append(self._point(tip, leg.tip) - self._point(self.hub, leg.tip))
            if not leg.ball:
                E = self.data.xmat[tip].reshape(3, 3) @ self.data.xmat[self.hub].reshape(3, 3).T
                rows.append(np.array([E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]]) / 2)
        return np.concatenate(rows)

    def _place(self, q):
        self.data.qpos[:] = q
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def move(self, given, rates, accelerations, guess=None, steps=2):
        """Set positions, rates and accelerations with the independent coordinates as given; returns the positions."""
        chosen = self.size - 6 + np.array(self.mechanism.independent)
        q = np.zeros(self.size) if guess is None else guess.copy()
        start = q[chosen].copy()
        pick = np.eye(self.size)[chosen]

        def all_rows():
            return np.concatenate([self.closures(), pick])

        for share in np.arange(1, steps + 1) / steps:
            aim, before, error = start + share * (given - start), np.inf, np.inf
            for _ in range(40):
                self._place(q)
                miss = np.r_[self.gaps(), q[chosen] - aim]
                before, error = error, np.abs(miss).max()
                if error < 1e-14 or (error < 1e-12 and error >= before):
                    break
                q = q - np.linalg.lstsq(all_rows(), miss, rcond=1e-9)[0]
        zero = np.zeros(len(self.closures()))
        self.data.qvel[:] = np.linalg.lstsq(all_rows(), np.r_[zero, rates], rcond=1e-9)[0]
        mujoco.mj_fwdVelocity(self.model, self.data)
        bend = self.closures(rate=True) @ self.data.qvel
        self.data.qacc[:] = np.linalg.lstsq(all_rows(), np.r_[-bend, accelerations], rcond=1e-9)[0]
        return q

    def forces(self, wrench=None, drive=None):
        """Drive forces (n,), NaN where there is none, and forces (n, 3) of the legs on the platform.

        With `drive` given: the forces at the platform that go with it, and what is left over of the equations.
        """
        mujoco.mj_inverse(self.model, self.data)
        need = self.data.qfrc_inverse.copy()
        if wrench is not None:
            place, turn = self._jacobian(self.hub, self._point(self.hub, self.mechanism.tool))
            need -= place.T @ wrench[:3] + turn.T @ wrench[3:]
        legs, starts = self.mechanism.legs, np.r_[0, np.cumsum(self.counts)]
        has = np.array([leg.drive is not None for leg in legs])
        driven = [starts[i] + leg.drive for i, leg in enumerate(legs) if leg.drive is not None]
        rows = np.cumsum([0, *(3 if leg.ball else 6 for leg in legs)])[:-1]
        G = self.closures()
        if drive is not None:
            need[driven] -= drive[has]
            lam = np.linalg.lstsq(G.T, -need, rcond=1e-9)[0]
            return np.abs(need + G.T @ lam).max(), np.array([lam[r : r + 3] for r in rows])
        loose = np.delete(np.arange(self.size), driven)
        lam = np.linalg.lstsq(G.T[loose], -need[loose], rcond=1e-9)[0]
        found = np.full(len(legs), np.nan)
        found[has] = (need + G.T @ lam)[driven]
        return found, np.array([lam[r : r + 3] for r in rows])
