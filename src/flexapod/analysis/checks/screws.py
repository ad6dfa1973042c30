"""Catalogue limits of screws: buckling, critical speed, torque, back-driving, life, Eqs. (T15.41)-(T15.49).

Friction of drives that slide steadily, as catalogues state it, is of Eq. (T19.19).
"""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.model import Nut, ScrewDrive, ScrewFriction, StrokeFriction
from flexapod.model.leg.screw import UNLOADS


def steady_friction(friction: ScrewFriction | StrokeFriction, rate: Array) -> Array:
    """Torque of a screw [N m] or force of a stroke [N] at a rate of sliding [rad/s, m/s], with its sign, Eq. (T19.19).

    Nothing where it rests.
    """
    sliding, _, _, excess, slower, viscous, _ = friction.numbers
    return np.asarray(np.sign(rate) * sliding * (1 + excess * np.exp(-((rate * slower) ** 2))) + viscous * rate)


_EULER = {"fixed-free": 0.25, "fixed-supported": 2.0, "fixed-fixed": 4.0}  # pi^2 E I / l^2 times this
_ROOT = {"fixed-free": 1.8751040687, "fixed-supported": 3.9266023120, "fixed-fixed": 4.7300407449}  # of a beam's mode 1
_ALLOWED_THRUST, _ALLOWED_SPEED = 0.5, 0.8  # THK
MILLION = 1e6  # turns to which a dynamic load rating refers


def buckling_shares(screw: ScrewDrive, loaded: Array, thrust: Array) -> Array:
    """Push [N] over what a shaft of `loaded` length [m] bears; where both ends hold pull counts, too."""
    pushed = np.abs(thrust) if screw.mounting == "fixed-fixed" else np.maximum(thrust, 0.0)
    return pushed / buckling_thrust(screw, loaded)


def buckling_thrust(screw: ScrewDrive, loaded: Array) -> Array:
    """Thrust that the shaft may bear [N], half of its Euler load, Eq. (T15.41).

    Parameters
    ----------
    screw : ScrewDrive
    loaded : ndarray
        Distance of the nut from the bearing [m]: the piece under thrust of a free shaft. Of a shaft between two
        bearings its whole length counts.
    """
    inertia = np.pi / 64 * screw.root_diameter**4
    span = np.asarray(loaded) if screw.mounting == "fixed-free" else np.full(np.shape(loaded), screw.length)
    with np.errstate(divide="ignore"):
        return _ALLOWED_THRUST * _EULER[screw.mounting] * np.pi**2 * screw.material.E * inertia / span**2


def critical_speed(screw: ScrewDrive) -> float:
    """Speed that the shaft may turn at [rad/s], 0.8 of its first frequency without support by the nut, (T15.42)."""
    radius = screw.root_diameter / 4  # of gyration of a round bar
    wave = np.sqrt(screw.material.E / screw.material.density) * radius
    return float(_ALLOWED_SPEED * (_ROOT[screw.mounting] / screw.length) ** 2 * wave)


def drag_torque(screw: ScrewDrive, speed: Array) -> Array:
    """Torque at the screw by its friction at speeds [rad/s], Eq. (T19.19), or by the preload of its nut, Eq. (T15.43).

    In N m, with the sign of the speed; 0 where neither is given.
    """
    if screw.friction is not None:
        return steady_friction(screw.friction, speed)
    slope = screw.lead / (np.pi * screw.root_diameter)
    return np.asarray(np.sign(speed) * 0.05 / np.sqrt(slope) * (screw.nut.preload or 0.0) * screw.per_turn)


def back_efficiency(screw: ScrewDrive) -> float:
    """Work of the screw over thrust times lead where the thrust turns it; negative: it does not, Eq. (T15.44)."""
    return 2 - 1 / screw.efficiency


def motor_torque(screw: ScrewDrive, thrust: Array, rate: Array, accel: Array) -> Array:
    """Torque of the motor along a path [N m], Eq. (T15.45).

    Parameters
    ----------
    screw : ScrewDrive
    thrust, rate, accel : ndarray, shape (T,)
        Thrust on the piston [N], rate [m/s] and acceleration [m/s^2] of the stroke. Where it rests nothing rubs.
    """
    speed = np.where(np.abs(rate) > 1e-9 * np.abs(rate).max(initial=0.0), rate, 0.0) / screw.per_turn
    way = (np.sign(thrust) * np.sign(speed) + 1).astype(int)
    of_thrust = thrust * screw.per_turn * np.choose(way, [back_efficiency(screw), 1.0, 1 / screw.efficiency])
    return (of_thrust + drag_torque(screw, speed) + screw.inertia * accel / screw.per_turn) / screw.rotor.ratio


def half_loads(nut: Nut, thrust: Array) -> Array:
    """Loads of the balls that push out and of those that push in [N], shape (2, T), Eq. (T15.46)."""
    thrust = np.asarray(thrust, dtype=float)
    both = np.stack([thrust, -thrust])
    if nut.preload is None:
        return np.maximum(both, 0.0)
    share = both / (UNLOADS * nut.preload)
    held = nut.preload * np.maximum(1 + share, 0.0) ** 1.5
    return np.where(share > 1, both, held)


def mean_load(load: Array, rate: Array) -> Array:
    """Load that wears as much as the changing one, weighted by the turns made [N], Eq. (T15.47)."""
    turns = np.abs(rate)
    return np.cbrt((load**3 * turns).sum(axis=-1) / turns.sum())


def turns_of_life(rating: float, mean: Array) -> float:
    """Turns that nine of ten nuts survive, of both halves together, Eqs. (T15.48) and (T15.49)."""
    with np.errstate(divide="ignore"):
        each = MILLION * (rating / np.asarray(mean)) ** 3
        return float((each ** (-10 / 9)).sum() ** (-9 / 10))
