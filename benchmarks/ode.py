"""Our own equations as an ordinary differential equation in independent coordinates, for SciPy's `solve_ivp`.

Everything that costs time is compiled (`ode*.c` below the same generated functions that flexapod uses), so that SciPy
is compared as an integrator, not Python as a language.
"""

from __future__ import annotations

import ctypes
import time
from ctypes import POINTER, Structure, addressof, c_double, c_long, c_void_p
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.deviation import Curve, deflection, rigid_centre
from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.mechanics import elements, symbolic
from flexapod.mechanics import leg as mechanics
from flexapod.mechanics.leg.kernel_functions import payload_functions
from flexapod.mechanics.leg.layout import Shapes, leg_parameters
from flexapod.mechanics.leg.leg import leg
from flexapod.mechanics.symbolic.compiler import compiled_library, compiler
from flexapod.mechanics.symbolic.functions import NamedFunction, inverse_dynamics, mass_matrix
from flexapod.mechanics.symbolic.vocabulary import jacobian, symbols, time_derivative, zeros
from flexapod.model import ActuatorStudy, Study
from flexapod.solve.shapes import home
from flexapod.solve.time.actuator_march import prepare_actuator
from flexapod.solve.time.command_tables import robot_law
from flexapod.solve.time.robot_march import prepare

__all__ = ["METHODS", "Ode", "ode"]

METHODS = ("RK45", "DOP853", "LSODA", "BDF", "Radau")
IMPLICIT = ("LSODA", "BDF", "Radau")
FOLDER = Path(__file__).parent
SPACING = 2.5e-4  # s, of the table of commands: quintics between exact values, rates and accelerations
RELATIVE = 1e-11  # of a pose of metres whose deviation is micrometres: absolute tolerances decide
FIRST = 1e-5  # s: the robot starts at rest, which says nothing about its time scale
_pointer = POINTER(c_double)


class _Robot(Structure):
    _fields_ = [
        ("rows", c_long),
        ("leg_np", c_long),
        ("leg_p", _pointer),
        ("joint_p", _pointer),
        ("payload_p", _pointer),
        ("table", _pointer),
        ("spacing", c_double),
        ("guess", _pointer),
    ]

    @property
    def at(self) -> int:
        """Address."""
        return addressof(self)


def _address(array: Array):
    return array.ctypes.data_as(_pointer)


def functions(shapes: Shapes) -> list[NamedFunction]:
    """Tip of a leg; mass matrix, forces at rest, tip Jacobian, curvature; the payload, if there is one."""
    p_vector, p = symbols(leg_parameters(shapes), "p")
    q, qs = symbols(shapes.layout, "q")
    v, vs = symbols(shapes.layout, "v")
    body = leg(shapes, p, q, v, qs, vs)
    h = inverse_dynamics(body.lagrangian, zeros(shapes.size))  # what drives is given: no drive has a spring
    J = jacobian(body.tip, q)
    bend = time_derivative(time_derivative(body.tip, (q, v)), (q, v))
    return [
        NamedFunction("leg_tip", [("q", q), ("p", p_vector)], [("tip", body.tip), ("J", J)]),
        NamedFunction(
            "leg_ode",
            [("q", q), ("v", v), ("p", p_vector)],
            [("M", mass_matrix(body.lagrangian)), ("h", h), ("J", J), ("bend", bend)],
        ),
        *(payload_functions(shapes)[:1] if shapes.rows else ()),
    ]


@dataclass(frozen=True, kw_only=True)
class Ode:
    """Rates of the state y = (free coordinates of the legs, pose, their rates), with the state at the start.

    ``scale``: what a tolerance of 1 is of each number.
    """

    study: Study | ActuatorStudy
    library: ctypes.CDLL
    robot: _Robot
    start: Array
    scale: Array
    places: int  # numbers of the state before the rates
    keep: tuple[Array, ...]  # arrays that C reads

    def rates(self, t: float, y: Array) -> Array:
        """Rates of the state."""
        y, y_dot = np.ascontiguousarray(y), np.empty(len(y))
        self.library.rates(self.robot.at, t, y.ctypes.data, y_dot.ctypes.data)
        return y_dot

    def jacobian(self, t: float, y: Array) -> Array:
        """Derivatives of the rates by differences of a thousandth of the scale.

        SciPy's own, sized by a pose of metres or an amplitude of zero, make its implicit methods fail.
        """
        size, (dq, dv) = len(y), 1e-3 * self.scale[[0, -1]]
        matrix = np.empty((size, size), order="F")
        y = np.ascontiguousarray(y)
        self.library.jacobian(self.robot.at, t, y.ctypes.data, size, self.places, dq, dv, matrix.ctypes.data)
        return matrix

    def solve(self, method: str, tolerance: float, most: float, instants: Array) -> tuple[Curve, float, int]:
        """Deviation at instants (T,), seconds of the processor, evaluations; steps of at most `most` [s]."""
        extra: dict[str, Any] = {"jac": self.jacobian} if method in IMPLICIT else {}
        process = time.process_time()
        found = solve_ivp(
            self.rates, (0.0, float(instants[-1])), self.start, method, instants,
            rtol=RELATIVE, atol=self.scale * tolerance, first_step=FIRST, max_step=most, **extra,
        )  # fmt: skip
        process = time.process_time() - process
        if not found.success:
            raise RuntimeError(f"{method} at {tolerance:g}: {found.message}")
        return self._curve(instants, found.y.T), process, int(found.nfev)

    def _curve(self, t: Array, y: Array) -> Curve:
        """Deviation of the payload, or of an actuator its tip's deflection."""
        if isinstance(self.study, ActuatorStudy):
            return Curve(t, deflection(self.study, y[:, : self.places]))
        centre = y[:, self.places - 7 : self.places - 4]
        return Curve(t, centre - rigid_centre(self.study, t))


