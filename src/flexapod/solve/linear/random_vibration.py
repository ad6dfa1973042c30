"""Random vibration of a robot about its static equilibrium, by its linear model, Eqs. (T18.1)-(T18.11).

Spectra are integrated over frequency, (T18.6)-(T18.11). The model states what moves the tool, and how much,
(T18.1)-(T18.5).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Complex
from flexapod.common.errors import InputError
from flexapod.common.piecewise_chebyshev import Pieces
from flexapod.common.quantities import fill_template
from flexapod.model import Disturbance, Floor, Spectrum
from flexapod.solve.linear.channels import plant_channels
from flexapod.solve.linear.plant import plant_at_rest
from flexapod.solve.linear.second_order import input_forces
from flexapod.solve.modal.eigenproblem import poles
from flexapod.solve.modal.modal_loops import UNSTABLE, ModalLoops, growth_rate
from flexapod.solve.modal.modes import loops_of, modal_damping, no_mass, unit_modes
from flexapod.solve.statics.locked_robot import LockedPoses, single_equilibrium

NODES, WEIGHTS = (0.5 * x for x in np.polynomial.legendre.leggauss(4))
PER_DECADE = 12  # panels where nothing resonates
ELLIPSE = 3 + np.sqrt(8)  # half axes of an ellipse without a pole, added, over half a panel
SHARES = 2.0 ** -np.arange(0.0, 32.0, 0.5)  # of the widest panel
BLOCK = 256  # frequencies side by side
POINTS = 8  # of a polynomial through a response, on a panel whose ellipse holds no pole; error below 5.8**-16
ROUNDING = 1e-9  # of the largest rms: what is less is zero
UNDAMPED = 1e-9  # damping ratio below which nothing limits a resonance
FLOOR_RATES = {"acceleration": 0, "velocity": 1, "displacement": 2}


@dataclass(frozen=True, kw_only=True)
class VibrationModel:
    """Any linear system as the integral needs it, as a `LinearRobot` is by itself.

    ``tool`` (p, r): outputs by modes; ``poles`` [1/s] up to a rate [rad/s]; ``amplitudes``: modes (f, r, k) at
    frequencies [Hz] under unit inputs, columns of (any, k).
    """

    tool: Array
    poles: Callable[[float], Complex]
    amplitudes: Callable[[Array, Array], Complex]


@dataclass(frozen=True, kw_only=True)
class Source:
    """One disturbance: ``name``, its inputs (r, k) as modal ``forces`` that are independent of each other.

    ``frequency`` (m,) [Hz] and ``density`` (m, k) of its table, to be multiplied by (2 pi f)^(2 ``rates``).
    """

    name: str
    forces: Array
    frequency: Array
    density: Array
    rates: int = 0

    def at(self, f: Array) -> Array:
        """Density (f, k) of the inputs."""
        return density_at(self.frequency, self.density, f) * (2 * np.pi * f[:, None]) ** (2 * self.rates)


@dataclass(frozen=True, kw_only=True)
class RandomVibration:
    """Vibration of the tool: displacement [m] along and rotation [rad] about world axes relative to the base.

    ``frequency`` (f,) [Hz] with ``weight`` (f,) of the integral; one-sided ``psd`` (f, 6); ``by_input``: rms by each
    input of each source, (k, 6); ``by_mode`` (r, 6): shares that add up to the rms; ``covariance`` (6, 6).
    """

    sources: tuple[str, ...]
    frequency: Array
    weight: Array
    psd: Array
    by_input: tuple[Array, ...]
    by_mode: Array
    covariance: Array

    @property
    def rms(self) -> Array:
        """Standard deviations, (6,), Eq. (T18.7)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def by_source(self) -> Array:
        """Standard deviations by source, whose squares add up, (sources, 6), Eq. (T18.8)."""
        return np.sqrt([(one**2).sum(axis=0) for one in self.by_input])

    @property
    def cumulative(self) -> Array:
        """Rms of what is at each frequency and above, (f, 6), Eq. (T18.10)."""
        power = self.weight[:, None] * self.psd
        return np.sqrt(np.cumsum(power[::-1], axis=0)[::-1])


