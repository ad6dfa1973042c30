"""A study: what is analysed and how, one file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Self

from pydantic import field_validator, model_validator

from flexapod.common.errors import InputError, check_kind
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.tables.axes import plane_order
from flexapod.common.tables.table import Table, to_plain_data
from flexapod.common.tables.toml import toml_text
from flexapod.model.laws import Load
from flexapod.model.leg.actuator import Actuator, ActuatorInitial, ActuatorLoad, ActuatorMotion
from flexapod.model.motion import AXES, Motion, moved_axes
from flexapod.model.study.control import Control, ToolControl
from flexapod.model.study.disturbance import Disturbance
from flexapod.model.study.remarks import actuator_remarks, robot_remarks, settings_remarks
from flexapod.model.study.requirement import Requirement
from flexapod.model.study.robot import Robot
from flexapod.model.study.simulation import FIDELITIES, OWN_BASIS, SOLID, Initial, Simulation

#: The load that drives a motion of the single actuator where no law does.
DRIVEN_BY = {"rotation": "torque", "extension": "force", "elevation": "elevation_torque"}
_OUT_OF_PLANE = {
    "motion": ("elevation",),
    "load": ("elevation_torque", "wrench", "follow"),
    "initial": ("elevation_displacement", "elevation_rate"),
}

_variants = LazyModule("flexapod.model.file.variants")  # reads what is written here
_ANEW = "-"  # for the text of a study that is to be written


class _Documented(Table):
    """Keeps `source_text` true: it is written anew when content is changed or the study was not read from text."""

    untold: ClassVar[tuple[str, ...]] = ("source_text", "path", "notes")
    spells: ClassVar[Mapping[str, tuple[str, ...]]] = {
        **{name: ("robot",) for name in ("payload", "leg", "geometry", "heat", "tolerances")},
        "motion": ("motion", "robot"),
    }

    source_text: str = ""
    path: str | None = None
    notes: tuple[str, ...] = ()

    @field_validator("simulation", check_fields=False)
    @classmethod
    def _default_basis(cls, simulation: Simulation) -> Simulation:
        """An unused basis is the default one, since the text does not name it."""
        if simulation.fidelity not in OWN_BASIS:
            return simulation
        return simulation.with_unused_basis(cls.model_fields["simulation"].default.basis)

    def _shown(self) -> dict[str, str]:
        """File, and what each part shows; nothing of parts at their defaults."""
        fields = type(self).model_fields
        parts = {name: getattr(self, name) for name in fields if name not in _Documented.model_fields}
        given = {name: part for name, part in parts.items() if part != fields[name].default}
        words = {
            name: ", ".join(f"{key} {value}" for key, value in part._shown().items()) for name, part in given.items()
        }
        return ({} if self.path is None else {"file": self.path}) | words

    @model_validator(mode="after")
    def _write(self) -> Self:
        if not self.source_text:
            object.__setattr__(self, "source_text", to_toml(self))
        return self

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed, validated again, and its text written anew."""
        if all(getattr(self, name, None) == value for name, value in changes.items()):
            return super().replace(**changes)
        changed = super().replace(**({"source_text": _ANEW, "notes": ()} | changes))
        if changed.source_text == _ANEW:  # with what the text of the parts that stay was
            object.__setattr__(changed, "source_text", to_toml(changed))
        return changed

    def with_values(self, values: Mapping[str, object]) -> Self:
        """Read the study again with other values at some keys of its file; all that follows from them follows.

        Parameters
        ----------
        values : Mapping
            Values by key path, as the file would hold them: ``{"leg.piston.diameter": "70 mm"}``, numbers in SI; a key
            without the number of a leg means all legs, ``"leg[3].piston.diameter"`` one. Whole tables too:
            ``{"motion": {"type": "heave", "amplitude": "5 mm", "duration": "1 s"}}``.

        Returns
        -------
        Study or ActuatorStudy
            Its `source_text` is the file with these values in it, comments kept; files that it names are found as
            before.

        Raises
        ------
        InputError
            No such key or item, a value that is not allowed there, or two keys of which one holds the other.

        Examples
        --------
        >>> fx.preset("paper-robot").with_values({"payload.mass": "50 kg"}).robot.payload.mass
        50.0
        """
        return _variants.with_values(self, values)


