"""The linear model of a single actuator, at rest or while its hub turns steadily, Eq. (T20.25)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError, names_of, suggest_word
from flexapod.mechanics.leg.layout import Shapes
from flexapod.model import Actuator, Simulation
from flexapod.solve.kernel import Function
from flexapod.solve.linear.first_order import FirstOrder, first_order, with_mass
from flexapod.solve.linear.states import States
from flexapod.solve.modal.actuator_modes import interpreted_functions, straight_state
from flexapod.solve.shapes import actuator_shapes, places

ITERATIONS = 20  # of Newton to the equilibrium of the beam
SETTLED = 1e-12  # step of an amplitude over the beam's length
PLANAR, SPACE = ("along", "rotation"), ("along", "rotation", "elevation")


class ActuatorPlant:
    """A single actuator about its equilibrium, or in steady rotation.

    Parameters
    ----------
    actuator : Actuator
    simulation : Simulation
    rate : float
        Of the hub [rad/s]; then without gravity, as in modes.
    """

    def __init__(self, actuator: Actuator, simulation: Simulation, rate: float) -> None:
        self.actuator: Actuator = actuator.replace(gravity=0.0) if rate else actuator
        self.shapes: Shapes = actuator_shapes(self.actuator, simulation, rate)
        self.rate: float = rate

    @cached_property
    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """M, D, K of all coordinates about the equilibrium, and the tip's motion by them in the hub's axes (3, n).

        Raises
        ------
        ComputationError
            The beam has no equilibrium, or has buckled.
        """
        return _matrices(self.actuator, self.shapes, self.rate)


def actuator_states(
    plant: ActuatorPlant, inputs: Sequence[str], outputs: Sequence[str], *, free: Sequence[str]
) -> States:
    """States of hub and beam about their equilibrium, or their steady rotation.

    Parameters
    ----------
    plant : ActuatorPlant
    inputs, outputs : sequences of str
        Of `channels`.
    free : sequence of str
        Of rotation, extension and elevation those that a force drives; the others are held.

    Raises
    ------
    InputError
        Unknown channels.
    ComputationError
        The beam has no equilibrium, or has buckled.
    """
    (M, D, K, tip), at = plant.matrices, places(plant.shapes)
    known = _known(tuple(at), free, SPACE if plant.actuator.space else PLANAR)
    into, out = (_chosen(names, known[key], key) for key, names in (("inputs", inputs), ("outputs", outputs)))
    told = [x.partition(":")[2] for x in into if x.startswith("command:")]
    F = np.zeros((len(M), len(into)))
    for k, (group, _, which) in enumerate(x.partition(":") for x in into):
        if group == "drive":
            F[at[which], k] = 1.0
        elif group == "force":
            F[:, k] = tip[SPACE.index(which.rpartition(":")[2])]
    moving = [k for k in range(len(M)) if k not in [at[name] for name in at if name not in free]]
    z = [*moving, *(at[name] for name in told)]
    first = _first_order(M, D, K, F, moving, z, [into.index(f"command:{name}") for name in told])
    rows = _rows(first, (M, D, K, F, tip), z, (into, out), at, free)
    named = _names(plant.shapes, at)
    named = [named[k] if i < len(moving) else f"command:{named[k]}" for i, k in enumerate(z)]
    order, n = [named[k] for k in first.second], first.A.shape[0]
    return States(
        A=first.A, B=first.B, C=rows[:, :n], D=rows[:, n:], inputs=tuple(into), outputs=tuple(out),
        states=(*order, *(named[k] for k in first.first), *(f"{name} rate" for name in order)),
        units={name: _unit(name) for name in [*into, *out]},
    )  # fmt: skip


def _first_order(
    M: Array, D: Array, K: Array, F: Array, moving: list[int], z: list[int], told: Sequence[int]
) -> FirstOrder:
    """States of coordinates z, those that are ``moving`` first; the others follow inputs ``told``, Eq. (T20.6)."""
    d, count = len(moving), len(z)
    m, c, k = np.zeros((3, count, count))
    for of, whole in ((m, M), (c, D), (k, K)):
        of[:d] = whole[np.ix_(moving, z)]
    f = np.zeros((count, F.shape[1]))
    f[:d] = F[moving]
    for i, column in enumerate(told, start=d):
        f[:d, column] -= m[:d, i]
        m[:d, i], m[i, i], f[i, column] = 0.0, 1.0, 1.0
    own, rest, T = with_mass(np.asarray(np.linalg.cholesky(M[np.ix_(moving, moving)]).T, dtype=np.float64))
    own = np.concatenate([own, np.arange(d, count)]).astype(np.intp)
    T = np.concatenate([T, np.zeros((count - d, rest.size))])
    return first_order(m, c, k, f, mass=(own, rest, T), loops=np.zeros(0, dtype=np.intp))


def _rows(
    first: FirstOrder,
    matrices: tuple[Array, Array, Array, Array, Array],
    z: list[int],
    channels: tuple[list[str], list[str]],
    at: dict[str, int],
    free: Sequence[str],
) -> Array:
    """Rows of the outputs by states and inputs."""
    M, D, K, F, tip = matrices
    into, out = channels
    flat, n = np.zeros((len(M), len(z))), first.A.shape[0]
    flat[z, np.arange(len(z))] = 1.0
    place, rows = flat @ first.place, np.zeros((len(out), n + len(into)))
    balance = M @ flat @ first.acceleration + D @ flat @ first.rate + K @ place
    balance[:, n:] -= F
    for k, (group, _, which) in enumerate(x.partition(":") for x in out):
        if group == "tip":
            rows[k] = tip[SPACE.index(which)] @ place
        elif group == "stroke":
            rows[k] = place[at[which]]
        elif which in free:
            rows[k, n:] = [x == f"drive:{which}" for x in into]
        else:
            rows[k] = balance[at[which]]
    return rows


def _matrices(actuator: Actuator, shapes: Shapes, rate: float) -> tuple[Array, Array, Array, Array]:
    """Compute mass, damping and stiffness for `ActuatorPlant.matrices`."""
    (residual, matrices, tangents), at = interpreted_functions(shapes), places(shapes)
    q, arguments, at_rest = straight_state(actuator, shapes, rate)
    beam = [k for k in range(shapes.size) if k not in at.values()]
    for _ in range(ITERATIONS if beam else 0):
        step = np.linalg.solve(tangents(q, *arguments)[0][np.ix_(beam, beam)], residual(q, *arguments)[0][beam])
        q[beam] -= step
        if np.abs(step).max() <= SETTLED * actuator.length:
            break
    K, D = tangents(q, *arguments)
    M = matrices(q, *at_rest)[0]
    if beam and (np.abs(q[beam]).max() > actuator.length or np.linalg.eigvals(K[np.ix_(beam, beam)]).real.min() <= 0):
        raise ComputationError(
            f"a beam of {actuator.free_length:g} m has no stable equilibrium: its own load buckles it",
            next_step="Shorten actuator.free_length, or reduce gravity or tip_mass.",
        )
    J = np.asarray(_tip(shapes)(q, at_rest[1])[0])
    turn, lift = (q[at[name]] if name in at else 0.0 for name in ("rotation", "elevation"))
    if actuator.space:
        along = np.array([np.cos(lift) * np.cos(turn), np.cos(lift) * np.sin(turn), np.sin(lift)])
        ahead = np.array([-np.sin(turn), np.cos(turn), 0.0])
    else:
        along, ahead = np.array([np.cos(turn), np.sin(turn), 0.0]), np.array([-np.sin(turn), np.cos(turn), 0.0])
    return M, D, K, np.stack([along, ahead, np.cross(along, ahead)]) @ J


@lru_cache(maxsize=16)
def _tip(shapes: Shapes) -> Function:
    from flexapod.mechanics.leg.kernel_functions import leg_tip
    from flexapod.mechanics.symbolic.functions import Interpreted

    return Interpreted(leg_tip(shapes))


def _known(driven: Sequence[str], free: Sequence[str], axes: Sequence[str]) -> dict[str, list[str]]:
    """Names of the channels there are."""
    tip = [f"force:tip:{axis}" for axis in axes]
    inputs = [f"drive:{x}" for x in driven if x in free] + [f"command:{x}" for x in driven if x not in free] + tip
    seen = [f"tip:{axis}" for axis in axes]
    return {"inputs": inputs, "outputs": [*seen, *(f"{x}:{y}" for x in ("stroke", "drive-force") for y in driven)]}


def _chosen(names: Sequence[str], known: list[str], key: str) -> list[str]:
    found: dict[str, None] = {}
    for name in names_of(names, key):
        some = [x for x in known if x == name or x.startswith(f"{name}:")]
        if not some:
            raise InputError(
                "is not a channel of a single actuator", key=key, value=name, allowed=", ".join(known),
                next_step=suggest_word(name, [*known, *{x.partition(":")[0] for x in known}]),
            )  # fmt: skip
        found |= dict.fromkeys(some)
    if not found:
        raise InputError("are none", key=key, allowed=", ".join(known))
    return list(found)


def _names(shapes: Shapes, at: dict[str, int]) -> list[str]:
    names = [name if size == 1 else f"{name}{k + 1}" for name, size in shapes.layout for k in range(size)]
    for name, k in at.items():
        names[k] = name
    return names


def _unit(name: str) -> str:
    group, _, which = name.partition(":")
    turns = which in ("rotation", "elevation")
    if group in ("drive", "drive-force"):
        return "N m" if turns else "N"
    if group == "command":
        return "rad/s^2" if turns else "m/s^2"
    return {"stroke": "rad" if turns else "m", "tip": "m"}.get(group, "N")