#: What shakes a robot by the field of its disturbance.
SOURCES = {"floor": "floor vibration", "wrench": "wrench noise", "force_noise": "force noise"}
#: Groups of inputs likewise.
GROUPS = {"floor": "floor", "wrench": "wrench", "force_noise": "drive"}


def sources_of(given: Disturbance, model: LinearRobot) -> list[Source]:
    """The disturbances of a study at its linear model.

    Raises
    ------
    InputError
        A noise of drives that hold their positions whatever pushes them.
    """
    tables = {field: getattr(given, field) for field in GROUPS}
    if tables["force_noise"] is not None and not model.inputs["drive"].any():
        raise InputError(
            "moves nothing: the drives hold their positions, whatever pushes them",
            key="disturbance.force_noise",
            allowed='drives that give way: "servo", or "screw" commanded by "servo" or "torque"',
            next_step="Leave force_noise out, or choose another leg.drive",
        )
    return [_source(SOURCES[f], model.inputs[GROUPS[f]], table) for f, table in tables.items() if table is not None]


def _source(name: str, forces: Array, table: Floor | Spectrum) -> Source:
    rates = FLOOR_RATES[table.of] if isinstance(table, Floor) else 0
    density = np.broadcast_to(table.density, (len(table.frequency), forces.shape[1]))
    return Source(name=name, forces=forces, frequency=table.frequency, density=density, rates=rates)


def density_at(frequency: Array, density: Array, f: Array) -> Array:
    """A table's density (f, k) at frequencies, Eq. (T18.6): straight in logarithms, or in numbers beside a 0."""
    k = np.clip(np.searchsorted(frequency, f, side="right") - 1, 0, len(frequency) - 2)
    low, high, left, right = frequency[k, None], frequency[k + 1, None], density[k], density[k + 1]
    straight = left + (right - left) * (f[:, None] - low) / (high - low)
    power = (left > 0) & (right > 0)
    ratio = np.divide(right, left, out=np.ones_like(left), where=power)
    curved = left * ratio ** (np.log(f[:, None] / low) / np.log(high / low))
    inside = (f >= frequency[0]) & (f <= frequency[-1])
    return np.where(power, curved, straight) * inside[:, None]


def random_vibration(model: LinearRobot | VibrationModel, sources: list[Source], *, refine: int = 1) -> RandomVibration:
    """Response of p outputs (the tool) to independent sources; ``refine``: into how many each panel is cut further.

    Raises
    ------
    InputError
        Something without damping vibrates within the spectra.
    """
    edges = panels(model, sources, refine)
    half = np.diff(edges)
    f = (0.5 * (edges[1:] + edges[:-1])[:, None] + half[:, None] * NODES).ravel()
    weight = (half[:, None] * WEIGHTS).ravel()
    forces = np.concatenate([source.forces for source in sources], axis=1)
    response = _response(model, forces, f, refine)
    p = len(model.tool)
    psd, covariance = np.zeros((len(f), p)), np.zeros((p, p))
    by_mode, by_input = np.zeros((model.tool.shape[1], p)), np.zeros((forces.shape[1], p))
    for start in range(0, len(f), BLOCK):
        some = slice(start, start + BLOCK)
        S = np.concatenate([source.at(f[some]) for source in sources], axis=1)
        eta = response(f[some])
        H = model.tool @ eta
        power = np.abs(H) ** 2 * S[:, None]  # (T18.7)
        psd[some] = power.sum(axis=2)
        by_input += np.einsum("f,fck->kc", weight[some], power)
        weighted = np.conj(H) * (weight[some, None] * S)[:, None]
        covariance += np.tensordot(H, weighted, axes=((0, 2), (0, 2))).real
        by_mode += np.tensordot(eta, weighted, axes=((0, 2), (0, 2))).real * model.tool.T  # (T18.9)
    rms = np.sqrt(np.diag(covariance))
    widths = np.cumsum([source.forces.shape[1] for source in sources])[:-1]
    return RandomVibration(
        sources=tuple(source.name for source in sources),
        frequency=f,
        weight=weight,
        psd=psd,
        by_input=tuple(np.sqrt(one) for one in np.split(by_input, widths)),
        by_mode=np.divide(by_mode, rms, out=np.zeros_like(by_mode), where=rms > 0),
        covariance=0.5 * (covariance + covariance.T),
    )


