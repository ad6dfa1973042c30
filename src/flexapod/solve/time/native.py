"""The compiled time loop: one C call advances a chunk. Structures mirror ``native/system.h``."""

import ctypes
from ctypes import Structure, byref, c_double, c_long, c_void_p
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.common.resources import retain_freed_memory
from flexapod.mechanics.symbolic.compiler import lanes, written_library
from flexapod.solve.kernel import Equations, Kernel
from flexapod.solve.system import Flow, System
from flexapod.solve.time.recording import Counters, record_width

if TYPE_CHECKING:
    from flexapod.solve.time.sampled_control import SampledLoop

NATIVE = Path(__file__).parent / "native"
SOURCES = tuple(
    NATIVE / name for name in "system.h lu.c legs.c arrow.c state.c loop.c march.c complex.c radau.c modal.c".split()
)
PORTS = 24  # as in system.h
LINE = 64  # bytes of the processor's cache, and of its longest vectors
TOL_CLOSURE, TOL_FORCE = 1e-14, 1e-10  # m; relative to the largest force: rounding floors of metres and kilonewtons
MAX_ITERATIONS, MAX_AGE = 12, 16
#: Matrices of legs with more coordinates than this serve eight times as many steps: they cost more than what their age
#: does. As in march.c.
LARGE = 30


class _Settings(Structure):
    _fields_ = [
        ("equations", ctypes.POINTER(Equations)),
        *[(name, c_long) for name in ("legs", "hub", "ports")],
        ("port", c_long * PORTS),
        *[(name, c_void_p) for name in ("held", "hub_held", "leg_p", "joint_p", "payload_p")],
        *[
            (name, c_double)
            for name in ("h", "alpha_m", "alpha_f", "beta", "gamma", "tol_closure", "tol_force", "force_floor")
        ],
        *[(name, c_long) for name in ("max_iterations", "max_age", "output_every")],
    ]


class _State(Structure):
    _fields_ = [
        *[(name, c_void_p) for name in ("q", "v", "v_dot", "a", "lam", "drive", "pose", "bristles")],
        *[(name, c_void_p) for name in ("sums", "powers", "record")],
        ("closure", c_double),
        *[(name, c_long) for name in ("steps", "iterations", "factorisations", "bad_leg")],
    ]


@dataclass(frozen=True, kw_only=True)
class Advance:
    """Outcome of a call: new flow, output rows, status (0 = done), leg in which it failed, and how far it came.

    ``step``: number of fixed ones, ``time`` [s] of steps within a tolerance; ``memory``: that of C at the end of fixed
    steps; ``control``: rows of a controller's record.
    """

    flow: Flow
    rows: Array
    status: int
    leg: int
    step: int = 0
    time: float = 0.0
    memory: Array | None = None
    control: Array | None = None


def address(array: Array) -> c_void_p:
    """Address of an array, for C."""
    return c_void_p(array.ctypes.data)


class Call:
    """Structures of one call, and the arrays that they point to."""

    def __init__(self, system: System, flow: Flow, rows: Array, method: GeneralizedAlpha, h: float, every: int) -> None:
        self.settings: Structure = settings(system, method, h, every)
        arrays = (flow.q, flow.v, flow.v_dot, flow.a, flow.lam, flow.drive, flow.pose, flow.bristles)
        arrays += (flow.sums, flow.powers, rows)
        self.state: Structure = _State(*[address(x) for x in arrays])


def settings(system: System, method: GeneralizedAlpha, h: float, every: int) -> Structure:
    """Settings that do not change in a call; they point to arrays of the system."""
    if system.kernel.equations is None:
        raise RuntimeError("this kernel is not compiled: its steps are those of solve.interpreted")
    return _Settings(
        ctypes.pointer(system.kernel.equations),
        system.legs, int(system.hub), system.ports.size, (c_long * PORTS)(*system.ports.tolist()),
        *[address(x) for x in system.as_read_by_c],
        h, method.alpha_m, method.alpha_f, method.beta, method.gamma, TOL_CLOSURE, TOL_FORCE, system.force_floor,
        MAX_ITERATIONS, MAX_AGE * (8 if system.n > LARGE else 1), every,
    )  # fmt: skip


