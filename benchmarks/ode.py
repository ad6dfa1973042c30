"""Our own equations as an ordinary differential equation in independent coordinates, for SciPy's `solve_ivp`.

Everything that costs time is compiled (`ode.c` below the same generated functions that flexapod uses), so that SciPy is
compared as an integrator, not Python as a language.
"""

from __future__ import annotations

import ctypes
import time
from ctypes import POINTER, Structure, addressof, c_double, c_long, c_void_p
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.deviation import Curve, rigid_centre
from flexapod import elements, mechanics, rigid, symbolic
from flexapod.mechanics.assembly import payload_functions
from flexapod.mechanics.layout import LEG_PARAMETERS, Shapes
from flexapod.mechanics.leg import leg
from flexapod.model import Study
from flexapod.solve.robot_march import prepare
from flexapod.symbolic.compiler import compiled_library, compiler
from flexapod.symbolic.functions import NamedFunction
from flexapod.symbolic.lagrange import inverse_dynamics, mass_matrix
from flexapod.symbolic.vocabulary import jacobian, symbols, time_derivative, zeros
from flexapod.typing import Array

__all__ = ["METHODS", "Ode", "ode"]

METHODS = ("RK45", "DOP853", "LSODA", "BDF", "Radau")
IMPLICIT = ("LSODA", "BDF", "Radau")
SOURCE = Path(__file__).with_name("ode.c")
SPACING = 2.5e-4  # s, of the table of strokes: quintics between exact values, rates and accelerations
RELATIVE = 1e-11  # of a pose of metres whose deviation is micrometres: absolute tolerances decide
FIRST = 1e-5  # s: the robot starts at rest, which says nothing about its time scale
_pointer = POINTER(c_double)


class _Robot(Structure):
    _fields_ = [
        ("n", c_long),
        ("rows", c_long),
        ("leg_np", c_long),
        ("leg_p", _pointer),
        ("joint_p", _pointer),
        ("payload_p", _pointer),
        ("table", _pointer),
        ("spacing", c_double),
    ]

    @property
    def at(self) -> int:
        """Address."""
        return addressof(self)


def _address(array: Array):
    return array.ctypes.data_as(_pointer)


def functions(shapes: Shapes) -> list[NamedFunction]:
    """Tip of a leg; its mass matrix, forces at rest of the accelerations, tip Jacobian and curvature; the payload."""
    p_vector, p = symbols(LEG_PARAMETERS, "p")
    q, qs = symbols(shapes.layout, "q")
    v, vs = symbols(shapes.layout, "v")
    body = leg(shapes, p, q, v, qs, vs)
    h = inverse_dynamics(body.lagrangian, zeros(shapes.size))  # strokes are prescribed: no drive has a spring
    J = jacobian(body.tip, q)
    bend = time_derivative(time_derivative(body.tip, (q, v)), (q, v))
    return [
        NamedFunction("leg_tip", [("q", q), ("p", p_vector)], [("tip", body.tip), ("J", J)]),
        NamedFunction(
            "leg_ode",
            [("q", q), ("v", v), ("p", p_vector)],
            [("M", mass_matrix(body.lagrangian)), ("h", h), ("J", J), ("bend", bend)],
        ),
        payload_functions(shapes)[0],
    ]


@dataclass(frozen=True, kw_only=True)
class Ode:
    """Rates of the state y = (amplitudes without c_0 of every leg, pose, their rates), with the state at the start."""

    study: Study
    library: ctypes.CDLL
    robot: _Robot
    start: Array
    keep: tuple[Array, ...]  # arrays that C reads

    def rates(self, t: float, y: Array) -> Array:
        """Rates of the state."""
        y, y_dot = np.ascontiguousarray(y), np.empty(len(y))
        self.library.rates(self.robot.at, t, y.ctypes.data, y_dot.ctypes.data)
        return y_dot

    def jacobian(self, t: float, y: Array) -> Array:
        """Derivatives of the rates by differences of 10 nm and 10 um/s.

        SciPy's own, sized by a pose of metres or an amplitude of zero, make its implicit methods fail.
        """
        size, count = len(y), 6 * (self.robot.n - 4) + 7
        matrix = np.empty((size, size), order="F")
        y = np.ascontiguousarray(y)
        self.library.jacobian(self.robot.at, t, y.ctypes.data, size, count, 1e-8, 1e-5, matrix.ctypes.data)
        return matrix

    def solve(self, method: str, tolerance: float, most: float, instants: Array) -> tuple[Curve, float, float, int]:
        """Deviation at instants (T,), seconds of wall and of process time, evaluations; steps of at most `most` [s].

        The tolerance is in units of the deviation: 10 um, and 10 mm/s, which this is at 1000 rad/s.
        """
        count = 6 * (self.robot.n - 4)
        scale = np.concatenate([np.full(count + 7, 1e-5), np.full(count + 6, 1e-2)])
        extra: dict[str, Any] = {"jac": self.jacobian} if method in IMPLICIT else {}
        wall, process = time.perf_counter(), time.process_time()
        found = solve_ivp(
            self.rates, (0.0, float(instants[-1])), self.start, method, instants,
            rtol=RELATIVE, atol=scale * tolerance, first_step=FIRST, max_step=most, **extra,
        )  # fmt: skip
        wall, process = time.perf_counter() - wall, time.process_time() - process
        if not found.success:
            raise RuntimeError(f"{method} at {tolerance:g}: {found.message}")
        centre = found.y[count : count + 3].T
        return Curve(instants, centre - rigid_centre(self.study, instants)), wall, process, int(found.nfev)


def ode(study: Study) -> Ode:
    """The study's robot, strokes prescribed, at rest in equilibrium at the start, as an ordinary equation."""
    march = prepare(study)
    system, state = march.system, march.start
    shapes, command = system.kernel.shapes, compiler()
    if command is None:
        raise RuntimeError("there is no C compiler")
    packages = [Path(str(package.__file__)).parent for package in (elements, mechanics, symbolic)]
    texts = [path.read_bytes() for folder in packages for path in sorted(folder.glob("*.py"))]
    key = ["benchmark ode", *texts, repr(shapes), Path(__file__).read_bytes()]
    library, _ = compiled_library(key, lambda: functions(shapes), (SOURCE,), command)
    library.rates.restype = library.jacobian.restype = None
    library.rates.argtypes = [c_void_p, c_double, c_void_p, c_void_p]
    library.jacobian.argtypes = [c_void_p, c_double, c_void_p, c_long, c_long, c_double, c_double, c_void_p]
    t = np.arange(round(study.duration / SPACING) + 2) * SPACING
    legs = rigid.inverse_kinematics(study.robot, rigid.poses(study.robot, study.motion, t))
    table = np.ascontiguousarray(np.stack([legs.length, legs.rate, legs.accel, legs.alpha, legs.beta], axis=-1))
    keep = (np.ascontiguousarray(system.leg_p), system.joint_p, system.payload_p, table)
    robot = _Robot(system.n, len(t), keep[0].shape[1], *(_address(x) for x in keep), SPACING)
    z = state.q[:, 4:].ravel()
    start = np.concatenate([z, state.pose, np.zeros(len(z) + 6)])
    return Ode(study=study, library=library, robot=robot, start=start, keep=keep)