def vibration_with_error(model: LinearRobot | VibrationModel, sources: list[Source]) -> tuple[RandomVibration, float]:
    """Response on panels cut in two, and the largest relative difference of its rms from that on whole ones."""
    found, coarse = random_vibration(model, sources, refine=2), random_vibration(model, sources)
    moves = found.rms > ROUNDING * found.rms.max(initial=0.0)
    error = np.divide(coarse.rms, found.rms, out=np.ones_like(found.rms), where=moves) - 1.0
    return found, float(np.abs(error).max(initial=0.0))


def _response(model: LinearRobot | VibrationModel, forces: Array, f: Array, refine: int) -> Callable[[Array], Complex]:
    """Amplitudes (f, r, k) at frequencies: solved for, or where tables have many rows polynomials on wider panels."""
    span = Source(name="", forces=forces, frequency=f[[0, -1]], density=np.zeros((2, 1)))
    edges = panels(model, [span], 2 * refine)
    if len(f) <= 4 * POINTS * (len(edges) - 1):
        return lambda some: model.amplitudes(some, forces)

    def responses(at: Array) -> list[Array]:
        parts = [model.amplitudes(at[i : i + BLOCK], forces) for i in range(0, len(at), BLOCK)]
        return [np.concatenate(parts).view(float)]

    pieces = Pieces(responses, edges, -np.cos(np.pi * (np.arange(POINTS) + 0.5) / POINTS), shortest=np.inf)
    pieces.make_all()
    return lambda some: pieces(some)[0].view(complex)


def panels(model: LinearRobot | VibrationModel, sources: list[Source], refine: int) -> Array:
    """Edges [Hz] of panels each as long as rows of the tables and poles let it be, Eq. (T18.11)."""
    breaks = np.unique(np.concatenate([source.frequency for source in sources]))
    z = _poles(model, breaks[0], breaks[-1])
    edges = [breaks[0]]
    for end in breaks[1:]:
        while (left := end - edges[-1]) > 0:
            widest = min(left, edges[-1] * (10 ** (1 / PER_DECADE) - 1))
            share = 1.0 if _free(z, edges[-1], widest, SHARES[:1])[0] else None
            if share is None:
                found = _free(z, edges[-1], widest, SHARES)
                share = SHARES[found.argmax() if found.any() else -1]
            reached = edges[-1] + widest * share
            edges.append(reached if end - reached > 1e-9 * end else end)
    cuts = np.array(edges[:-1])[:, None] + np.diff(edges)[:, None] * np.arange(refine) / refine
    return np.append(cuts.ravel(), edges[-1])


def _free(z: Complex, start: float, widest: float, shares: Array) -> NDArray[np.bool_]:
    """Test whether an ellipse about a panel holds none of the poles, for panels of shares of the widest."""
    half = 0.5 * widest * shares[:, None]
    x = (z - start - half) / half
    root = np.sqrt(x**2 - 1)
    return (np.maximum(np.abs(x + root), np.abs(x - root)) >= ELLIPSE).all(axis=1)


def _poles(model: LinearRobot | VibrationModel, low: float, high: float) -> Complex:
    """Frequencies [Hz] at which responses are infinite, above the real axis.

    Raises
    ------
    InputError
        One of them is real.
    """
    z = model.poles(2 * np.pi * high) / (2j * np.pi)
    z = z[z.real > 0]
    lasting = z.imag <= UNDAMPED * z.real
    if (within := z.real[lasting & (z.real >= low) & (z.real <= high)]).size:
        raise InputError(
            f"leaves the vibration at {within[0]:.4g} Hz without damping: it would grow without end",
            key="leg.damping",
            allowed="damping of whatever gives way: legs, joints, springs, drives",
            next_step="For example: damping = 0.005 in [leg]",
        )
    return z[~lasting]


