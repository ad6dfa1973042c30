"""Settings of a computation: fidelity, basis, time, tolerance; and how it starts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from flexapod.common.errors import InputError, check_known
from flexapod.common.quantities import number, text
from flexapod.common.tables.base import Key, Quantity
from flexapod.common.tables.table import Table

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

FIDELITIES = ("rigid", "lumped", "finite-segment", "assumed-modes", "beam-fem", "solid-fem")
SOLID = "solid-fem"  # the fidelity that needs a section
STRAIGHT = ("rigid", "lumped")  # fidelities without lateral shapes
# Fidelities that leave no choice of basis
OWN_BASIS = {"finite-segment": "segments", "beam-fem": "hermite", "solid-fem": "solid"}
DEFAULT_TOLERANCE = 1e-4
MOST_SHAPES = 12  # of a lateral plane; higher ones follow no excitation that a beam model describes
MOST_ELEMENT_SHAPES = 24  # of `beam-fem`: twelve elements, for differences of 0.1 % in long runs


class Initial(Table):
    """Start of a robot: `equilibrium` (static, at rest), `straight` (undeformed) or `moving` (rigid velocity field)."""

    start: Annotated[Literal["equilibrium", "straight", "moving"], Key("how the robot starts")] = "equilibrium"


class Simulation(Table):
    """Settings of a simulation.

    `fidelity`; `basis` of `assumed-modes`; `modes`, the lateral shapes per plane (of `finite-segment` one per segment,
    of `beam-fem` two per element, of `solid-fem` those of the reduced solid piston);
    `duration` [s] (None: the motion with its hold);
    `tolerance` (relative, of the step control) or fixed `step` [s]; `output_step` [s]; `rho_inf`, spectral radius of
    the integrator of fixed steps at infinite frequency; `friction` about rest, in modes and stiffness: what rubs
    slides, or sticks; `play`: left to `flexapod.play`, or a gap in the motion.
    """

    placed: ClassVar[tuple[str, ...]] = ("basis",)
    silent: ClassVar[tuple[str, ...]] = ("friction",)

    fidelity: Annotated[str, Key("what the legs can do: docs/ladder.md")] = "assumed-modes"
    basis: Annotated[Literal["tip-load", "clamped-free", "tip-mass"], Key("shapes of assumed-modes")] = "tip-load"
    modes: Annotated[int, Key("lateral shapes a plane; of beam-fem two an element")] = Field(
        default=3, strict=True, ge=0, le=MOST_ELEMENT_SHAPES
    )
    duration: Annotated[
        float | None, Quantity("time", above=0, why="simulated time", usual="the motion with its hold")
    ] = None
    tolerance: Annotated[
        float | None,
        Quantity(
            "number",
            above=0,
            below=1,
            why="relative error of the deviation by the step control; forces have an estimate of their own",
        ),
    ] = None
    step: Annotated[float | None, Quantity("time", above=0, why="fixed time step", usual="chosen by tolerance")] = None
    output_step: Annotated[float, Quantity("time", above=0, why="time between stored results")] = 1e-3
    rho_inf: Annotated[
        float,
        Key(
            "spectral radius of the integrator of fixed steps at infinite frequency: 1 damps nothing, 0 most; "
            "not used within a tolerance"
        ),
    ] = Field(default=0.9, strict=True, ge=0, le=1)
    friction: Annotated[
        Literal["sliding", "stuck"],
        Key("what modes and stiffness take joints and drives with friction to do: slide, or stick as springs"),
    ] = "sliding"
    play: Annotated[
        Literal["static", "gap"],
        Key(
            "static: play is left to `flexapod.play` and the budget; gap: in motions it is a gap with rounded "
            "edges in the springs before the piston, that of both joints and of the drive together"
        ),
    ] = "static"

    def __init__(self, **fields: object) -> None:
        if hint := own_fidelity(fields.get("basis")):
            raise InputError(
                "is the basis of a fidelity",
                key="basis",
                value=fields["basis"],
                allowed="tip-load, clamped-free, tip-mass",
                next_step=hint,
            )
        if "basis" in fields and isinstance(fields.get("fidelity"), str) and fields["fidelity"] in OWN_BASIS:
            raise InputError(
                f"has no effect with fidelity {fields['fidelity']!r}, which has a basis of its own",
                key="basis",
                value=fields["basis"],
                next_step="Leave basis out",
            )
        super().__init__(**fields)

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """A tolerance, where steps are not fixed and none is given."""
        chosen = fields.get("tolerance") is None and fields.get("step") is None
        return {"tolerance": DEFAULT_TOLERANCE} if chosen else {}

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed; a basis that its fidelity does not use is kept for one that does."""
        if "step" in changes and "tolerance" not in self._given:
            changes = {"tolerance": None, **changes}
        fidelity = changes.get("fidelity", self.fidelity)
        if "basis" in changes or not isinstance(fidelity, str) or fidelity not in OWN_BASIS:
            return super().replace(**changes)
        fields = {name: value for name, value in {**self._given, **changes}.items() if name != "basis"}
        return self._kept_in(type(self)(**fields).with_unused_basis(self.basis))

    def _shown(self) -> dict[str, str]:
        shapes = {"modes": f"{self.modes} a plane"} if self.lateral_shapes else {}
        time = {"step": text(self.step, "s", 4)} if self.step is not None else {"tolerance": f"{self.tolerance:g}"}
        until = {} if self.duration is None else {"duration": f"{number(self.duration, 4)} s"}
        return {"fidelity": self.fidelity, **shapes, **time, "output step": text(self.output_step, "s", 4), **until}

    def with_unused_basis(self, basis: str) -> Self:
        """The same settings with the `basis` that another fidelity would use."""
        copy = self.model_copy()
        object.__setattr__(copy, "basis", basis)
        copy.model_fields_set.add("basis")
        return copy if self.source_table is None else copy.attach_source(self.source_table)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_fidelity(self.fidelity)
        if self.tolerance is not None and self.step is not None:
            raise InputError(
                "is given together with tolerance",
                key="step",
                value=self.step,
                allowed="tolerance (steps are chosen) or step (fixed), not both",
            )
        self._check_modes()
        return self

    def _check_modes(self) -> None:
        if self.fidelity not in STRAIGHT and self.modes == 0:
            raise InputError(
                f"leaves no lateral shape for {self.fidelity!r}",
                key="modes",
                value=0,
                allowed=f"1 to {MOST_SHAPES}",
                next_step='Choose fidelity = "lumped" for legs that only stretch, "rigid" for a straight beam',
            )
        if self.fidelity != "beam-fem" and self.modes > MOST_SHAPES:
            raise InputError(
                f"is more than {self.fidelity!r} takes",
                key="modes",
                value=self.modes,
                allowed=f"1 to {MOST_SHAPES}",
                next_step=f'fidelity = "beam-fem" takes up to {MOST_ELEMENT_SHAPES}: two shapes per element',
            )
        if self.fidelity == "beam-fem" and self.modes % 2:
            raise InputError(
                "is not a whole number of beam elements: 'beam-fem' has two shapes per element and plane",
                key="modes",
                value=self.modes,
                allowed=f"2, 4, 6 ... {MOST_ELEMENT_SHAPES}",
                next_step=f"Give modes = {self.modes + 1}",
            )

    @property
    def unused_keys(self) -> tuple[str, ...]:
        """Words for those of the settings that have no effect."""
        if self.tolerance is None or self.rho_inf == type(self).model_fields["rho_inf"].default:
            return ()
        return (
            f"simulation.rho_inf = {self.rho_inf:g} is of fixed steps (simulation.step): within a tolerance compiled "
            "runs do not use it",
        )

    @property
    def lateral_basis(self) -> str:
        """Name of the lateral basis that the fidelity uses."""
        return OWN_BASIS.get(self.fidelity, self.basis)

    @property
    def lateral_shapes(self) -> int:
        """Shapes per lateral plane that the fidelity uses: `modes`, or 0 for rigid and lumped legs."""
        return 0 if self.fidelity in STRAIGHT else self.modes

    def axial_shapes(self, axial_modes: int) -> int:
        """Axial shapes of a leg that the fidelity uses, of the `axial_modes` of its table."""
        return {"rigid": 0, "lumped": 1}.get(self.fidelity, axial_modes)

    @property
    def stored_step(self) -> float:
        """Time between stored results [s]: `output_step`, or a fixed `step` longer than it."""
        return max(self.output_step, self.step or 0.0)

    def outputs(self, duration: float) -> int:
        """Number of intervals between stored results in `duration` [s]; a rest shorter than one is left out."""
        return math.floor(duration / self.stored_step + 1e-6)

    def si_values(self) -> dict[str, object]:
        """All that it has to say in a file: no basis that its fidelity does not use."""
        unused = ("basis",) if self.fidelity in OWN_BASIS else ()
        return {name: value for name, value in super().si_values().items() if name not in unused}


