"""Results over rows of instants by compiled loops, ``time/native/results.c``; structures mirror it field by field.

For simulations whose equations are compiled: where they are interpreted, or where there are none, the same results are
those of `kinematics` and `analysis.results`.
"""

from __future__ import annotations

import ctypes
from ctypes import Structure, byref, c_double, c_long, c_void_p
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from flexapod.common.errors import ComputationError
from flexapod.kinematics.bodies import Nearest
from flexapod.kinematics.robot import home_frames, leg_bodies, payload_body
from flexapod.mechanics.symbolic.compiler import FLAGS, written_library

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from flexapod.common.arrays import Array
    from flexapod.kinematics import RigidPoses
    from flexapod.model import Robot
    from flexapod.solve.kernel import Kernel

SOURCES = (Path(__file__).parent / "time" / "native" / "results.c",)


class Rows(Structure):
    """Rows of numbers, as C reads them."""

    _fields_: ClassVar = [("at", c_void_p), ("step", c_long)]


class Given(Structure):
    """Structure that keeps the arrays to which it points."""

    _fields_: ClassVar = []

    def __init__(self, **values: Any) -> None:
        self.kept: list[Any] = []
        kinds: dict[str, Any] = dict(self._fields_)  # type: ignore[arg-type]
        super().__init__(**{name: self._as_read_by_c(kinds[name], value) for name, value in values.items()})

    def _as_read_by_c(self, kind: Any, value: Any) -> Any:
        if isinstance(value, list):
            return kind(*[self._as_read_by_c(Rows, x) for x in value])
        if not isinstance(value, np.ndarray):
            return value
        found = np.ascontiguousarray(value, dtype=float if kind is Rows else None)
        self.kept.append(found)
        if kind is not Rows:
            return found.ctypes.data
        return Rows(found.ctypes.data, found[0].size if len(found) > 1 else 0)


class _Drawn(Given):
    _fields_: ClassVar = [
        *[(name, c_long) for name in ("legs", "pairs")],
        *[(name, c_void_p) for name in ("platform", "home", "home_seen", "mouth", "radii", "pair")],
        *[(name, Rows) for name in ("place", "rotation", "base", "length")],
    ]


class _Balances(Given):
    _fields_: ClassVar = [
        *[(name, c_void_p) for name in ("frames", "base", "platform", "legs", "inertia", "com", "tool", "gravity")],
        ("mass", c_double),
        *[(x, Rows) for x in ("position", "velocity", "acceleration", "rotation", "omega", "alpha", "wrench")],
    ]


@cache
def result_loops(command: tuple[str, ...]) -> ctypes.CDLL:
    """Compiled loops over rows, the same for all robots."""
    library = written_library(SOURCES, list(command), flags=FLAGS)
    for name in ("joint_turns", "leg_lengths", "leg_clearance"):
        getattr(library, name).restype = None
    return library


def lengths(kernel: Kernel, place: Array, rotation: Array, base: Array, platform: Array) -> Array:
    """Distances of joints `base` (T or 1, n, 3) and `platform` (n, 3) of a frame at T poses, (T, n) [m]."""
    found = np.empty((len(place), len(platform)))
    drawn = _Drawn(legs=len(platform), platform=platform, place=place, rotation=rotation, base=base)
    result_loops(kernel.compiler).leg_lengths(byref(drawn), c_long(len(place)), to(found))
    return found


class DrawnLegs:
    """Legs of a robot as bodies at T instants, as they are drawn.

    Parameters
    ----------
    kernel : Kernel
        Equations of the simulation.
    robot : Robot
    place, rotation : ndarray, shape (T, 3), (T, 3, 3)
        Of the payload's centre of mass.
    base : ndarray, shape (T, n, 3) or (1, n, 3)
        Base joints [m].
    """

    def __init__(self, kernel: Kernel, robot: Robot, place: Array, rotation: Array, base: Array) -> None:
        self._library, self._robot = result_loops(kernel.compiler), robot
        home = robot.home_vectors / robot.home_lengths[:, None]
        self._given = {
            "platform": robot.platform_joints - robot.com,
            "home": home, "home_seen": home @ robot.home_rotation,
            "place": place, "rotation": rotation, "base": base,
        }  # fmt: skip

    def turns(self) -> Array:
        """Turns since home at base and platform joint, (T, n, 2) [rad], Eq. (T2.47)."""
        count, legs = len(self._given["place"]), self._robot.count
        found = np.empty((count, legs, 2))
        self._library.joint_turns(byref(_Drawn(legs=legs, **self._given)), c_long(count), to(found))
        return found

    def nearest(self, pairs: Array, mouth: Array, radii: Array, length: Array) -> Nearest:
        """Least gap among some pairs of legs of a `length` (T, n), see `kinematics.nearest_legs`, Eq. (T2.48)."""
        count = len(length)
        found = Nearest(np.empty(count), np.empty((count, 2), dtype=np.int64))
        drawn = _Drawn(
            legs=self._robot.count, pairs=len(pairs), pair=np.asarray(pairs, dtype=np.int64), mouth=mouth, radii=radii,
            length=length, **self._given,
        )  # fmt: skip
        self._library.leg_clearance(byref(drawn), c_long(count), to(found.gap), to(found.legs))
        return found


def balances(kernel: Kernel, at: RigidPoses, wrench: Array) -> dict[str, Array]:
    """Forces ``drive_force`` (T, 6) and ``joint_force`` (T, 6, 3) of six legs UPS; `wrench` (T, 6) at the tool.

    Those of `kinematics.dynamics.inverse_dynamics`, Eqs. (T2.26)-(T2.34).

    Raises
    ------
    ComputationError
        A pose is singular.
    """
    robot, poses, bodies, load = at.robot, at.poses, leg_bodies(at.robot), payload_body(at.robot)
    count, legs = len(poses), robot.count
    axial = bodies.axial, bodies.piston_mass, bodies.piston_length
    given = _Balances(
        frames=home_frames(robot), base=robot.base_joints, platform=robot.platform_joints,
        legs=np.stack([bodies.cylinder_mass, bodies.cylinder_com, bodies.cylinder_inertia, *axial], axis=1),
        inertia=load.inertia, com=load.com, tool=load.tool, gravity=robot.gravity, mass=load.mass,
        position=poses.position, velocity=poses.velocity, acceleration=poses.acceleration, rotation=poses.rotation,
        omega=poses.omega, alpha=poses.alpha, wrench=wrench,
    )  # fmt: skip
    drive, joint = np.empty((count, legs)), np.empty((count, legs, 3))
    if result_loops(kernel.compiler).rigid_forces(byref(given), c_long(count), to(drive), to(joint)):
        raise ComputationError(
            "The legs cannot carry the payload: a pose of the path is singular",
            next_step="Check the path for singular poses and change the layout or the motion",
        )
    return {"drive_force": drive, "joint_force": joint}


def to(array: NDArray[Any]) -> c_void_p:
    """Address of an array that C fills."""
    return c_void_p(array.ctypes.data)
