"""The compiled time loop: one C call advances a chunk. Structures mirror ``native/system.h``."""

import ctypes
from ctypes import Structure, byref, c_double, c_long, c_void_p
from dataclasses import dataclass

import numpy as np

from flexapod.arrays import Array
from flexapod.errors import ComputationError
from flexapod.integration import GeneralizedAlpha
from flexapod.solve.recording import Counters, record_width
from flexapod.solve.system import Flow, System

PORTS = 24  # as in system.h
TOL_CLOSURE, TOL_FORCE = 1e-14, 1e-10  # m; relative to the largest force: rounding floors of metres and kilonewtons
MAX_ITERATIONS, MAX_AGE = 12, 16
#: Matrices of legs with more coordinates than this serve eight times as many steps: they cost more than what their age
#: does. As in march.c.
LARGE = 30


class _Settings(Structure):
    _fields_ = [
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
    """Outcome of a chunk: new flow, output rows, status (0 = done), and where it failed."""

    flow: Flow
    rows: Array
    status: int
    step: int
    leg: int


def address(array: Array) -> c_void_p:
    """Where an array begins, for C."""
    return c_void_p(array.ctypes.data)


class Call:
    """Structures of one call, and the arrays that they point to."""

    def __init__(self, system: System, flow: Flow, rows: Array, method: GeneralizedAlpha, h: float, every: int) -> None:
        self.kept = system.as_read_by_c
        self.settings = _Settings(
            system.legs, int(system.hub), system.ports.size, (c_long * PORTS)(*system.ports.tolist()),
            *[address(x) for x in self.kept],
            h, method.alpha_m, method.alpha_f, method.beta, method.gamma, TOL_CLOSURE, TOL_FORCE, system.force_floor,
            MAX_ITERATIONS, MAX_AGE * (8 if system.n > LARGE else 1), every,
        )  # fmt: skip
        arrays = (flow.q, flow.v, flow.v_dot, flow.a, flow.lam, flow.drive, flow.pose, flow.bristles)
        arrays += (flow.sums, flow.powers, rows)
        self.state = _State(*[address(x) for x in arrays])


def compiled(system: System) -> ctypes.CDLL:
    """The library of a system's kernel."""
    library = system.kernel.library
    if library is None:
        raise RuntimeError("this kernel is not compiled: its steps are those of solve.interpreted")
    return library


def advance(
    system: System,
    method: GeneralizedAlpha,
    flow: Flow,
    h: float,
    tables: tuple[Array, Array],
    every: int,
    counters: Counters,
    resumed: bool = False,
) -> Advance:
    """Advance by the rows of ``tables`` ((T, legs, ports, 4), (T, load_size)), recording each ``every`` steps.

    ``resumed``: from where the call before ended, with the bits of a single call for both.
    """
    library = compiled(system)
    table, wrench = (np.ascontiguousarray(x) for x in tables)
    steps = len(table) - 1
    new, rows = flow.copy(), np.empty((steps // every, record_width(system)))
    call = Call(system, new, rows, method, h, every)
    state = call.state
    status = library.march(
        byref(call.settings), byref(state), address(table), address(wrench), c_long(steps), c_long(resumed)
    )
    counters.steps += state.steps
    counters.iterations += state.iterations
    counters.factorisations += state.factorisations
    done = steps if status == 0 else state.steps - 1
    return Advance(flow=new, rows=rows[: done // every], status=status, step=done, leg=state.bad_leg)


def first_record(system: System, flow: Flow, table: Array, wrench: Array) -> tuple[Flow, Array]:
    """Output row of the start, and the flow with its powers set."""
    library = compiled(system)
    new, rows = flow.copy(), np.zeros((1, record_width(system)))
    call = Call(system, new, rows, GeneralizedAlpha(1.0), 1.0, 1)
    table, wrench = (np.ascontiguousarray(x) for x in (table, wrench))
    library.record_state.restype = None
    library.record_state(byref(call.settings), byref(call.state), address(table), address(wrench))
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
    scale = compiled(system).scale_normal_velocity
    if scale(byref(call.settings), byref(call.state), address(none), c_double(ratio - 1)):
        raise ComputationError(
            "the step cannot be changed here: the mass matrix is singular on the joints",
            next_step="Check for a leg without mass, or give a fixed simulation.step in place of a tolerance",
        )
    return new