def loops(kernel: Kernel) -> ctypes.CDLL:
    """Compiled time loops, the same for all kernels that one compiler makes: of the wheel, or its own.

    Raises
    ------
    ComputationError
        They were made for other vectors than the kernel.
    """
    bodies = None if kernel.library is None else lanes(kernel.library)
    library = _loops(kernel.compiler, bodies)
    if bodies not in (None, lanes(library)):
        raise ComputationError(
            "equations and time loops were not compiled for the same processor",
            next_step="`flexapod cache --clear`, then once more: both are compiled anew.",
        )
    return library


@cache
def _loops(command: tuple[str, ...], bodies: int | None) -> ctypes.CDLL:
    retain_freed_memory()
    library = written_library(SOURCES, list(command), bodies=bodies)
    library.march_memory.restype = library.radau_memory.restype = c_long
    library.record_state.restype = None
    return library


def memory(size: int) -> Array:
    """Zeros for so many bytes, from where a line of the processor's cache begins."""
    found = np.zeros(size // 8 + 8)
    first = -found.ctypes.data % LINE // 8
    return found[first : first + size // 8]


def _of_march(system: System, call: Call) -> Array:
    return memory(loops(system.kernel).march_memory(byref(call.settings)))


def advance(
    system: System,
    method: GeneralizedAlpha,
    flow: Flow,
    h: float,
    tables: tuple[Array, Array],
    every: int,
    counters: Counters,
    before: Advance | None = None,
    loop: "SampledLoop | None" = None,
    begin: float = 0.0,
) -> Advance:
    """Advance by the rows of ``tables`` ((T, legs, ports, 4), (T, load_size)), recording each ``every`` steps.

    ``before``: the call that ended there, to go on with the bits of a single call for both. ``loop``: a controller;
    ``begin``: instant of the first row [s].
    """
    table, wrench = (np.ascontiguousarray(x) for x in tables)
    steps = len(table) - 1
    new, rows = flow.copy(), np.empty((steps // every, record_width(system)))
    call = Call(system, new, rows, method, h, every)
    state, left = call.state, before.memory if before else None
    kept, given = _of_march(system, call) if left is None else left, [address(x) for x in (table, wrench)]
    control = np.empty((len(rows), loop.width if loop else 0))
    around, _held = loop.call(new, begin, begin + steps * h, control) if loop else (None, ())
    status = loops(system.kernel).march(
        byref(call.settings), byref(state), *given, c_long(steps), c_long(left is not None), address(kept),
        byref(around) if around else None,
    )  # fmt: skip
    counters.steps += state.steps
    counters.iterations += state.iterations
    counters.factorisations += state.factorisations
    done = steps if status == 0 else state.steps - 1
    return Advance(
        flow=new, rows=rows[: done // every], status=status, step=done, leg=state.bad_leg, memory=kept,
        control=control[: done // every] if loop else None,
    )  # fmt: skip


def first_record(system: System, flow: Flow, table: Array, wrench: Array) -> tuple[Flow, Array]:
    """Output row of the start, and the flow with its powers set."""
    new, rows = flow.copy(), np.zeros((1, record_width(system)))
    call = Call(system, new, rows, GeneralizedAlpha(1.0), 1.0, 1)
    table, wrench = (np.ascontiguousarray(x) for x in (table, wrench))
    kept = _of_march(system, call)
    loops(system.kernel).record_state(
        byref(call.settings), byref(call.state), address(table), address(wrench), address(kept)
    )
    return new, rows


def scaled_defect(system: System, flow: Flow, ratio: float) -> Flow:
    """Flow of a robot whose velocities normal to the closures are ``ratio`` times those of ``flow``, Eq. (T6.14).

    Raises
    ------
    ComputationError
        The mass metric is singular on the closures.
    """
    new = flow.copy()
    call, none = Call(system, new, np.zeros(1), GeneralizedAlpha(1.0), 1.0, 1), np.zeros(system.load_size)
    scale, kept = loops(system.kernel).scale_normal_velocity, _of_march(system, call)
    if scale(byref(call.settings), byref(call.state), address(none), c_double(ratio - 1), address(kept)):
        raise ComputationError(
            "the step cannot be changed here: the mass matrix is singular on the joints",
            next_step="Check for a leg without mass, or give a fixed simulation.step in place of a tolerance",
        )
    return new
