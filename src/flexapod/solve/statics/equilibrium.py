"""Static equilibrium of a robot, at one pose or at many at once, Eq. (T7.1)."""

from dataclasses import dataclass, replace

import numpy as np

from flexapod.common.arrays import Array, Index, Mask
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, PAYLOAD_PARAMETERS, columns
from flexapod.solve.batch import RestMatrices, RestStates, matrices_at_rest, residual_at_rest
from flexapod.solve.saddle_point import cholesky_each, solve_each
from flexapod.solve.statics.block_arrow import arrow_solve
from flexapod.solve.statics.ideal_robot import with_substitutes
from flexapod.solve.statics.minimum_energy_forces import least_energy
from flexapod.solve.statics.reduction import Motions, independent_motions, reduce_stiffness
from flexapod.solve.system import State, System

FOUND, SINGULAR, GIVES_WAY, NOT_SETTLED, UNSTABLE, TOO_FAR = range(6)
FARTHEST = 100.0  # what stands for a held pivot may move by while another coordinate moves by one, [m] and [rad]
REASONS = (
    "",
    "the stiffness of the robot is singular",
    "the legs give way (the payload would move by half a metre)",
    "Newton's method does not settle; the robot is close to buckling",
    "the balanced pose is unstable, the robot buckles under its load",
    "too far from home: the shape or step that stands there for what a joint or drive holds moves by {most:.3g} here "
    f"where another coordinate moves by 1 (at most {FARTHEST:g})",
)


@dataclass(frozen=True, kw_only=True)
class Equilibrium:
    """Result of a search: the state, whether it is an equilibrium, and as text why not."""

    state: State
    found: bool
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class Equilibria:
    """Results of P searches: the states, and for each `FOUND` or why it is none, an index into `REASONS`.

    ``m``, ``motions``: matrices and independent motions at those found; ``most`` (P,): as of `reduction.Motions`, NaN
    without a search that settled.
    """

    states: RestStates
    code: np.ndarray
    m: RestMatrices
    motions: Motions
    most: Array

    def one(self, k: int) -> Equilibrium:
        """Equilibrium of one pose, with its reason as text."""
        code = int(self.code[k])
        reason = f"no equilibrium: {REASONS[code].format(most=self.most[k])}" if code else ""
        return Equilibrium(state=self.states.state(k), found=code == FOUND, reason=reason)


def equilibrium(system: System, start: State, command: Array, force: Array, wrench: Array) -> Equilibrium:
    """Static equilibrium at commanded values (legs, ports) [m], [rad] under gravity, drive forces and a wrench (6,).

    See `equilibria`.
    """
    return equilibria(system, RestStates.from_state(start), command[None], force[None], wrench).one(0)


def equilibria(system: System, start: RestStates, command: Array, force: Array, wrench: Array) -> Equilibria:
    """Static equilibria under gravity, forces of drives and a wrench.

    Newton from ``start`` (undeformed); where that fails, loads grow and gaps close in ten steps. An equilibrium from
    which the robot would fall (negative stiffness on the constraints) is none. Forces that nothing elastic determines
    are those of `shared.least_energy`.

    Parameters
    ----------
    system : System
    start : RestStates
        P states; closures and held coordinates may have gaps, as those of welded legs on a rigid path have.
    command, force : ndarray, shape (P, legs, ports)
        Values of held coordinates and of the drives' springs [m], [rad]; feed-forward forces [N], [N m].
    wrench : ndarray, shape (6,)
        At the tool.
    """
    if not system.substitutes.size:
        system = with_substitutes(system, start[:1])
    acts = _Acts(command=command, force=force, wrench=wrench, kept=np.zeros_like(start.lam))
    states, code = _newton(system, start, acts)
    lost = np.flatnonzero(code)
    if lost.size:
        part, codes = _loaded_slowly(system, start[lost], acts[lost])
        states, code[lost] = states.replace_states(lost, part), codes
    found = np.flatnonzero(code == FOUND)
    m = matrices_at_rest(system, states[found], wrench)
    if system.has_self_stress and found.size:
        states = states.replace_states(found, least_energy(system, states[found], m))
        m = matrices_at_rest(system, states[found], wrench)
    motions, most = independent_motions(system, m), np.full(len(start), np.nan)
    most[found], near = motions.most, motions.most <= FARTHEST
    stable = _stable(system, m, motions)
    code[found[~stable]], code[found[~near]] = UNSTABLE, TOO_FAR
    kept = np.flatnonzero(stable & near)
    if kept.size < found.size:
        m, motions = m[kept], motions[kept]
    return Equilibria(states=states, code=code, m=m, motions=motions, most=most)


