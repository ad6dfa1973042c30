"""Mounts on which base and platform stand, and motion of the base."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from flexapod.common.errors import InputError
from flexapod.common.tables.base import FileKey, Key, Loss, Matrix3, Matrix6, Quantity, Series, Series6, Vec3
from flexapod.common.tables.csv_tables import POSE
from flexapod.common.tables.named_files import Content, columns_of_table
from flexapod.common.tables.table import Place, Table
from flexapod.model.leg.spring import check_lossy
from flexapod.model.motion import check_times

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

BASE_ACCELERATION = {
    axis: "acceleration" if dimension == "length" else "angular acceleration" for axis, dimension in POSE.items()
}
_UNITS = {
    "stiffness": ("stiffness", "force", "rotational stiffness"),
    "damping": ("damping", "impulse", "rotational damping"),
}

ORIGIN = np.zeros(3)
LEVEL = 1e-9  # of the largest number of a matrix, by which it may miss being one of a spring


class Mount(Table):
    """Springs between a plate and what it stands on, along and about the axes through a point.

    `at` (3,) [m]: of the base from the origin of the world, of the platform from that of the platform frame; there is
    the plate's centre of mass as well. `stiffness` (6, 6) [N/m, N, N m/rad], displacements first, along world axes at
    the base and platform axes at the platform; `damping` (6, 6) [N s/m, N s, N m s/rad] or `loss`, a loss factor;
    `mass` [kg] and `inertia` (3, 3) [kg m^2] of the plate with the joints.
    """

    placed: ClassVar[tuple[str, ...]] = ("at",)

    at: Annotated[Vec3, Quantity("length")] = Field(default=ORIGIN, validate_default=True)
    stiffness: Annotated[Matrix6, Quantity("stiffness", "force", "rotational stiffness")]
    damping: Annotated[
        Matrix6 | None,
        Quantity("damping", "rotational damping", why="dampers beside the springs, likewise", usual="none"),
    ] = None
    loss: Annotated[
        Loss | None, Key("loss factor, in place of damping; made viscous at the first frequency at home", usual="none")
    ] = None
    mass: Annotated[float, Quantity("mass", least=0)] = 0.0
    inertia: Annotated[
        Matrix3, Quantity("inertia", why="of that plate about `at`: three numbers, or three rows", usual="none")
    ] = Field(default=np.zeros((3, 3)), validate_default=True)

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Springs, dampers and inertia by six or three numbers, or by rows."""
        section.require_keys("stiffness")
        found = {name: section.matrix(name, *_UNITS[name]) for name in _UNITS if name in section}
        return found | {"inertia": section.matrix("inertia", "inertia")}

    @model_validator(mode="after")
    def _sensible(self) -> Mount:
        check_lossy(self)
        _of_a_spring(self.stiffness, "stiffness", least=1e-15, words="positive")
        if self.damping is not None:
            _of_a_spring(self.damping, "damping", least=-LEVEL, words="not negative")
        size, moments = np.abs(self.inertia).max(), np.linalg.eigvalsh(self.inertia)
        if (
            np.abs(self.inertia - self.inertia.T).max() > LEVEL * size
            or min(moments[0], moments[0] + moments[1] - moments[2]) < -1e-9 * size
        ):
            raise InputError(
                "is of no body",
                key="inertia",
                value=self.inertia.tolist(),
                allowed="a symmetric matrix, not negative, no principal moment above the sum of the other two",
            )
        return self


def _of_a_spring(matrix: Matrix6, key: str, least: float, words: str) -> None:
    """Refuse what is not symmetric or has eigenvalues, once scaled to a unit diagonal, below the least."""
    scale = np.sqrt(np.maximum(np.abs(np.diag(matrix)), 1e-300))
    scaled = matrix / scale[:, None] / scale
    if np.diag(matrix).min() < 0 or np.abs(scaled - scaled.T).max() > LEVEL or np.linalg.eigvalsh(scaled)[0] < least:
        raise InputError(
            "is of no mount",
            key=key,
            value=np.diag(matrix).tolist(),
            allowed=f"six numbers or a symmetric 6x6 matrix, {words}",
            next_step="A direction that does not give way takes a large number" if key == "stiffness" else None,
        )


class BaseMotion(Table):
    """Motion of the base, or of the floor under its mount, from t = 0 on: a table from `file`.

    `time` (n,) [s], from 0; `values` (n, 6): along x, y, z of the world and roll, pitch, yaw about them through the
    point `at` (3,) [m]; as `of` says displacements [m, rad] or their second derivatives [m/s^2, rad/s^2].
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "values")
    placed: ClassVar[tuple[str, ...]] = ("at",)

    file: Annotated[str | None, FileKey("CSV file over time, relative to this file")] = None
    of: Annotated[Literal["acceleration", "displacement"], Key("what the table holds")] = "acceleration"
    at: Annotated[Vec3, Quantity("length", why="point about which roll, pitch and yaw turn the base, world axes")] = (
        Field(default=ORIGIN, validate_default=True)
    )
    time: Annotated[Series, Quantity("time")]
    values: Annotated[Series6, Quantity("acceleration", "length", "angle")]

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Columns of its table."""
        of = section.text("of", ("acceleration", "displacement")) or "acceleration"
        found = section.table(BASE_ACCELERATION if of == "acceleration" else POSE, jumps=of == "acceleration")
        none = np.zeros(len(found["time"]))
        return {"of": of, "time": found["time"], "values": np.stack([found.get(axis, none) for axis in POSE], axis=1)}

    def file_content(self, place: Place) -> Content:
        """Accelerations or displacements."""
        return columns_of_table(BASE_ACCELERATION if self.of == "acceleration" else POSE, self.time, self.values)

    @model_validator(mode="after")
    def _table(self) -> BaseMotion:
        check_times(self.time, len(self.values), jumps=self.of == "acceleration")
        if self.of == "displacement" and self.values[0].any():
            raise InputError(
                "does not start where the base is drawn",
                key="values",
                value=self.values[0].tolist(),
                allowed="zeros in the first row",
                next_step="Subtract the first row from all",
            )
        return self