FAR = 5.0


@dataclass(frozen=True, kw_only=True)
class LinearRobot:
    """A robot in r undamped modes of unit stiffness, Eq. (T18.1); what inputs push is that of the state space.

    Spectra are shared out among modes, and their integral takes up to seven times as long by a state space.

    ``omega`` (r,) [rad/s], inf of what has no mass; ``damping`` (r, r) [s]; ``tool`` (6, r): displacement and rotation
    of the tool, world axes; ``inputs``: modal forces (r, any) of unit inputs by name: ``floor`` [per m/s^2], ``wrench``
    and ``drive`` [per N, N m]; ``loops``: those that are not symmetric.
    """

    omega: Array
    damping: Array
    tool: Array
    inputs: Mapping[str, Array]
    loops: ModalLoops | None = None

    def poles(self, rate: float) -> Complex:
        """Eigenvalues [1/s] up to a `rate` [rad/s], near enough to find where responses change, see (T18.11).

        What is `FAR` times as fast and damped little below the rate gives way as at rest: the others' damping to it
        moves a pole by less than its distance from the imaginary axis over `FAR`.
        """
        if self.loops is not None:
            return self.loops.eigenpairs(self.omega, self.damping)[0]
        near = (self.omega <= FAR * rate) | (np.diag(self.damping) * rate >= 1.0 / FAR)
        if not near.any():
            return np.zeros(0, dtype=complex)
        return poles(self.omega[near], self.damping[np.ix_(near, near)])

    def amplitudes(self, frequency: Array, forces: Array) -> Complex:
        """Modes (f, r, any) at frequencies (f,) [Hz] under modal forces (r, any), Eq. (T18.2)."""
        s = 2j * np.pi * frequency[:, None]
        dynamic = s[..., None] * self.damping
        each = np.arange(self.omega.size)
        dynamic[:, each, each] += 1.0 + (s / self.omega) ** 2
        if self.loops is not None:
            dynamic = dynamic + self.loops.dynamic(s[:, 0])
        given = np.broadcast_to(forces.astype(complex), (len(s), *forces.shape))
        return np.asarray(np.linalg.solve(dynamic, given), dtype=np.complex128)


def linear_robot(locked: LockedPoses) -> LinearRobot:
    """The linear model at a single pose.

    Raises
    ------
    InputError
        Nothing can move, or loops are unstable.
    ComputationError
        No equilibrium at this pose, or masses that no body can have.
    """
    at, found = single_equilibrium(locked), unit_modes(locked, shapes=True)
    if not found.positive[0]:
        raise no_mass(locked.system, at.state.q)
    damping, loops = modal_damping(locked, found.flat)[0], [*loops_of(locked), None]
    inputs = _inputs(locked, found.flat[0])
    model = LinearRobot(omega=found.omega[0], damping=damping, tool=inputs["wrench"].T, inputs=inputs, loops=loops[0])
    if model.loops is not None and (rate := growth_rate(model.poles(np.inf))):
        words = fill_template(UNSTABLE, where="", time=1 / rate)
        raise InputError(words, key="leg.drive.loop", allowed="loops whose deviations decay")
    return model


def _inputs(locked: LockedPoses, flat: Array) -> dict[str, Array]:
    """Modal forces of unit inputs of shapes (N, r): accelerations of the floor, wrench, forces of all drives."""
    plant, robot = plant_at_rest(locked), locked.robot
    groups = {name: plant_channels(name, robot, "inputs") for name in ("floor", "wrench", "drive")}
    groups["floor"] = groups["floor"][:3]
    every = [channel for group in groups.values() for channel in group]
    forces = flat.T @ input_forces(plant, every, np.zeros(3))[0]
    parts = np.split(forces, np.cumsum([len(group) for group in groups.values()])[:-1], axis=1)
    found = dict(zip(groups, parts, strict=True))
    drive = np.zeros((len(forces), robot.count))  # of passive legs zero
    drive[:, [channel.leg for channel in groups["drive"]]] = found["drive"]
    return found | {"drive": drive}
