"""Names, shapes and results of modes at one pose, and local fits of a vibration whose frequency drifts.

Names follow from energies. Frequency, envelope and sag of a vibration are fitted in windows that move along it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.elongations import axis_deflections
from flexapod.analysis.results.lazy_arrays import LazyArrays
from flexapod.analysis.results.legs import base_points, bending_basis, lateral_amplitudes
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.ranking import EQUALS, is_largest
from flexapod.kinematics.rotations import matrix, quaternion
from flexapod.mechanics.leg.layout import Shapes, columns, leg_parameters
from flexapod.solve.modal.modes import RobotModes
from flexapod.solve.sections import leg_values

MOSTLY = 0.5  # share of an energy from which a part names the mode


def mode_kinds(found: RobotModes) -> list[str]:
    """``payload``, ``base``, ``leg n bending``, ``legs bending``, ``leg n axial``, ``legs axial`` ... for each mode.

    The kinetic energy says whether payload, base plate or legs; that of the legs, which leg, if one has more than all
    others and more than the payload; the strain energy of its coordinates, how: bending, axial, twisting (of the leg
    about its axis), carriage (on the spring of its drive), turning (on springs of joints).

    Parameters
    ----------
    found : RobotModes
    """
    return _mode_names(found)[0]


def _mode_names(found: RobotModes) -> tuple[list[str], Array, Array]:
    """Names of the modes, and the shares of the payload (m,) and of the legs (m, legs) in their kinetic energy."""
    system, n = found.system, found.system.n
    M, K, legs = found.m.M[0], found.m.K[0], found.shapes[:, :-6].reshape(len(found.shapes), -1, n)
    own = [k for k in range(n) if k not in system.plate]  # the plate below the payload counts with it
    plate = _base_plate(found, legs)
    kinetic = _forms(legs, M, own) - plate[:, None] / legs.shape[1]
    payload = 1.0 - plate - kinetic.sum(axis=1)
    energies = {name: _forms(legs, K, chosen).sum(axis=1) for name, chosen in _groups(system.kernel.shapes).items()}
    names = np.where(plate > MOSTLY, "base", _kinds(kinetic, energies, payload))
    return names.tolist(), payload, kinetic


def _base_plate(found: RobotModes, legs: Array) -> Array:
    """Kinetic energy of the base plate in each mode, (m,), of those with unit mass twice that."""
    shapes, p = found.system.kernel.shapes, found.system.leg_p
    if not shapes.has("f"):
        return np.zeros(len(legs))
    layout, first = leg_parameters(shapes), shapes.index("f")
    mass, inertia = (p[:, columns(layout, f"base_plate_{name}")].sum(axis=0) for name in ("mass", "inertia"))
    moved = legs[:, 0, first : first + 6]
    return mass[0] * (moved[:, :3] ** 2).sum(axis=1) + _form(moved[:, 3:], inertia.reshape(3, 3))


def _groups(shapes: Shapes) -> dict[str, list[int]]:
    """Coordinates of a leg by what their strain energy is called."""
    names = {
        "bending": ("a", "b", "ga", "gb", "ha", "hb", "ka", "kb"),
        "axial": ("l", "c"),
        "twisting": ("spin", "t"),
        "carriage": ("chi",),
        "turning": ("alpha", "beta", "gamma1", "gamma2", "gamma3"),
    }
    sizes = dict(shapes.layout)
    found = {
        kind: [shapes.index(name) + k for name in group if name in sizes for k in range(sizes[name])]
        for kind, group in names.items()
    }
    if not shapes.has("gamma1"):
        del found["turning"]  # no springs
    return {kind: chosen for kind, chosen in found.items() if chosen}


def _form(vectors: Array, matrix: Array) -> Array:
    return np.einsum("mi,ij,mj->m", vectors, matrix, vectors)


def _forms(legs: Array, matrices: Array, chosen: list[int]) -> Array:
    """Quadratic forms of each leg (m, legs) in some of its coordinates, of vectors (m, legs, n)."""
    part, between = legs[..., chosen], matrices[:, chosen][..., chosen]
    return np.einsum(_FORM, part, between, part, optimize=_order(part.shape, between.shape))


_FORM = "mli,lij,mlj->ml"


@lru_cache(maxsize=64)
def _order(part: tuple[int, ...], between: tuple[int, ...]) -> list[object]:
    """Order in which factors of such shapes are multiplied."""
    some = np.zeros(part)
    return np.einsum_path(_FORM, some, np.zeros(between), some, optimize=True)[0]


def _kinds(kinetic: Array, energies: dict[str, Array], payload: Array) -> Array:
    """Names (m,) from kinetic energies (m, legs), strain energies (m,) by name, and the payload's share (m,)."""
    whole = kinetic.sum(axis=1)  # of a mass-normalised mode: 1 with the payload's
    first = is_largest(kinetic, axis=1, same=EQUALS).argmax(axis=1)
    largest = np.take_along_axis(kinetic, first[:, None], axis=1)[:, 0]
    which = np.where(largest > np.maximum(MOSTLY * whole, payload), [f"leg {k + 1}" for k in first], "legs")
    how = np.array([*energies])[is_largest(np.stack([*energies.values()]), axis=0, same=EQUALS).argmax(axis=0)]
    names = np.char.add(np.char.add(which, " "), how)
    return np.where(np.isnan(whole), "", np.where(whole < MOSTLY, "payload", names))


