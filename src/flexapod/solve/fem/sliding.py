"""Reduced solid that slides through the mouth of a turning hub, in material coordinates, Eqs. (T10.12)-(T10.19).

The mouth lies between two stations and has the Saint-Venant flexibility of the solid itself,
Eqs. (T10.12)-(T10.14); motion follows Eqs. (T10.15)-(T10.19).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.solve.fem.reduction import StationModel


@dataclass(frozen=True, kw_only=True)
class Mouth:
    """Flexibility at a station of `model` by its distance from the mouth.

    `bending`: 1 / EI of the solid far from its ends [1/(N m^2)]; `end_rotation`: rotation of the mouth region per
    moment [rad/(N m)], beyond that of a beam, 0 at Poisson's ratio 0; `end_deflection`: deflection per force and per
    distance, of shear and of the mouth region [1/N].
    """

    model: StationModel
    bending: float
    end_rotation: float
    end_deflection: float

    def last(self, length: float) -> int:
        """The free station nearest to the mouth at which the distance from it is half a spacing or more."""
        return int(np.floor(length / self.model.spacing - 0.5 + 1e-9))

    def flexibility(self, distance: float) -> Array:
        """(w, theta) per force and moment at a station ``distance`` from the mouth, less a constant, Eq. (T10.13)."""
        d, b, c, s = distance, self.bending, self.end_rotation, self.end_deflection
        mixed = 0.5 * b * d**2 + c * d
        return np.array([[b * d**3 / 3 + c * d**2 + s * d, mixed], [mixed, b * d]])

    def stiffness(self, length: float, last: int) -> Array:
        """Elastic stiffness of the free stations 0..last with the mouth ``length`` from the tip, Eq. (T10.14).

        At ``length = (last + 1) * spacing`` it is that of the solid held at all stations inside. Elsewhere the part
        outside rides on the change of the flexibility of the last interval.
        """
        n, H = 2 * (last + 1), self.model.spacing
        K = self.model.stiffness[:n, :n]
        ride = np.zeros((n, 2))
        ride[0::2, 0], ride[1::2, 1] = 1.0, 1.0
        ride[0::2, 1] = H * (last - np.arange(last + 1))
        force = K @ ride
        change = self.flexibility(length - last * H) - self.flexibility(H)
        inner = np.linalg.solve(np.eye(2) + change @ (ride.T @ force), change)
        return K - force @ (0.5 * (inner + inner.T)) @ force.T


def mouth_of(model: StationModel) -> Mouth:
    """Constants of Eq. (T10.13) from the solid held at two neighbouring stations, far from the one that is loaded."""
    H, at = model.spacing, model.stations // 4
    far = min(1 + int(np.ceil(3 * model.section_size / H)), model.stations - at - 2)
    two = slice(2 * at, 2 * at + 2)
    held = [np.linalg.inv(model.stiffness[: 2 * (at + j), : 2 * (at + j)])[two, two] for j in (far, far + 1)]
    change = held[1] - held[0]
    bending = change[1, 1] / H
    mixed = 0.5 * (change[0, 1] + change[1, 0])
    end_rotation = mixed / H - bending * H * (2 * far + 1) / 2
    rest = change[0, 0] / H - bending * H**2 * ((far + 1) ** 3 - far**3) / 3
    end_deflection = rest - end_rotation * H * (2 * far + 1)
    return Mouth(model=model, bending=bending, end_rotation=end_rotation, end_deflection=end_deflection)


_ROOT = np.sqrt(3.0) / 6
_NODES = np.array([0.5 - _ROOT, 0.5 + _ROOT])
_WEIGHTS = np.array([[0.25, 0.25 - _ROOT], [0.25 + _ROOT, 0.25]])
_SQUARED = _WEIGHTS @ _WEIGHTS


def gauss_step(
    mass: Array, stage: Callable[[float], tuple[Array, Array]], t: float, h: float, a: Array, a_dot: Array
) -> tuple[Array, Array]:
    """State a, a_dot (n,) after one step of length `h` from `t` [s], with a constant `mass` (n, n).

    `stage` gives stiffness (n, n) and load (n,) at an instant [s].
    """
    n = len(a)
    big, right = np.empty((2 * n, 2 * n)), np.empty(2 * n)
    for i in range(2):
        K, f = stage(t + _NODES[i] * h)
        rows = slice(i * n, (i + 1) * n)
        for j in range(2):
            big[rows, j * n : (j + 1) * n] = h**2 * _SQUARED[i, j] * K
        big[rows, rows] += mass
        right[rows] = f - K @ (a + _NODES[i] * h * a_dot)
    first, second = np.linalg.solve(big, right).reshape(2, n)
    # Position weights b A = (b_j (1 - c_j)) of the two stages.
    place = 0.5 * (1 - _NODES)
    return a + h * a_dot + h**2 * (place[0] * first + place[1] * second), a_dot + 0.5 * h * (first + second)


@dataclass(frozen=True, kw_only=True)
class HubMotion:
    """State of the hub: `length` outside of it [m], `angle` from the horizontal [rad], rates and accelerations."""

    length: float
    length_rate: float
    length_acceleration: float
    angle: float
    angle_rate: float
    angle_acceleration: float


@dataclass(frozen=True, kw_only=True)
class SlidingBeam:
    """A solid beam in a hub: free stations 0..last in the hub frame, (w, theta) each.

    `hub_radius` [m] from pivot to mouth; `tip_mass` [kg], `tip_inertia` [kg m^2]; `gravity` [m/s^2] along -Y.
    """

    model: StationModel
    hub_radius: float = 0.0
    tip_mass: float = 0.0
    tip_inertia: float = 0.0
    gravity: float = 0.0
    mouth: Mouth = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "mouth", mouth_of(self.model))

    def mass(self, last: int) -> Array:
        """Inertia of solid and tip body (2 last + 2, 2 last + 2), Eq. (T10.15)."""
        n = 2 * (last + 1)
        M = self.model.mass[:n, :n].copy()
        M[0, 0] += self.tip_mass
        M[1, 1] += self.tip_inertia
        return M

    def stiffness(self, motion: HubMotion, last: int) -> Array:
        """Elastic stiffness, that of the axial force, and spin softening, Eqs. (T10.16)-(T10.17)."""
        m, n = self.model, 2 * (last + 1)
        square, reach = motion.angle_rate**2, self.hub_radius + motion.length
        pull = square * reach - motion.length_acceleration - self.gravity * np.sin(motion.angle)
        force = (self.tip_mass * pull, m.mass_per_length * pull, -0.5 * m.mass_per_length * square)
        K = self.mouth.stiffness(motion.length, last) - square * m.mass[:n, :n]
        for share, slope in zip(force, m.slopes, strict=True):
            K += share * slope[:n, :n]
        K[0, 0] -= square * self.tip_mass
        return K

    def load(self, motion: HubMotion, last: int) -> Array:
        """Coriolis, Euler and weight loads across the beam, (2 last + 2,), Eq. (T10.18)."""
        n, reach = 2 * (last + 1), self.hub_radius + motion.length
        across = 2 * motion.angle_rate * motion.length_rate + motion.angle_acceleration * reach
        across += self.gravity * np.cos(motion.angle)
        f = -across * self.model.loads[0, :n] + motion.angle_acceleration * self.model.loads[1, :n]
        f[0] -= across * self.tip_mass
        f[1] -= motion.angle_acceleration * self.tip_inertia
        return f

    def static_shape(self, length: float, displacement: float, last: int) -> Array:
        """Shape under a tip force at a tip displacement [m], (2 last + 2,)."""
        unit = np.zeros(2 * (last + 1))
        unit[0] = 1.0
        shape = np.linalg.solve(self.mouth.stiffness(length, last), unit)
        return displacement * shape / shape[0]

    def frequencies(self, motion: HubMotion, count: int = 3) -> Array:
        """Lowest bending frequencies [Hz] at the length and the rates of the moment, (count,)."""
        from scipy.linalg import eigh

        last = self.mouth.last(motion.length)
        squared = eigh(self.stiffness(motion, last), self.mass(last), eigvals_only=True)[:count]
        return np.asarray(np.sqrt(np.maximum(squared, 0.0)) / (2 * np.pi), dtype=float)

    def static_deflection(self, motion: HubMotion) -> float:
        """Deflection of the tip [m] at rest in the hub under the loads (T10.18) of the moment: the Coriolis sag."""
        last = self.mouth.last(motion.length)
        return float(np.linalg.solve(self.stiffness(motion, last), self.load(motion, last))[0])

    def next_station(self, length: float, last: int) -> Array:
        """(w, theta) of the station after ``last`` at rest between that one and the mouth, (2, 2 last + 2)."""
        n = 2 * (last + 1)
        K = self.mouth.stiffness(length, last + 1)
        return np.asarray(np.linalg.solve(K[n:, n:], -K[n:, :n]), dtype=float)


def march_solid_beam(
    beam: SlidingBeam,
    motion: Callable[[float], HubMotion],
    displacement: float,
    output: Array,
    step: float,
    progress: Callable[[float, float], None] | None = None,
) -> Array:
    """Tip deflection [m] at the instants ``output`` [s] of a beam released from its static shape under a tip force.

    Fewer values where the user interrupts it. Released with zero rates of the shape at fixed x / L(t): the stations
    start with what the change of the static shape with the length gives them, Eq. (T10.20).

    `motion` of hub and feed at an instant; `displacement` of the tip at the start [m]; `output` (T,) ascending, the
    start first; `step`: largest time step [s]; `progress` is called with simulated and whole time [s].
    ComputationError: less than two stations outside the hub, or the beam leaves the hub.
    """
    state = _released(beam, motion(float(output[0])), displacement, float(output[0]))
    tip = [state.a[0]]
    try:
        for begin, end in pairwise(output.tolist()):
            count = max(1, int(np.ceil((end - begin) / step - 1e-9)))
            h = (end - begin) / count
            for i in range(count):
                state = _stepped(beam, motion, state, begin + i * h, h)
            tip.append(_bounded(float(state.a[0]), motion(end).length, end))
            if progress is not None:
                progress(end, float(output[-1]))
    except KeyboardInterrupt:
        if len(tip) < 2:
            raise
    return np.array(tip)


def _bounded(tip: float, length: float, t: float) -> float:
    """Deflection of the tip, if a beam of that length can have it."""
    if not abs(tip) <= length:
        raise ComputationError(
            f"the tip is deflected by more than the free length at t = {t:.6g} s: an unstable beam, or too long a step",
            next_step="Halve the step; check the motion and the axial load with `flexapod check`.",
        )
    return tip


@dataclass(frozen=True, kw_only=True)
class _State:
    """Free stations 0..last with their (w, theta) and rates, and the inertia that belongs to them."""

    last: int
    a: Array
    a_dot: Array
    mass: Array


def _released(beam: SlidingBeam, now: HubMotion, displacement: float, t: float) -> _State:
    """Static shape at rest in x / L(t), Eq. (T10.20)."""
    last, d = _inside(beam, now.length, t), 1e-3 * beam.model.spacing
    behind, a, ahead = (beam.static_shape(now.length + e, displacement, last) for e in (-d, 0.0, d))
    return _State(last=last, a=a, a_dot=now.length_rate * (ahead - behind) / (2 * d), mass=beam.mass(last))


def _stepped(beam: SlidingBeam, motion: Callable[[float], HubMotion], state: _State, t: float, h: float) -> _State:
    def stage(time: float) -> tuple[Array, Array]:
        now = motion(time)
        return beam.stiffness(now, state.last), beam.load(now, state.last)

    a, a_dot = gauss_step(state.mass, stage, t, h, state.a, state.a_dot)
    now = motion(t + h)
    last = _inside(beam, now.length, t + h)
    if last == state.last:
        return replace(state, a=a, a_dot=a_dot)
    a, a_dot = _changed(beam, now, a, a_dot, state.last, last)
    return _State(last=last, a=a, a_dot=a_dot, mass=beam.mass(last))


def _inside(beam: SlidingBeam, length: float, t: float) -> int:
    last = beam.mouth.last(length)
    if not 1 <= last <= beam.model.stations - 3:
        words = "has slid wholly into the hub" if last < 1 else "is about to leave the hub"
        raise ComputationError(
            f"the beam {words} at t = {t:.6g} s", next_step="Shorten the motion or the distance of the stations"
        )
    return last


def _changed(beam: SlidingBeam, now: HubMotion, a: Array, a_dot: Array, last: int, wanted: int) -> tuple[Array, Array]:
    """State after stations have come out of the hub, or gone into it."""
    if wanted < last:
        n = 2 * (wanted + 1)
        return a[:n], a_dot[:n]
    d = 1e-3 * beam.model.spacing
    for station in range(last, wanted):  # at rest between its neighbours, Eq. (T10.21)
        rest = beam.next_station(now.length, station)
        ahead, behind = (beam.next_station(now.length + e, station) for e in (d, -d))
        moved = now.length_rate * (ahead - behind) / (2 * d)
        a, a_dot = np.concatenate([a, rest @ a]), np.concatenate([a_dot, rest @ a_dot + moved @ a])
    return a, a_dot
