"""The compiled time loop: one C call advances a chunk. Structures mirror ``native/system.h``."""

import ctypes
from ctypes import Structure, byref, c_double, c_long, c_void_p
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.errors import ComputationError
from flexapod.integration import GeneralizedAlpha
from flexapod.solve.plant import Counters, Flow, Plant, record_width
from flexapod.typing import Array

TOL_CLOSURE, TOL_FORCE = 1e-14, 1e-10  # m; relative to the largest force: rounding floors of metres and kilonewtons
MAX_ITERATIONS, MAX_AGE = 12, 16


class _Settings(Structure):
    _fields_ = [
        *[(name, c_long) for name in ("legs", "n", "l_index", "payload", "prescribed_l", "prescribed_beta")],
        ("leg_p", c_void_p),
        ("payload_p", c_void_p),
        ("leg_np", c_long),
        *[
            (name, c_double)
            for name in ("h", "alpha_m", "alpha_f", "beta", "gamma", "tol_closure", "tol_force", "force_floor")
        ],
        *[(name, c_long) for name in ("max_iterations", "max_age", "output_every")],
    ]


class _State(Structure):
    _fields_ = [
        *[(name, c_void_p) for name in ("q", "v", "v_dot", "a", "lam", "drive", "pose", "sums", "powers", "record")],
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


def _address(array: Array) -> c_void_p:
    return c_void_p(array.ctypes.data)


def _bits(mask: NDArray[np.bool_]) -> int:
    return sum(1 << i for i, on in enumerate(mask) if on)


def _settings(plant: Plant, method: GeneralizedAlpha, h: float, output_every: int) -> _Settings:
    return _Settings(
        plant.legs, plant.n, plant.kernel.shapes.l_index, int(plant.robot), _bits(plant.held_l), _bits(plant.held_beta),
        _address(plant.leg_p), _address(plant.payload_p), plant.leg_p.shape[1],
        h, method.alpha_m, method.alpha_f, method.beta, method.gamma, TOL_CLOSURE, TOL_FORCE, plant.force_floor,
        MAX_ITERATIONS, MAX_AGE, output_every,
    )  # fmt: skip


def _state(flow: Flow, rows: Array) -> _State:
    arrays = (flow.q, flow.v, flow.v_dot, flow.a, flow.lam, flow.drive, flow.pose, flow.sums, flow.powers, rows)
    return _State(*[_address(x) for x in arrays])


def _library(plant: Plant) -> ctypes.CDLL:
    library = plant.kernel.library
    if library is None:
        raise RuntimeError("this kernel is not compiled: its steps are those of solve.interpreted")
    return library


def advance(
    plant: Plant,
    method: GeneralizedAlpha,
    flow: Flow,
    h: float,
    tables: tuple[Array, Array],
    every: int,
    counters: Counters,
) -> Advance:
    """Advance by the rows of ``tables`` ((steps + 1, legs * TABLE), (steps + 1, 6)), recording each ``every`` steps."""
    library = _library(plant)
    table, wrench = (np.ascontiguousarray(x) for x in tables)
    steps = len(table) - 1
    new, rows = flow.copy(), np.zeros((steps // every, record_width(plant)))
    settings, state = _settings(plant, method, h, every), _state(new, rows)
    status = library.march(byref(settings), byref(state), _address(table), _address(wrench), c_long(steps))
    counters.steps += state.steps
    counters.iterations += state.iterations
    counters.factorisations += state.factorisations
    done = steps if status == 0 else state.steps - 1
    return Advance(flow=new, rows=rows[: done // every], status=status, step=done, leg=state.bad_leg)


def first_record(plant: Plant, flow: Flow, table: Array, wrench: Array) -> tuple[Flow, Array]:
    """Output row of the start, and the flow with its powers set."""
    library = _library(plant)
    new, rows = flow.copy(), np.zeros((1, record_width(plant)))
    settings, state = _settings(plant, GeneralizedAlpha(1.0), 1.0, 1), _state(new, rows)
    library.record_state.restype = None
    library.record_state(
        byref(settings), byref(state), _address(np.ascontiguousarray(table)), _address(np.ascontiguousarray(wrench))
    )
    return new, rows


def scaled_defect(plant: Plant, flow: Flow, ratio: float) -> Flow:
    """Flow of a robot whose velocities normal to the closures are ``ratio`` times those of ``flow``, Eq. (T6.14).

    Raises
    ------
    ComputationError
        The mass metric is singular on the closures.
    """
    new = flow.copy()
    settings, state = _settings(plant, GeneralizedAlpha(1.0), 1.0, 1), _state(new, np.zeros(1))
    scale = _library(plant).scale_normal_velocity
    if scale(byref(settings), byref(state), _address(np.zeros(6)), c_double(ratio - 1)):
        raise ComputationError(
            "the step cannot be changed here: the mass matrix is singular on the joints",
            next_step="Check for a leg without mass, or give a fixed simulation.step in place of a tolerance",
        )
    return new
