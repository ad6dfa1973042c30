"""Disturbances that shake a robot at rest: one-sided power spectral densities of floor, wrench and drives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeVar

import numpy as np
from pydantic import PlainSerializer, PlainValidator, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.base import FileKey, Key, Quantity, Series, array_of
from flexapod.common.tables.csv_tables import WRENCH
from flexapod.common.tables.named_files import Content, columns_of_table
from flexapod.common.tables.table import Place, Table

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section
    from flexapod.model.study.robot import Robot

Curve = Literal["VC-A", "VC-B", "VC-C", "VC-D", "VC-E", "VC-F", "VC-G"]
#: Nominal rms velocity in a third of an octave [m/s]: each half of the one before it. Amick, Gendreau, Busch & Gordon,
#: Evolving criteria for research facilities: I. Vibration (Proc. SPIE 5933, 2005).
CURVES: dict[str, float] = {f"VC-{name}": 50e-6 / 2**k for k, name in enumerate("ABCDEFG")}
THIRD = 2 ** (1 / 6) - 2 ** (-1 / 6)  # width of such a band over its middle, (T18.12)
Densities = Annotated[Array, PlainValidator(array_of((None, None))), PlainSerializer(lambda rows: rows.tolist())]

M = TypeVar("M", bound=Table)
KINDS = ("acceleration", "velocity", "displacement")
FLOOR = {kind: dict.fromkeys("xyz", f"{kind} spectrum") for kind in KINDS}
WRENCH_NOISE = {name: f"{dimension} spectrum" for name, dimension in WRENCH.items()}
FORCE_NOISE = {"force": "force spectrum"}


class Spectrum(Table):
    """A one-sided power spectral density over `frequency` (m,) [Hz], its columns `density` (m, any) [unit^2/Hz].

    Between the rows straight lines in logarithms of both, or in the numbers themselves where one end is 0; outside of
    them nothing. `spectrum`: the file of the table.
    """

    derived: ClassVar[tuple[str, ...]] = ("frequency", "density")
    spectrum: Annotated[str | None, FileKey("CSV file, relative to this file")] = None
    frequency: Annotated[Series, Quantity("frequency")]
    density: Annotated[Densities, Quantity("force spectrum", "torque spectrum")]

    def si_values(self) -> dict[str, object]:
        """All that it has to say in a file."""
        return {"spectrum": self.spectrum or ""}

    def file_content(self, place: Place) -> Content:
        """Densities, of the wrench at the tool, of all drives, or of each."""
        count = self.density.shape[1]
        if place.key.endswith("wrench"):
            return columns_of_table(WRENCH_NOISE, self.frequency, self.density, "frequency")
        each = {f"leg {i}": f"{place.force(i)} spectrum" for i in range(1, count + 1)}
        columns = {"force": each["leg 1"]} if count == 1 else each
        return columns_of_table(columns, self.frequency, self.density, "frequency")

    @model_validator(mode="after")
    def _table(self) -> Spectrum:
        check_density(self.frequency, self.density)
        return self


class Floor(Table):
    """Motion of the floor along x, y, z, each by itself: a `curve`, which all third-octave bands reach, or a spectrum.

    `of`: what `density` (m, 3) is the spectrum of [m/s^2, m/s or m, squared, per Hz]; the rest as of `Spectrum`.
    """

    derived: ClassVar[tuple[str, ...]] = ("frequency", "density")
    _source: ClassVar[str] = "the curve"
    curve: Annotated[Curve | None, Key("generic vibration criterion")] = None
    spectrum: Annotated[str | None, FileKey("CSV file, relative to this file")] = None
    of: Annotated[Literal["acceleration", "velocity", "displacement"], Key("what `spectrum` is the density of")] = (
        "acceleration"
    )
    frequency: Annotated[Series, Quantity("frequency")]
    density: Annotated[Densities, Quantity("acceleration spectrum", "velocity spectrum", "displacement spectrum")]

    def si_values(self) -> dict[str, object]:
        """All that it has to say in a file."""
        if self.curve is not None:
            return {"curve": self.curve}  # the rest follows
        return {"spectrum": self.spectrum or "", "of": self.of}

    def file_content(self, place: Place) -> Content:
        """Densities along x, y, z; nothing of a curve."""
        if self.curve is not None:
            return {}
        return columns_of_table(FLOOR[self.of], self.frequency, self.density, "frequency")

    @model_validator(mode="after")
    def _table(self) -> Floor:
        check_density(self.frequency, self.density)
        if self.density.shape[1] != 3:
            raise InputError("has not a column for each of x, y, z", key="density", value=self.density.shape[1])
        return self

    @classmethod
    def by_curve(cls, curve: str) -> Floor:
        """A floor whose velocity reaches a curve in all bands, Eq. (T18.12)."""
        return cls(curve=curve)  # type: ignore[arg-type]

    if TYPE_CHECKING:  # what follows need not be given

        def __init__(self, **fields: Any) -> None: ...

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """Spectrum of a curve."""
        curve = fields.get("curve")
        if curve is None:
            return {}
        if not isinstance(curve, str) or curve not in CURVES:
            raise InputError("is not known", key="curve", value=curve, allowed=", ".join(CURVES))
        v = CURVES[curve]
        if curve in ("VC-A", "VC-B"):  # like constant acceleration below 8 Hz
            f, v = np.array([4.0, 8.0, 80.0]), np.array([2 * v, v, v])
        else:
            f, v = np.array([1.0, 80.0]), np.array([v, v])
        density = np.repeat((v**2 / (THIRD * f))[:, None], 3, axis=1)
        return {"of": "velocity", "frequency": f, "density": density}


class Disturbance(Table):
    """Disturbance of a robot: floor, wrench at the tool, forces of drives.

    `wrench`: columns Fx Fy Fz [N^2/Hz], Mx My Mz [(N m)^2/Hz], world axes; `force_noise` of the drives [N^2/Hz, of
    cranks (N m)^2/Hz]: a column for all or one for each leg.
    """

    floor: Annotated[
        Floor | None, Key("motion of the floor: a table, VC-A to VC-G, or a CSV file of accelerations", short="text")
    ] = None
    wrench: Annotated[Spectrum | None, Key("force and moment at the tool: a table, or a CSV file", short="text")] = None
    force_noise: Annotated[
        Spectrum | None, Key("forces of the drives, each by itself: a table, or a CSV file", short="text")
    ] = None

    def check(self, legs: int) -> None:
        """Raise InputError if a table has not the columns of a robot with so many legs."""
        tables = (("wrench", self.wrench, (6,)), ("force_noise", self.force_noise, (1, legs)))
        for name, table, widths in tables:
            if table is not None and table.density.shape[1] not in widths:
                raise InputError(
                    f"has {table.density.shape[1]} columns",
                    key=f"disturbance.{name}.density",
                    allowed=" or ".join(map(str, sorted(set(widths)))),
                )


def check_density(frequency: Array, density: Array) -> None:
    """Refuse what is not a power spectral density, saying which row."""
    if frequency.ndim != 1 or len(frequency) < 2 or density.ndim != 2 or len(density) != len(frequency):
        raise InputError("has fewer than two rows, or not one for each frequency", key="density")
    rising = np.append(frequency[0] > 0, np.diff(frequency) > 0)
    if not rising.all():
        at = int(np.argmin(rising))
        raise InputError(
            "is not above 0" if at == 0 else f"is not above {frequency[at - 1]:g} Hz, the frequency before it",
            key=f"frequency[{at + 1}]",
            value=float(frequency[at]),
            allowed="frequencies [Hz] above 0 that increase from row to row",
            next_step="Sort the lines by frequency and remove doubles",
        )
    if (wrong := np.argwhere(~((density >= 0) & np.isfinite(density)))).size:
        at, column = wrong[0]
        raise InputError(
            "is negative" if density[at, column] < 0 else "is no finite number",
            key=f"density[{at + 1}][{column + 1}]",
            value=float(density[at, column]),
            allowed="a power spectral density, 0 or more",
            next_step="A table in decibels or of amplitudes is to be converted first",
        )


def read_disturbance(top: Section, robot: Robot) -> Disturbance | None:
    """Disturbance that shakes the robot of a study file."""
    section = top.section("disturbance")
    if section is None:
        return None
    cranks = [leg.carriage is not None and leg.carriage.kind == "crank" for leg in robot.legs]
    drive = [f"{'torque' if crank else 'force'} spectrum" for crank in cranks]
    noise = {f"leg {i}": dimension for i, dimension in enumerate(drive, start=1)}
    noise |= {"force": drive[0]} if len(set(drive)) == 1 else {}
    readers = {
        "floor": _floor,
        "wrench": lambda s: _spectrum(s, Spectrum, WRENCH_NOISE, tuple(WRENCH_NOISE)),
        "force_noise": lambda s: _spectrum(s, Spectrum, noise, tuple(noise)[: len(cranks)]),
    }

    def tables(section: Section) -> dict[str, object]:
        return {name: read(_table(section, name)) for name, read in readers.items() if name in section}

    found = section.read(Disturbance, then=lambda s: dict.fromkeys(readers) | tables(s))
    if found == Disturbance():
        raise InputError("names nothing that shakes", file=top.file, key="disturbance", allowed=", ".join(readers))
    return found


def _table(section: Section, name: str) -> Section:
    """The table under a key; a text stands for its first key."""
    value: Any = section.data[name]
    if isinstance(value, str):
        value = {"curve" if name == "floor" and not value.endswith(".csv") else "spectrum": value}
    return section.child(value, name)


def _floor(section: Section) -> Floor:
    if "curve" not in section:
        of = section.text("of", KINDS) or KINDS[0]
        return _spectrum(section, Floor, FLOOR[of], tuple("xyz"))
    section.check_keys("curve")
    return section.build(Floor.by_curve, curve=section.text("curve", tuple(CURVES)))


def _spectrum(section: Section, model: type[M], columns: dict[str, str], names: tuple[str, ...]) -> M:
    def table(section: Section) -> dict[str, object]:
        found = section.table(columns, name="spectrum", along="frequency")
        frequency = found.pop("frequency")
        if "force" in found and len(found) > 1:
            raise section.error("has 'force' and columns of single legs", "spectrum", allowed="either of the two")
        shown = ("force",) if "force" in found else names
        density: Array = np.column_stack([found.get(name, np.zeros_like(frequency)) for name in shown])
        try:
            check_density(frequency, density)
        except InputError as error:
            raise error.with_location(file=section.files.folder / str(section.text("spectrum"))) from None
        return {"frequency": frequency, "density": density}

    return section.read(model, then=table)
