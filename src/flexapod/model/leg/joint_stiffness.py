"""Stiffness of a joint, written as a table: along and across the leg, or in rows, with what damps it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.tables.base import Key, Loss, Matrix6, Quantity
from flexapod.common.tables.table import Table
from flexapod.model.leg.rolling import RollingLaw
from flexapod.model.leg.spring import read_spring

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

_TRANSLATIONS, _FORCES = ("stiffness",) * 3, ("force",) * 3


class AlongLeg(Table):
    """Springs along (`axial`) and across (`radial`) the leg [N/m], with a damper [N s/m] or a loss factor."""

    axial: Annotated[float, Quantity("stiffness", above=0, why="along the leg")]
    radial: Annotated[float, Quantity("stiffness", above=0, why="across the leg")]
    damping: Annotated[float | None, Quantity("damping", least=0, why="along and across the leg")] = None
    loss: Annotated[Loss | None, Key("loss factor, in place of `damping`; left out: that of the joint")] = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Dampers, then springs, each above zero."""
        dampers = _dampers(section)
        section.require_keys("axial", "radial")
        return dampers | {name: read_spring(section, name) for name in ("axial", "radial")}

    @property
    def of_joint(self) -> dict[str, object]:
        """Fields that a joint has of it."""
        along = np.diag([self.radial, self.radial, self.axial, 0.0, 0.0, 0.0])
        return {"stiffness": along, "leg_axes": True, **_damped(self)}


class InRows(Table):
    """Springs along and about the axes of base or platform, `rows` (6, 6) [N/m, N, N m/rad], with what damps them.

    `leg_axes`: the axes are those of the leg, z along it.
    """

    rows: Annotated[Matrix6, Quantity("stiffness", "force", "rotational stiffness")]
    leg_axes: Annotated[
        bool | None,
        Key("true: the rows are along and about the axes of the leg at home, z along it", usual="false"),
    ] = None
    damping: Annotated[float | None, Quantity("damping", least=0, why="along and across the leg")] = None
    loss: Annotated[Loss | None, Key("loss factor, in place of `damping`; left out: that of the joint")] = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Dampers, then rows."""
        return _dampers(section) | {"rows": _rows(section, "rows")}

    @property
    def of_joint(self) -> dict[str, object]:
        """Fields that a joint has of it."""
        return {"stiffness": self.rows, "leg_axes": bool(self.leg_axes), **_damped(self)}


def _damped(spring: AlongLeg | InRows) -> dict[str, object]:
    return {"stiffness_damping": spring.damping, "stiffness_loss": spring.loss}


def read_stiffness(section: Section) -> dict[str, object]:
    """A number, along and across the leg, a law, three or six rows; the latter with dampers as a table."""
    value = section.data.get("stiffness")
    if isinstance(value, list):
        return {"stiffness": _rows(section, "stiffness")}
    if isinstance(value, Mapping):
        inner = section.child(value, "stiffness")
        if "law" in inner:
            return {"rolling": inner.read(RollingLaw)}
        return inner.read(InRows if "rows" in inner else AlongLeg).of_joint
    number = read_spring(section, "stiffness") if "stiffness" in section else section.number("stiffness", "stiffness")
    return {} if number is None else {"stiffness": np.diag([number] * 3 + [0.0] * 3)}


def _dampers(section: Section) -> dict[str, object]:
    if "damping" in section and "loss" in section:
        raise section.error("is given together with loss", "damping", allowed="either of the two")
    return {"damping": section.number("damping", "damping"), "loss": section.number("loss", "number")}


def _rows(section: Section, name: str) -> Array:
    """Three or six rows of a stiffness, (6, 6)."""
    value, found = section.data.get(name), np.zeros((6, 6))
    if isinstance(value, list) and len(value) == 6:
        mixed = (*_FORCES, *("rotational stiffness",) * 3)
        return np.array(section.rows(name, *((*_TRANSLATIONS, *_FORCES),) * 3, *(mixed,) * 3))
    found[:3, :3] = section.rows(name, *(_TRANSLATIONS,) * 3)
    return found
