"""Stiffness of joints on rolling bearings by Schaeffler's law, Eqs. (T15.36)-(T15.38)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from flexapod.common.errors import InputError
from flexapod.common.tables.base import Key, Loss, Quantity
from flexapod.common.tables.table import Table

EXPONENT = 0.84  # of the load, for lines of contact
Series = Literal[
    "NA48", "NA49", "NA69", "NKIS", "NKI", "HK", "BK", "NU10", "NJ2-E", "K811", "K812", "K893", "K894"
]  # fmt: skip
#: K_c by series; those by their width w [mm] and bore d [mm] as a in a w^0.8 / d^0.2.
_FIXED = {
    "NA48": 24.9, "NA49": 23.5, "NA69": 37.3, "NKIS": 21.3, "NU10": 9.5, "NJ2-E": 11.1, "K811": 36.7, "K812": 36.7,
    "K893": 59.7, "K894": 59.7,
}  # fmt: skip
_BY_WIDTH = {"NKI": 4.4, "HK": 4.2, "BK": 4.2}
AXIAL = ("K811", "K812", "K893", "K894")  # thrust bearings: one carries the whole load
LARGEST = 1.0  # bore [m] beyond which no such bearing is made


class RollingLaw(Table):
    """Bearings of a `series` and a `bore` [m] in the yokes of a joint, under the `load` [N] along the leg.

    `yokes`: in series along the leg, 2 of a cross; in each of them two radial bearings share the load, or a thrust
    bearing carries it. `width` [m] of the bearing, of series whose stiffness depends on it. `preload` [N] of thrust
    bearings; `clearance` [m] of radial ones in operation. `of`: the stiffness that small motions about the load feel
    ("tangent"), or load over displacement ("secant"), in which alone a clearance counts. `radial` [N/m]: across the
    leg; left out: as along it. `damping` [N s/m] or a `loss` factor.
    """

    law: Annotated[Literal["rolling"], Key("rolling: of rolling bearings, in place of axial and radial")] = "rolling"
    series: Annotated[Series, Key("of the bearings")]
    bore: Annotated[float, Quantity("length", above=0, most=LARGEST, why="of the bearings")]
    load: Annotated[float, Quantity("force", least=0, why="along the leg, about which the joint gives way")]
    width: Annotated[
        float | None, Quantity("length", above=0, why="of the bearing, of series whose stiffness depends on it")
    ] = None
    preload: Annotated[float | None, Quantity("force", least=0, why="of thrust bearings")] = None
    clearance: Annotated[
        float | None, Quantity("length", least=0, why="of radial bearings in operation; counts for the secant")
    ] = None
    of: Annotated[
        Literal["tangent", "secant"],
        Key("tangent: what small motions about the load feel; secant: load over displacement"),
    ] = "tangent"
    yokes: Annotated[Annotated[int, Field(strict=True, ge=1, le=10)] | None, Key("in series along the leg")] = None
    radial: Annotated[float | None, Quantity("stiffness", above=0, why="across the leg")] = None
    damping: Annotated[float | None, Quantity("damping", least=0, why="along and across the leg")] = None
    loss: Annotated[Loss | None, Key("loss factor, in place of `damping`; left out: that of the joint")] = None

    @model_validator(mode="after")
    def _complete(self) -> RollingLaw:
        if (self.width is None) == (self.series in _BY_WIDTH):
            words = "is missing" if self.width is None else "does not count for this series"
            raise InputError(words, key="width", value=self.width, allowed=f"of {', '.join(_BY_WIDTH)} alone")
        if self.preload and self.series not in AXIAL:
            raise InputError(
                "is that of a thrust bearing", key="preload", value=self.preload, allowed=f"of {', '.join(AXIAL)}"
            )
        if self.clearance and (self.series in AXIAL or self.of == "tangent"):
            raise InputError(
                "does not change the tangent: under load it is closed", key="clearance", value=self.clearance,
                allowed='of radial bearings with of = "secant"', next_step="As free travel of the joint give play",
            )  # fmt: skip
        if not self.load and not (self.preload and self.of == "tangent"):
            raise InputError(
                "leaves the bearings without stiffness", key="load", value=self.load,
                allowed="above 0 N, or with a preload and the tangent",
            )  # fmt: skip
        if self.damping is not None and self.loss is not None:
            raise InputError("is given together with loss", key="damping", allowed="either of the two")
        return self

    @property
    def shift(self) -> float:
        """Displacement along the leg under the load [m], Eq. (T15.37)."""
        each, preload = self.load / self._shared, self.preload or 0.0
        rolls = ((preload + each) ** EXPONENT - preload**EXPONENT) / self._constant
        return self._in_series * (1e-6 * rolls + 0.5 * (self.clearance or 0.0))

    @property
    def k(self) -> float:
        """Stiffness along the leg [N/m], Eqs. (T15.37)-(T15.38)."""
        if self.of == "secant":
            return self.load / self.shift
        pressed = (self.preload or 0.0) + self.load / self._shared
        return 1e6 * self._shared * self._constant * pressed ** (1 - EXPONENT) / (EXPONENT * self._in_series)

    @property
    def _constant(self) -> float:
        """c_s of N^0.84 / um, Eq. (T15.36)."""
        bore = 1e3 * self.bore
        if self.series in _FIXED:
            return _FIXED[self.series] * bore**0.65
        return _BY_WIDTH[self.series] * (1e3 * (self.width or 0.0)) ** 0.8 * bore ** (0.65 - 0.2)

    @property
    def _in_series(self) -> int:
        return self.yokes or (1 if self.series in AXIAL else 2)

    @property
    def _shared(self) -> int:
        """Number of bearings of a yoke that share the load."""
        return 1 if self.series in AXIAL else 2
