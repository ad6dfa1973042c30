"""Static equilibrium of a robot, Eq. (T7.1)."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space

from flexapod.mechanics.layout import LEG_PARAMETERS, PAYLOAD_PARAMETERS, columns
from flexapod.solve.system import RobotSystem, State
from flexapod.typing import Array


@dataclass(frozen=True, kw_only=True)
class Equilibrium:
    """Result of a search: the state, whether it is one, and in words why not."""

    state: State
    found: bool
    reason: str = ""


def saddle_solve(A: Array, G: Array, r: Array, g: Array) -> tuple[Array, Array]:
    """Solve [[A, G^T], [G, 0]] (x, lam) = (r, g) with rows and columns scaled to unit size."""
    size = len(A)
    full = np.block([[A, G.T], [G, np.zeros((len(G), len(G)))]])
    scale = 1.0 / np.sqrt(np.maximum(np.abs(full).max(axis=1), 1e-300))
    scale[:size] = 1.0 / np.sqrt(np.maximum(np.abs(np.diag(A)), 1e-12 * np.abs(A).max()))
    scale[size:] = 1.0 / np.maximum(np.abs(G * scale[:size]).max(axis=1), 1e-300)
    solution = scale * np.linalg.solve(scale[:, None] * full * scale, scale * np.concatenate([r, g]))
    return solution[:size], solution[size:]


def equilibrium(system: RobotSystem, start: State, l_cmd: Array, force: Array, wrench: Array) -> Equilibrium:
    """Static equilibrium at commanded lengths (6,) [m] under gravity, drive forces (6,) [N] and a wrench (6,).

    Newton from ``start`` (undeformed); where that fails, the loads grow in ten steps.
    """
    rest = replace(start, v=np.zeros(system.size), v_dot=np.zeros(system.size))
    found = _newton(system, rest, l_cmd, force, wrench)
    if not found.found:
        state = rest
        for share in np.linspace(0.1, 1.0, 10):
            found = _newton(_scaled(system, share), state, l_cmd, share * force, share * wrench)
            if not found.found:
                break
            state = found.state
    if not found.found:
        return replace(found, reason=f"no equilibrium: {found.reason}")
    return _stable(system, found, wrench)


def _scaled(system: RobotSystem, share: float) -> RobotSystem:
    """Return the same robot in ``share`` of its gravity."""
    leg_p, payload_p = system.leg_p.copy(), system.payload_p.copy()
    leg_p[:, columns(LEG_PARAMETERS, "gravity")] *= share
    payload_p[columns(PAYLOAD_PARAMETERS, "gravity")] *= share
    return replace(system, leg_p=leg_p, payload_p=payload_p)


def _newton(system: RobotSystem, x: State, l_cmd: Array, force: Array, wrench: Array) -> Equilibrium:
    l_index = system.kernel.shapes.l_index
    best = np.inf
    for _ in range(40):
        r, g = system.residual(x, system.command(x, l_cmd, np.zeros(6), force), wrench)
        gap = x.q[system.held, l_index] - l_cmd[system.held]
        m = system.matrices(x, wrench)
        try:
            step, dlam = saddle_solve(m.K, m.G, -r, -np.concatenate([g, gap]))
        except np.linalg.LinAlgError:
            return Equilibrium(state=x, found=False, reason="the stiffness of the robot is singular")
        if not np.isfinite(step).all():
            return Equilibrium(state=x, found=False, reason="the stiffness of the robot is singular")
        largest = np.abs(step).max()
        if largest > 0.5:  # half a radian or half a metre is no elastic deformation
            return Equilibrium(
                state=x, found=False, reason="the legs give way (the payload would move by half a metre)"
            )
        x = system.moved(x, step)
        drive = x.drive.copy()
        drive[system.held] -= dlam[18:]
        x = replace(x, lam=x.lam + dlam[:18].reshape(6, 3), drive=drive)
        if largest < 1e-13 or (largest < 1e-10 and largest >= best):
            return Equilibrium(state=x, found=True)
        best = largest
    return Equilibrium(state=x, found=False, reason="Newton's method does not settle; the robot is close to buckling")


def _stable(system: RobotSystem, found: Equilibrium, wrench: Array) -> Equilibrium:
    """Refuse an equilibrium from which the robot would fall: negative stiffness on the constraints."""
    m = system.matrices(found.state, wrench)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(m.M), 1e-9))
    N = null_space(m.G * scale)
    lowest = np.linalg.eigvalsh((N.T * scale) @ m.K @ (scale[:, None] * N))[0] if N.size else 1.0
    if lowest <= 0:
        reason = "no equilibrium: the balanced pose is unstable, the robot buckles under its load"
        return replace(found, found=False, reason=reason)
    return found