class Study(_Documented):
    """A robot, its motion, load, start and simulation settings, what shakes it and what damps it.

    `source_text`: the whole study as TOML, the file as it was read or, where it was built or changed in Python, written
    anew; `path`: where it was read; `notes`: remarks made on reading it.

    Examples
    --------
    >>> fx.preset("paper-robot").simulation.replace(fidelity="lumped").fidelity
    'lumped'
    """

    robot: Robot
    motion: Motion
    load: Load = Load()
    initial: Initial = Initial()
    simulation: Simulation = Simulation()
    disturbance: Disturbance | None = None
    control: Control | None = None
    requirement: Requirement | None = None

    @model_validator(mode="after")
    def _disturbance(self) -> Self:
        if self.disturbance is not None:
            self.disturbance.check(self.robot.count)
        return self

    @model_validator(mode="after")
    def _required(self) -> Self:
        if self.requirement is not None:
            self.requirement.check(self.robot)
        return self

    @model_validator(mode="after")
    def _controlled(self) -> Self:
        held = [i for i, leg in enumerate(self.robot.legs, start=1) if leg.driven and leg.drive.holds]
        if self.control is not None and held:
            raise InputError(
                f"moves the drives, and that of leg {held[0]} keeps its command whatever the force",
                key="control",
                allowed="drives that are servos or forces",
                next_step='Give leg.drive type = "servo" with a stiffness, or leave [control] out',
            )
        if isinstance(self.control, ToolControl):
            self.control.check(self.robot, self.motion)
        return self

    @model_validator(mode="after")
    def _basis(self) -> Self:
        if self.simulation.basis == "tip-mass":
            raise InputError(
                "belongs to the single actuator: a robot's legs carry no mass of their own at the tip",
                key="simulation.basis",
                value="tip-mass",
                allowed="tip-load, clamped-free",
            )
        return self

    @model_validator(mode="after")
    def _motion_of_the_robot(self) -> Self:
        moved, plane, free = moved_axes(self.motion), self.robot.plane, self.motion.independent
        allowed: dict[str, Sequence[str]] = {} if free is None else {"that motion.independent does not name": free}
        if plane is not None:
            first, second, normal = plane_order(plane)
            allowed[f"out of the plane {plane}"] = (AXES[first], AXES[second], AXES[3 + normal])
        if self.robot.platform_fixed:
            allowed = {"of a platform that is fixed": ()}
        for words, axes in allowed.items():
            if wrong := [axis for axis in (*moved, *(free or ())) if axis not in axes]:
                raise InputError(
                    f"asks for {wrong[0]}, a motion {words}",
                    key="motion.type",
                    allowed=", ".join(axes) or "no motion: leave it out",
                )
        return self

    @model_validator(mode="after")
    def _load_that_acts(self) -> Self:
        if self.robot.platform_fixed and self.load.wrench is not None:
            raise InputError(
                "acts on a platform that is fixed: nothing feels it",
                key="load.wrench",
                allowed="a platform that the legs carry",
                next_step="Leave it out, or robot.platform.fixed",
            )
        return self

    @model_validator(mode="after")
    def _sections(self) -> Self:
        pistons = [leg.piston for leg in self.robot.legs] if self.simulation.lateral_shapes else []
        several = any(piston.sections for piston in pistons)
        if (several or any(piston.shear for piston in pistons)) and self.simulation.lateral_basis != "tip-load":
            name = "fidelity" if self.simulation.lateral_basis in OWN_BASIS.values() else "basis"
            raise InputError(
                f"does not know pistons {'of several sections' if several else 'that shear'}",
                key=f"simulation.{name}", value=getattr(self.simulation, name),
                allowed='rigid, lumped, or assumed-modes with basis = "tip-load"',
            )  # fmt: skip
        return self

    @model_validator(mode="after")
    def _solid(self) -> Self:
        sections = {(leg.piston.diameter, leg.piston.inner_diameter) for leg in self.robot.legs}
        if self.simulation.fidelity == SOLID and (len(sections) > 1 or None in {outer for outer, _ in sections}):
            raise InputError(
                "takes legs whose pistons are alike and given by their diameter: one solid piston is reduced for all",
                key="simulation.fidelity",
                value=SOLID,
                allowed=", ".join(name for name in FIDELITIES if name != SOLID) + " for other legs",
                next_step='Choose "beam-fem" or "assumed-modes", or give leg.piston.diameter',
            )
        return self

    @property
    def duration(self) -> float:
        """Simulated time [s]: `simulation.duration`, else the motion with its hold."""
        return self.simulation.duration or self.motion.end_time

    @property
    def warnings(self) -> tuple[str, ...]:
        """Remarks on what is legal but doubtful."""
        return (
            *robot_remarks(self.robot),
            *settings_remarks(self.robot, self.simulation),
            *self.simulation.unused_keys,
            *self.notes,
        )