def ode(study: Study | ActuatorStudy) -> Ode:
    """A study whose strokes, rotors or rotation are given, from its start at rest, as an ordinary equation.

    Raises
    ------
    RuntimeError
        There is no C compiler.
    """
    march = prepare(study) if isinstance(study, Study) else prepare_actuator(study)
    system, state = march.system, march.start
    shapes, held = system.kernel.shapes, [int(k) for k in np.flatnonzero(system.held.any(axis=0))]
    last = shapes.index("c") if shapes.l_index in held else shapes.l_index
    dependent = [shapes.index("alpha"), shapes.index("beta"), last] if shapes.rows else []
    free = [k for k in range(shapes.size) if k not in (*held, *dependent)]
    library = _library(shapes, held, dependent, free)
    t = np.arange(round(study.duration / SPACING) + 2) * SPACING
    guess = np.zeros(0)
    if isinstance(study, Study):
        rigid = partial(kinematics.rigid_poses, study.robot, study.motion)
        table, legs = robot_law(system, study.robot, study.load, rigid)(t)[0], rigid(t).legs
        third = legs.length if last == shapes.l_index else np.zeros_like(legs.length)
        guess = np.ascontiguousarray(np.stack([legs.alpha, legs.beta, third], axis=-1))
        unit, frequency, places = 1e-5, 1e3, len(free) * system.legs + 7  # 10 um of deviation
    else:
        table = np.zeros((len(t), 1, system.ports.size, 4))
        for k, (name, begin) in enumerate(home(study.actuator).items()):
            x = kinematics.motion_law(getattr(study.motion, name), t)
            table[:, 0, k, :3] = np.stack([x.position + begin, x.rate, x.acceleration], axis=-1)
        unit, frequency, places = study.initial.tip_displacement, 10.0, len(free)
    ports = [list(system.ports).index(k) for k in held]
    table = np.ascontiguousarray(table[:, :, ports, :3])
    keep = (np.ascontiguousarray(system.leg_p), system.joint_p, system.payload_p, table, guess)
    pointers = [_address(x) for x in keep]
    robot = _Robot(len(t), keep[0].shape[1], *pointers[:4], SPACING, pointers[4])
    z = state.q[:, free].ravel()
    pose, rates = (state.pose, np.zeros(6)) if shapes.rows else (np.zeros(0), np.zeros(0))
    start = np.concatenate([z, pose, np.zeros(len(z)), rates])
    scale = np.full(len(start), unit)
    scale[places:] *= frequency
    return Ode(study=study, library=library, robot=robot, start=start, scale=scale, places=places, keep=keep)


def _library(shapes: Shapes, held: list[int], dependent: list[int], free: list[int]) -> ctypes.CDLL:
    command = compiler()
    if command is None:
        raise RuntimeError("there is no C compiler")
    packages = [Path(str(package.__file__)).parent for package in (elements, mechanics, symbolic)]
    texts = [path.read_bytes() for folder in packages for path in sorted(folder.glob("*.py"))]
    key = ["benchmark ode", *texts, repr(shapes), Path(__file__).read_bytes()]
    lists = {"GIVEN": held, "DEPENDENT": dependent, "FREE": free}
    sizes = f"enum {{ N = {shapes.size}, COUNT = {len(free)}, GIVES = {len(held)} }};\n" + "".join(
        f"static const int {name}[] = {{{', '.join(map(str, places))}}};\n" for name, places in lists.items() if places
    )
    sources = (FOLDER / "ode.c", FOLDER / ("ode_robot.c" if shapes.rows else "ode_leg.c"))
    text = "\n".join([sizes, *(path.read_text(encoding="utf-8") for path in sources)])
    library, _ = compiled_library(key, lambda: functions(shapes), command, text)
    library.rates.restype = library.jacobian.restype = None
    library.rates.argtypes = [c_void_p, c_double, c_void_p, c_void_p]
    library.jacobian.argtypes = [c_void_p, c_double, c_void_p, c_long, c_long, c_double, c_double, c_void_p]
    return library