def own_fidelity(basis: object) -> str | None:
    """Advice on a `basis` that is chosen as a fidelity; None for others."""
    found = [fidelity for fidelity, own in OWN_BASIS.items() if isinstance(basis, str) and own == basis]
    return f'Choose fidelity = "{found[0]}" instead' if found else None


def check_fidelity(fidelity: str) -> None:
    """Refuse a fidelity that does not exist."""
    check_known(fidelity, FIDELITIES, "fidelity")


def read_simulation(section: Section | None, *, basis: str, bases: tuple[str, ...]) -> Simulation:
    """The simulation settings; `basis` is the default and `bases` are the allowed ones."""
    if section is None:
        return Simulation(basis=basis)

    def choices(section: Section) -> dict[str, object]:
        fidelity = section.text("fidelity", FIDELITIES)
        return {
            "fidelity": fidelity,
            "basis": _basis(section, bases) or (None if fidelity in OWN_BASIS else basis),
        }

    return section.read(Simulation, then=choices)


def _basis(section: Section, bases: tuple[str, ...]) -> str | None:
    if hint := own_fidelity(section.data.get("basis")):
        raise section.error("is the basis of a fidelity", "basis", allowed=", ".join(bases), next_step=hint)
    return section.text("basis", bases)


def unused_settings(section: Section | None, simulation: Simulation) -> tuple[str, ...]:
    """Notes on settings of the file that the chosen fidelity does not use."""
    if section is None or simulation.fidelity not in STRAIGHT:
        return ()
    return tuple(
        f"simulation.{name} = {section.data[name]!r} has no effect with fidelity {simulation.fidelity!r}"
        for name in ("modes", "basis")
        if name in section
    )