class ActuatorStudy(_Documented):
    """A single actuator, its motion or load, start and simulation settings.

    Examples
    --------
    >>> fx.preset("paper-actuator").actuator.EI  # N m^2
    756.65
    """

    actuator: Actuator
    motion: ActuatorMotion = ActuatorMotion()
    load: ActuatorLoad = ActuatorLoad()
    initial: ActuatorInitial = ActuatorInitial()
    simulation: Simulation = Simulation(basis="clamped-free")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        self._nothing_out_of_the_plane()
        for law, load in DRIVEN_BY.items():
            if (getattr(self.motion, law) is None) == (getattr(self.load, load) is None):
                raise InputError(f"and motion.{law}: exactly one of the two drives this coordinate", key=f"load.{load}")
        self._only_free_ones_start_with_a_rate()
        for key, none in (("friction", "sliding"), ("play", "static")):
            if getattr(self.simulation, key) != none:
                raise InputError(
                    "has no meaning for a single actuator: nothing in it rubs or has play",
                    key=f"simulation.{key}",
                    value=getattr(self.simulation, key),
                    allowed=none,
                    next_step="Leave it out",
                )
        if self.simulation.fidelity == "lumped" and self.actuator.EA is None:
            raise InputError(
                "has no meaning for a single actuator whose beam bends but does not stretch",
                key="simulation.fidelity",
                value="lumped",
                allowed=", ".join(name for name in FIDELITIES if name != "lumped"),
            )
        if self.simulation.fidelity == SOLID and self.actuator.section is None:
            raise InputError(
                "needs the section of the beam",
                key="simulation.fidelity",
                value=SOLID,
                allowed="beams with a section",
                next_step="Give actuator.section and material in place of EI and rhoA",
            )
        if self.simulation.duration is None and self.motion.end_time is None:
            raise InputError(
                "is missing: this motion has no end of its own",
                key="simulation.duration",
                next_step='Add duration = "10 s" to [simulation]',
            )
        return self

    def _nothing_out_of_the_plane(self) -> None:
        """Refuse what moves or loads a planar actuator out of its plane."""
        for table, names in _OUT_OF_PLANE.items() if not self.actuator.space else ():
            part = getattr(self, table)
            for name in names:
                if getattr(part, name) != type(part).model_fields[name].default:
                    raise InputError(
                        "leads out of the plane in which this actuator moves",
                        key=f"{table}.{name}",
                        allowed="actuators in space",
                        next_step="Add space = true to [actuator], or leave it out",
                    )

    def _only_free_ones_start_with_a_rate(self) -> None:
        rates = {"rotation": "angle_rate", "extension": "length_rate", "elevation": "elevation_rate"}
        for law, name in rates.items():
            load = DRIVEN_BY[law]
            if getattr(self.initial, name) and getattr(self.motion, law) is not None:
                raise InputError(
                    f"starts a coordinate whose motion is prescribed (motion.{law})",
                    key=f"initial.{name}",
                    value=getattr(self.initial, name),
                    allowed="coordinates that a load drives",
                    next_step=f"For free motion write [load] {load} = 0 in place of motion.{law}",
                )

    @property
    def duration(self) -> float:
        """Simulated time [s]: `simulation.duration`, else when the last law has reached its end."""
        return self.simulation.duration or self.motion.end_time or 0.0

    @property
    def warnings(self) -> tuple[str, ...]:
        """Remarks on what is legal but doubtful."""
        basis = self.simulation.lateral_basis if self.simulation.lateral_shapes else None
        return (*actuator_remarks(self.actuator, basis), *self._ignored, *self.simulation.unused_keys, *self.notes)

    @property
    def _ignored(self) -> tuple[str, ...]:
        given = {name: getattr(self.initial, name) for name in ("tip_displacement", "elevation_displacement")}
        bent = {} if self.simulation.lateral_shapes else given
        return tuple(
            f"initial.{key} = {value:g} m has no effect on a rigid beam" for key, value in bent.items() if value
        )


def to_toml(study: Table) -> str:
    """The study as TOML text; read again, it is the same study.

    What was read from a text and not changed since stands there as it was written, key by key; all else in SI units,
    numbers to the last digit. Tables stay in the CSV files they came from; of one given in Python the name is "", which
    is refused when the text is read: results of a study hold its tables (`flexapod.load`).

    Parameters
    ----------
    study : Study or ActuatorStudy

    Returns
    -------
    str
        The text, its tables one after the other.
    """
    check_kind(study, Table, "study", "a study")
    return "# Written by flexapod\n" + toml_text(_tables(study))


def _tables(study: Table) -> dict[str, Any]:
    if study.source_table is not None and not study.source_table.changed:
        return dict(study.source_table.data)
    found: dict[str, object] = {}
    for name in type(study).model_fields:
        part = getattr(study, name)
        found |= part.tables() if isinstance(part, Robot) else {name: part} if isinstance(part, Table) else {}
    tables = {name: to_plain_data(part) for name, part in study.data(found).items()}
    return {name: table for name, table in tables.items() if table}