@dataclass(frozen=True, kw_only=True)
class _Acts:
    """Commands and loads on P states, and the share that a load step leaves of gaps and gravity.

    ``kept`` (P, legs, rows): gaps of the closures that are left.
    """

    command: Array
    force: Array
    wrench: Array
    kept: Array

    def __getitem__(self, chosen: Index) -> "_Acts":
        return replace(self, command=self.command[chosen], force=self.force[chosen], kept=self.kept[chosen])


def _loaded_slowly(system: System, x: RestStates, acts: _Acts) -> tuple[RestStates, np.ndarray]:
    """Newton with a tenth of the loads more and of the gaps less in each of ten steps, as far as each pose gets."""
    code, held = np.full(len(x), FOUND), system.held[:, system.ports]
    _, _, gap = residual_at_rest(system, x, acts.command, acts.force, acts.wrench)
    begun = np.where(held, x.q[..., system.ports], acts.command)
    for share in np.linspace(0.1, 1.0, 10):
        on = np.flatnonzero(code == FOUND)
        if not on.size:
            break
        part = _Acts(
            command=begun + share * (acts.command - begun),
            force=share * acts.force,
            wrench=share * acts.wrench,
            kept=(1.0 - share) * gap,
        )
        states, codes = _newton(_scaled(system, share), x[on], part[on])
        x, code[on] = x.replace_states(on, states), codes
    return x, code


def _scaled(system: System, share: float) -> System:
    """Return the same robot in ``share`` of its gravity."""
    leg_p, payload_p = system.leg_p.copy(), system.payload_p.copy()
    leg_p[:, columns(LEG_PARAMETERS, "gravity")] *= share
    payload_p[columns(PAYLOAD_PARAMETERS, "gravity")] *= share
    return replace(system, leg_p=leg_p, payload_p=payload_p)


def _newton(system: System, x: RestStates, acts: _Acts) -> tuple[RestStates, np.ndarray]:
    """Newton at every pose that has neither settled nor failed; states and codes."""
    code, best = np.full(len(x), NOT_SETTLED), np.full(len(x), np.inf)
    on = np.arange(len(x))
    for _ in range(40):
        every = on.size == len(x)
        new, largest = _newton_step(system, *((x, acts) if every else (x[on], acts[on])))
        singular = ~np.isfinite(largest)
        away = ~singular & (largest > 0.5)  # half a radian or half a metre is not an elastic deformation
        code[on[singular]], code[on[away]] = SINGULAR, GIVES_WAY
        good = ~singular & ~away
        x = new if every and good.all() else x.replace_states(on[good], new[np.flatnonzero(good)])
        done = good & ((largest < 1e-13) | ((largest < 1e-10) & (largest >= best[on])))
        code[on[done]] = FOUND
        best[on] = largest
        on = on[good & ~done]
        if not on.size:
            break
    return x, code


def _newton_step(system: System, x: RestStates, acts: _Acts) -> tuple[RestStates, Array]:
    """States after a step, and the largest coordinate of the step (P,); NaN where the stiffness is singular."""
    r, r_payload, g = residual_at_rest(system, x, acts.command, acts.force, acts.wrench)
    gap = np.zeros(x.q.shape)
    gap[..., system.ports] = np.where(system.held[:, system.ports], x.q[..., system.ports] - acts.command, 0.0)
    step = arrow_solve(system, matrices_at_rest(system, x, acts.wrench), r, r_payload, g - acts.kept, gap)
    largest = np.maximum(np.abs(step.dq).max(axis=(1, 2)), np.abs(step.dy).max(axis=1, initial=0.0))
    dy = step.dy if np.isfinite(largest).all() else np.nan_to_num(step.dy)  # no rotation by NaN
    moved = x.displace(step.dq, dy)
    return replace(moved, lam=x.lam + step.dlam, drive=x.drive + step.drive), largest


def _stable(system: System, m: RestMatrices, motions: Motions) -> Mask:
    """Test whether the stiffness on the constraints is positive definite, (P,).

    By Sylvester's law of inertia it is where B of every leg and the payload's Schur complement are. Factors tell, not
    eigenvalues: their sign does not depend on how much stiffer another part is.
    """
    if motions.N is not None:
        return cholesky_each(motions.stiffness(system, m))[1]
    A = reduce_stiffness(system, motions.bases, m)
    rest, stable = A.S, np.ones(len(A.S), dtype=bool)
    for B, C in zip(A.B, A.C, strict=True):
        if B.shape[-1]:
            stable &= cholesky_each(B)[1].all(axis=1)
            rest = rest - (C.swapaxes(-1, -2) @ solve_each(B, C)).sum(axis=1)
    rest = np.nan_to_num(0.5 * (rest + rest.swapaxes(1, 2)))  # NaN where a leg's part is singular: it is not stable
    return stable & cholesky_each(rest)[1]