STATIONS = np.linspace(0.0, 1.0, 41)


def mode_values(robot: model.Robot, found: RobotModes, path: kinematics.Poses) -> LazyArrays:
    """Variables of `flexapod.modes` at one pose, by name; ``path`` is the rigid pose."""
    at, com = found.equilibrium.state.pose, robot.com
    R = matrix(at[3:])
    platform = np.concatenate([found.shapes[:, -6:-3], found.shapes[:, -3:] @ R.T], axis=1)
    kind, of_payload, of_legs = _mode_names(found)
    return LazyArrays(
        {
            "frequency": found.frequency,
            "damping_ratio": lambda: found.damping_ratio,
            "kind": np.array(kind),
            "payload_share": of_payload,
            "leg_share": of_legs,
            "platform_shape": platform,
            "leg_shape": lambda: _leg_shapes(robot, found),
            "leg_stretch": lambda: _stretch(robot, found, platform),
            "platform_position": at[:3] - R @ com,
            "platform_quaternion": quaternion(R),
            "com_sag": at[:3] - path.point(com)[0][0],
        }
    )


def _leg_shapes(robot: model.Robot, found: RobotModes) -> Array:
    """Lateral displacement of every leg off the line of its joints, (m, legs, 2, stations) [m]."""
    shapes, count = found.system.kernel.shapes, len(robot.legs)
    basis = bending_basis(shapes)
    q = found.shapes[:, :-6].reshape(len(found.shapes), count, found.system.n)
    legs = lateral_amplitudes(shapes, q)
    line = axis_deflections(robot, found.system, q, found.equilibrium.state.q[:, shapes.l_index], STATIONS)
    result = line - line[..., -1:] * STATIONS
    for i, leg in enumerate(robot.legs):
        length = found.equilibrium.state.q[i, shapes.l_index]
        zeta = np.clip((STATIONS * length - leg.cylinder.mouth) / (length - leg.cylinder.mouth), 0.0, 1.0)
        values = leg_values(leg, basis, np.array([length - leg.cylinder.mouth]), zeta)[..., 0]
        result[:, i] += (legs[:, i, :, None] @ (values - np.outer(basis.tip, STATIONS)))[..., 0, :]
    return result


def _stretch(robot: model.Robot, found: RobotModes, platform: Array) -> Array:
    """Change of joint-to-joint lengths in each mode, (m, legs) [m]: rows of the Jacobian at the CoM, Eq. (T2.21)."""
    state, system, legs = found.equilibrium.state, found.system, kinematics.rigid_limbs(robot)
    at = state.pose
    if not legs.carriage:
        joints = robot.platform_joints - robot.com
        return (
            _of_frames(robot, found)
            + platform @ kinematics.length_jacobian(legs.base, joints, at[:3], matrix(at[3:]), np.zeros(3)).T
        )
    chi = system.kernel.shapes.index("chi")
    by_leg = found.shapes[:, :-6].reshape(len(found.shapes), system.legs, system.n)[..., chi]
    feet = base_points(legs, state.q[:, chi])
    arms = (robot.platform_joints - robot.com) @ matrix(at[3:]).T
    axes = at[:3] + arms - feet
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    tips = platform[:, None, :3] + np.cross(platform[:, None, 3:], arms)
    moved = by_leg[..., None] * _ways(legs, feet)
    return ((tips - moved) * axes).sum(axis=-1)


