"""Laws of motion and of loads in closed form, exact at each instant, Eqs. (T2.1)-(T2.8).

A *step profile* s(tau) rises from 0 at tau = 0 to 1 at tau = 1 and rests outside. A *scalar law* is a function
of time. Laws of motion return position, rate and acceleration together; none holds a state. The laws of a study
file for rotation and extension of an actuator, torques, forces and wrenches are evaluated at given instants.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import check_known
from flexapod.model import (
    ActuatorLoad,
    ConstantLaw,
    ConstantWrench,
    CsvLaw,
    CsvWrench,
    Load,
    LoadLaw,
    MotionLaw,
    ProfileLaw,
    RateLaw,
    SineLaw,
    SineWrench,
    SpinUpLaw,
    StepLaw,
)

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

S_CURVE_FRACTIONS = (1 / 8, 1 / 8, 1 / 8, 1 / 4, 1 / 8, 1 / 8, 1 / 8)  # jerk +, 0, -, 0, -, 0, +
TRAPEZOID_FRACTIONS = (1 / 4, 1 / 2, 1 / 4)  # accelerate, cruise, brake

_SMOOTH_REST = 1 / 700  # below this tau, exp(-1/tau) is less than 1e-300: the step is 0 to the last digit


class Law(NamedTuple):
    """A scalar law at instants: position, rate, acceleration, each shape (T,) or (T, n)."""

    position: NDArray[np.float64]
    rate: NDArray[np.float64]
    acceleration: NDArray[np.float64]


def _quintic(tau: NDArray) -> Law:
    """Least polynomial with rest and zero acceleration at both ends, Eq. (T2.1)."""
    return Law(
        tau**3 * (10 + tau * (6 * tau - 15)),
        30 * (tau * (1 - tau)) ** 2,
        60 * tau * (1 - tau) * (1 - 2 * tau),
    )


def _cycloidal(tau: NDArray) -> Law:
    """Sinusoidal acceleration, Eq. (T2.2)."""
    angle = 2 * np.pi * tau
    return Law(tau - np.sin(angle) / (2 * np.pi), 1 - np.cos(angle), 2 * np.pi * np.sin(angle))


def _smooth(tau: NDArray) -> Law:
    """Step with all derivatives continuous and zero at both ends, Eq. (T2.3)."""
    safe = np.clip(tau, _SMOOTH_REST, 1 - _SMOOTH_REST)
    u, w = 1 / safe, 1 / (1 - safe)
    s = 0.5 * (1 - np.tanh(0.5 * (u - w)))
    spread = 1 / (2 * np.cosh(np.clip(0.5 * (u - w), -350, 350))) ** 2  # s (1 - s) without cancellation
    h = u**2 + w**2
    inside = (tau > _SMOOTH_REST) & (tau < 1 - _SMOOTH_REST)
    rate = np.where(inside, spread * h, 0.0)
    acceleration = np.where(inside, spread * ((1 - 2 * s) * h**2 + 2 * (w**3 - u**3)), 0.0)
    return Law(np.where(inside, s, np.where(tau < 0.5, 0.0, 1.0)), rate, acceleration)


def _linear(tau: NDArray) -> Law:
    """Constant rate: the rate jumps at both ends, which is an impact, Eq. (T2.4)."""
    return Law(tau, np.ones_like(tau), np.zeros_like(tau))


def _piecewise(fractions: tuple[float, ...], top: tuple[float, ...], order: int) -> Callable[[NDArray], Law]:
    """Profile whose `order`-th derivative is piecewise constant, proportional to `top`, Eq. (T2.5)."""
    knots = np.concatenate([[0.0], np.cumsum(fractions)])
    knots[-1] = 1.0
    state = np.zeros((len(top) + 1, 3))  # position, rate, acceleration at each knot

    def advance(start: NDArray, level: NDArray, x: NDArray) -> NDArray:
        jerk, added = (level, 0.0) if order == 3 else (0.0, level)
        a = start[..., 2] + added
        return np.stack(
            [
                start[..., 0] + x * (start[..., 1] + x * (a / 2 + x * jerk / 6)),
                start[..., 1] + x * (a + x * jerk / 2),
                a + x * jerk,
            ],
            axis=-1,
        )

    levels = np.asarray(top, dtype=float)
    for i, width in enumerate(fractions):
        state[i + 1] = advance(state[i], levels[i], np.asarray(width))
        if order == 2:
            state[i + 1, 2] = 0.0
    scale = 1 / state[-1, 0]
    state, levels = state * scale, levels * scale

    def profile(tau: NDArray) -> Law:
        phase = np.clip(np.searchsorted(knots, tau, side="right") - 1, 0, len(levels) - 1)
        return Law(*np.moveaxis(advance(state[phase], levels[phase], tau - knots[phase]), -1, 0))

    return profile


PROFILES: dict[str, Callable[[NDArray[np.float64]], Law]] = {
    "quintic": _quintic,
    "cycloidal": _cycloidal,
    "s-curve": _piecewise(S_CURVE_FRACTIONS, (1, 0, -1, 0, -1, 0, 1), order=3),
    "trapezoid": _piecewise(TRAPEZOID_FRACTIONS, (1, 0, -1), order=2),
    "smooth": _smooth,
    "linear": _linear,
}


def step(profile: str, tau: ArrayLike) -> Law:
    """Evaluate a unit step profile s(tau) with its first and second derivative by tau, Eqs. (T2.1)-(T2.5).

    Parameters
    ----------
    profile : str
        ``quintic``, ``cycloidal``, ``s-curve`` (jerk-limited, seven phases of `S_CURVE_FRACTIONS`), ``trapezoid``
        (trapezoidal rate, `TRAPEZOID_FRACTIONS`), ``smooth`` (infinitely differentiable) or ``linear``.
    tau : array_like, shape (T,)
        Dimensionless time; the profile rests at 0 before 0 and at 1 from 1 on. At a jump the value to the right counts.

    Returns
    -------
    Law
        s [-], ds/dtau, d2s/dtau2, each of the shape of `tau`.

    Raises
    ------
    InputError
        If the profile is unknown.
    """
    check_known(profile, PROFILES, "profile", "unknown profile")
    tau = np.asarray(tau, dtype=float)
    moving = (tau >= 0) & (tau < 1)
    s, s_1, s_2 = PROFILES[profile](np.clip(tau, 0.0, 1.0))
    return Law(np.where(tau >= 1, 1.0, s), np.where(moving, s_1, 0.0), np.where(moving, s_2, 0.0))


def rest_to_rest(t: ArrayLike, *, profile: str, amplitude: float, duration: float, start: float = 0.0) -> Law:
    """Move by `amplitude` in `duration` seconds from `start` on, then stay, Eq. (T2.6).

    Parameters
    ----------
    t : array_like, shape (T,)
        Instants [s].
    profile : str
        See `step`.
    amplitude : float
        Stroke, in the unit of the result.
    duration : float
        Time of the motion [s], positive.
    start : float
        Instant at which the motion begins [s].

    Returns
    -------
    Law
        Position, rate and acceleration, shape (T,).
    """
    s, s_1, s_2 = step(profile, (np.asarray(t, dtype=float) - start) / duration)
    return Law(amplitude * s, amplitude / duration * s_1, amplitude / duration**2 * s_2)


def constant_rate(t: ArrayLike, *, rate: float) -> Law:
    """Uniform motion ``rate t``, shape (T,)."""
    t = np.asarray(t, dtype=float)
    return Law(rate * t, np.full_like(t, rate), np.zeros_like(t))


def spin_up(t: ArrayLike, *, rate: float, duration: float) -> Law:
    """Spin-up to a steady rate with a cycloidal rate law, Eq. (T2.7).

    Parameters
    ----------
    t : array_like, shape (T,)
        Instants [s]; at rest before 0, uniform after `duration`.
    rate : float
        Steady rate Ws [rad/s].
    duration : float
        Ts [s].

    Returns
    -------
    Law
        Angle [rad], rate [rad/s], acceleration [rad/s^2], shape (T,).

    References
    ----------
    Simo & Vu-Quoc, "On the dynamics of flexible beams under large overall motions", J. Appl. Mech. 53 (1986).
    """
    t = np.asarray(t, dtype=float)
    x = np.clip(t / duration, 0.0, 1.0)
    inside = (t >= 0) & (t < duration)
    angle = rate * duration * (x**2 / 2 + (np.cos(2 * np.pi * x) - 1) / (2 * np.pi) ** 2)
    angle = angle + rate * np.maximum(t - duration, 0.0)
    return Law(
        angle,
        rate * (x - np.sin(2 * np.pi * x) / (2 * np.pi)),
        np.where(inside, rate / duration * (1 - np.cos(2 * np.pi * x)), 0.0),
    )


def spline(times: ArrayLike, values: ArrayLike) -> BSpline:
    """Quintic interpolating spline, at rest with zero acceleration at both ends, Eq. (T2.8).

    Parameters
    ----------
    times : array_like, shape (n,)
        Ascending instants [s], n >= 2.
    values : array_like, shape (n,) or (n, m)
        Values to interpolate.

    Returns
    -------
    scipy.interpolate.BSpline
        Four times continuously differentiable between the ends. Two rows give the quintic profile.
    """
    times, values = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    zero = np.zeros(values.shape[1:])
    ends = [(1, zero), (2, zero)]
    from scipy.interpolate import make_interp_spline  # half a second that only tables need

    return make_interp_spline(times, values, k=5, bc_type=(ends, ends))


def spline_law(t: ArrayLike, curve: BSpline, *, first: float, last: float) -> Law:
    """Values of `spline` at instants `t`, at rest before `first` and after `last`.

    Parameters
    ----------
    t : array_like, shape (T,)
        Instants [s].
    curve : scipy.interpolate.BSpline
        As made by `spline`.
    first, last : float
        First and last instant of the table [s].

    Returns
    -------
    Law
        Position, rate, acceleration, shape (T,) or (T, m).
    """
    t = np.asarray(t, dtype=float)
    x = np.clip(t, first, last)
    inside = ((t >= first) & (t <= last)).reshape(t.shape + (1,) * (curve.c.ndim - 1))
    return Law(curve(x), np.where(inside, curve(x, nu=1), 0.0), np.where(inside, curve(x, nu=2), 0.0))


def motion_law(law: MotionLaw, t: ArrayLike) -> Law:
    """Position, rate and acceleration of a scalar motion from 0, each shape (T,).

    Parameters
    ----------
    law : flexapod.model.MotionLaw
        A table is interpolated by `laws.spline` (quintic, at rest at both ends).
    t : array_like, shape (T,)
        Instants [s].
    """
    t = np.asarray(t, dtype=float)
    if isinstance(law, RateLaw):
        return constant_rate(t, rate=law.rate)
    if isinstance(law, SpinUpLaw):
        return spin_up(t, rate=law.rate, duration=law.duration)
    if isinstance(law, CsvLaw):
        return spline_law(t, spline(law.time, law.value), first=float(law.time[0]), last=float(law.time[-1]))
    return rest_to_rest(t, profile=law.law, amplitude=law.amplitude, duration=law.duration)


def _sine(t: Array, frequency: float, phase: float) -> Array:
    return np.sin(2 * np.pi * frequency * t + phase)


def load_law(law: LoadLaw, t: ArrayLike) -> Array:
    """Torque [N m] or force [N] at instants `t` (T,); a table is interpolated linearly and held at its ends."""
    t = np.asarray(t, dtype=float)
    if isinstance(law, ConstantLaw):
        return np.full_like(t, law.value)
    if isinstance(law, SineLaw):
        return law.amplitude * _sine(t, law.frequency, law.phase)
    if isinstance(law, StepLaw):
        return np.where(t >= law.time, law.amplitude, 0.0)
    if isinstance(law, ProfileLaw):
        return rest_to_rest(t, profile=law.law, amplitude=law.amplitude, duration=law.duration).position
    return np.interp(t, law.time, law.value)


def wrench(load: Load | ActuatorLoad, t: ArrayLike) -> Array:
    """Force [N] and moment [N m] at the tool, world axes, shape (T, 6); a table is interpolated linearly.

    Parameters
    ----------
    load : flexapod.model.Load or ActuatorLoad
    t : array_like, shape (T,)
        Instants [s].
    """
    t, law = np.atleast_1d(np.asarray(t, dtype=float)), load.wrench
    if law is None:
        return np.zeros((len(t), 6))
    if isinstance(law, ConstantWrench):
        return np.tile(law.value, (len(t), 1))
    if isinstance(law, CsvWrench):
        return np.stack([np.interp(t, law.time, column) for column in law.wrench.T], axis=1)
    scale = _sine(t, law.frequency, law.phase) if isinstance(law, SineWrench) else (t >= law.time).astype(float)
    return scale[:, None] * law.amplitude