def _of_frames(robot: model.Robot, found: RobotModes) -> Array:
    """Change of joint-to-joint lengths by plates on mounts, (m, legs) [m]."""
    system, at = found.system, found.equilibrium.state.pose
    shapes, R = system.kernel.shapes, matrix(at[3:])
    tips = at[:3] + (robot.platform_joints - robot.com) @ R.T
    axes, more = tips - robot.home_bases, np.zeros((len(found.shapes), len(robot.legs)))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    for name, mount, axes_there, joints in (
        ("m", robot.platform_mount, axes @ R, robot.platform_joints),
        ("f", robot.base_mount, -axes, robot.home_bases),
    ):
        if mount is not None:
            step = found.shapes[:, shapes.index(name) : shapes.index(name) + 6]
            moved = step[:, None, :3] + np.cross(step[:, None, 3:], joints - mount.at)
            more += (moved * axes_there).sum(axis=-1)
    return more


def _ways(legs: kinematics.Limbs, feet: Array) -> Array:
    """Velocities of the feet (legs, 3) for unit rates of their carriages."""
    if legs.carriage == "slider":
        return legs.carriage_axis
    return np.cross(legs.carriage_axis, feet - legs.base + legs.carriage_arm)


class Vibration(NamedTuple):
    """Vibration at instants `time` [s]: `frequency` [Hz], `envelope` (amplitude), `sag` (mean) of the signal."""

    time: Array
    frequency: Array
    envelope: Array
    sag: Array


def local_vibration(time: Array, signal: Array, frequency: Array, count: int = 9) -> Vibration:
    """Fit of one drifting harmonic and a parabola in windows of three periods.

    Parameters
    ----------
    time, signal : (T,) arrays
        Equally spaced instants [s].
    frequency : (T,) array
        Expected frequency [Hz]; its drift is taken from here, its level is fitted within 20 %.
    count : int
        How many windows, their centres spread evenly.

    Raises
    ------
    InputError
        The signal is shorter than a window.
    """
    from scipy.optimize import minimize_scalar

    phase = np.concatenate([[0.0], np.cumsum(0.5 * (frequency[1:] + frequency[:-1]) * np.diff(time))])
    if phase[-1] < 3.2:
        raise InputError("is too short", key="signal", value=f"{phase[-1]:.3g} periods", allowed="more than 3.2")
    rows = []
    for centre in np.linspace(1.6, phase[-1] - 1.6, count):
        inside = np.abs(phase - centre) <= 1.5
        turns, y = phase[inside] - centre, signal[inside]
        found = minimize_scalar(_misfit, bounds=(0.8, 1.2), method="bounded", args=(turns, y), options={"xatol": 1e-9})
        ratio = float(found["x"])  # pyright: ignore
        c, _ = _fit(ratio, turns, y)
        at = np.interp(centre, phase, np.arange(len(time)))
        now = np.interp(at, np.arange(len(time)), time)
        rows.append((now, ratio * np.interp(now, time, frequency), np.hypot(c[3], c[4]), c[0]))
    return Vibration(*np.array(rows).T)


def _fit(ratio: float, turns: Array, y: Array) -> tuple[Array, float]:
    """Coefficients of 1, turns, turns^2, cos and sin; sum of squared residuals."""
    c, s = np.cos(2 * np.pi * ratio * turns), np.sin(2 * np.pi * ratio * turns)
    columns = np.stack([np.ones_like(turns), turns, turns**2, c, s], axis=1)
    found = np.asarray(np.linalg.lstsq(columns, y, rcond=None)[0], dtype=float)
    return found, float(np.sum((columns @ found - y) ** 2))


def _misfit(ratio: float, turns: Array, y: Array) -> float:
    return _fit(ratio, turns, y)[1]
