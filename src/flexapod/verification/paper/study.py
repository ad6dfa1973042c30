"""The paper's whole study: single actuator, robot, and what its deviation depends on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from xarray import Dataset

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.results.time_history import Report, Share
from flexapod.analysis.simulation import simulate
from flexapod.analysis.solid import simulate_solid
from flexapod.analysis.static import modes
from flexapod.common.arguments import flag
from flexapod.common.errors import ComputationError
from flexapod.verification.paper.claim import axis_motion
from flexapod.verification.paper.computing_time import inverse_dynamics_cost
from flexapod.verification.paper.engines import (
    check_engine,
    exudyn_flexible,
    exudyn_rigid,
    rigid_same_step,
    run_undamped,
)
from flexapod.verification.paper.outlook import (
    commands_ahead,
    error_budget,
    force_feedback,
    joint_friction,
    shaped_roll,
    tolerances,
)
from flexapod.verification.paper.printed_equations import printed_lines
from flexapod.verification.paper.trials import TRIAL_STEP
from flexapod.verification.paper.variants import (
    Variant,
    VariantTable,
    assumptions,
    clamped_legs,
    compare,
    half_angle,
    half_angles,
    light_pistons,
    readings_table,
    tripod,
)

ACTUATOR_MODES = (1, 2, 3, 4, 5)
BEAM_SHAPES = 8  # four beam elements a piston
FREE_TIME = 5.0  # s; set free, the beam leaves its hub soon after
COMPARED_STEP = 1e-4  # s: the time integration's error in 10 s is then about a micrometre, below what is compared
COMPARED_OUTPUT = 1e-2  # s: a fortieth of the first period at the start
# Name, words, usual share of the time, size [m] and kind of the hexahedra: the paper's meshes by the kinds of linear
# elements that it may have taken, and a better one
SOLIDS = (
    ("coarse", "full integration, 50 mm", 1, 0.05, "hex8"),
    ("fine", "full integration, 5 mm", 3, 0.005, "hex8"),
    ("reduced-coarse", "reduced integration, 50 mm", 1, 0.05, "hex8r"),
    ("reduced-fine", "reduced integration, 5 mm", 3, 0.005, "hex8r"),
    ("incompatible-coarse", "incompatible modes, 50 mm", 1, 0.05, "hex8i"),
    ("incompatible-fine", "incompatible modes, 5 mm", 3, 0.005, "hex8i"),
    ("quadratic", "quadratic, 5 mm", 6, 0.005, "hex20"),
)


@dataclass(frozen=True, kw_only=True)
class PaperStudy:
    """Results of `replicate` by name, in the order of `STEPS`.

    `failures`: what went wrong in an independent engine, by the name of the part that is missing for it.
    """

    parts: Mapping[str, Dataset] = field(repr=False)
    failures: Mapping[str, ComputationError] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Dataset:
        return self.parts[name]

    @property
    def actuator(self) -> dict[int, Dataset]:
        """The single actuator by number of shapes."""
        return {k: self.parts[f"actuator-{k}"] for k in ACTUATOR_MODES}


@dataclass(frozen=True)
class StudyPart:
    """A part of the study: name, words, usual share of the time, and how it is computed."""

    name: str
    words: str
    weight: float
    compute: Callable[[Share], Dataset]


def _over(report: Share) -> Callable[[float, float], None]:
    """Progress of one simulation as a share."""
    return lambda time, end: report(time / end)


def _actuator(**settings: Any) -> Callable[[Share], Dataset]:
    return lambda report: simulate_actuator(model.preset("paper-actuator"), **settings, progress=_over(report))


def _free_actuator(report: Share) -> Dataset:
    """The same beam set free on a hub without friction or inertia, with the printed velocities at the start."""
    study, none = model.preset("paper-actuator"), model.ConstantLaw(value=0.0)
    laws = study.motion.rotation, study.motion.extension
    turn, feed = (law.rate if isinstance(law, model.RateLaw) else 0.0 for law in laws)
    free = study.replace(
        motion=model.ActuatorMotion(rotation=None, extension=None),
        load=model.ActuatorLoad(torque=none, force=none),
        initial=study.initial.replace(angle_rate=turn, length_rate=feed),
    )
    return simulate_actuator(free, duration=FREE_TIME, progress=_over(report))


def _solid(size: float, kind: str) -> Callable[[Share], Dataset]:
    settings: Any = {"size": size, "kind": kind, "output_step": COMPARED_OUTPUT}
    return lambda report: simulate_solid(model.preset("paper-actuator"), **settings, progress=_over(report))


def _robot(variant: Callable[[], Variant], **settings: Any) -> Callable[[Share], Dataset]:
    return lambda report: simulate(variant().study, **settings, progress=_over(report))


def _modes(_: Share) -> Dataset:
    study = model.preset("paper-robot")
    return modes(study, axis_motion(study).target)


def _table(variants: Callable[[], VariantTable]) -> Callable[[Share], Dataset]:
    return lambda report: compare(variants(), report)


def _of_preset(compute: Callable[[model.Study, Share], Dataset]) -> Callable[[Share], Dataset]:
    return lambda report: compute(model.preset("paper-robot"), report)


JUMP_STEP = 3.125e-5  # s; an impact rings the legs at kilohertz: peaks within 4 % of those at a quarter of it
_JUMP = {"motion.profile": "linear"}  # at constant rate: the velocity jumps at the start and at the end
_RADII = partial(Variant, preset="paper-robot-radii")
_FINEST = {"step": COMPARED_STEP, "output_step": COMPARED_OUTPUT}
STEPS: tuple[StudyPart, ...] = (
    *(StudyPart(f"actuator-{k}", f"single actuator, {k} shapes", 0.2 * k, _actuator(modes=k)) for k in ACTUATOR_MODES),
    StudyPart("actuator-free", "single actuator, set free", 0.5, _free_actuator),
    StudyPart("actuator-fine", "single actuator, 8 shapes", 3, _actuator(fidelity="assumed-modes", modes=8, **_FINEST)),
    StudyPart(
        "actuator-beam", "single actuator, beam elements", 6, _actuator(fidelity="beam-fem", modes=24, **_FINEST)
    ),
    *(
        StudyPart(f"actuator-solid-{name}", f"solid elements, {words}", weight, _solid(size, kind))
        for name, words, weight, size, kind in SOLIDS
    ),
    StudyPart("printed-lines", "energies as printed", 2, printed_lines),
    StudyPart("robot", "robot with flexible legs", 4, _robot(Variant)),
    StudyPart("robot-rigid", "robot with rigid legs", 0.3, _robot(Variant, fidelity="rigid", step=5e-4)),
    StudyPart("robot-lumped", "robot whose legs only stretch", 0.3, _robot(Variant, fidelity="lumped", step=2.5e-4)),
    StudyPart(
        "robot-fem", "robot whose legs are beam elements", 0.5, _robot(Variant, fidelity="beam-fem", modes=BEAM_SHAPES)
    ),
    StudyPart("modes", "modes at the largest roll", 0.2, _modes),
    StudyPart("robot-radii", "circles read as radii", 4, _robot(_RADII)),
    *(
        StudyPart(name, words, 2, _robot(variant, step=JUMP_STEP))
        for name, words, variant in (
            ("jump", "start with a jump of the velocity", partial(Variant, values=_JUMP)),
            ("jump-radii", "the same, circles read as radii", partial(_RADII, values=_JUMP)),
            ("jump-27", "the same, half-angles of 27 deg", partial(half_angle, "paper-robot", 27.0, **_JUMP)),
        )
    ),
    StudyPart("half-angles", "half-angles of the joints", 4, _table(partial(half_angles, "paper-robot"))),
    StudyPart("half-angles-radii", "half-angles, radii", 4, _table(partial(half_angles, "paper-robot-radii"))),
    StudyPart("assumptions", "other assumptions", 3, assumptions),
    StudyPart("readings", "other readings of the paper", 4, _table(readings_table)),
    StudyPart("tripod", "a tripod of the same pistons", 1, _robot(tripod, step=TRIAL_STEP)),
    StudyPart("light", "lighter pistons", 1, _table(light_pistons)),
    StudyPart("welded", "ball joints that carry moments", 8, _table(clamped_legs)),
    StudyPart("ahead", "commands ahead of time", 4, commands_ahead),
    StudyPart("shaped", "a shaped roll", 2, shaped_roll),
    StudyPart("feedback", "force feedback", 2, force_feedback),
    StudyPart("friction", "friction of the joints", 4, joint_friction),
    StudyPart("tolerances", "tolerances", 0.3, tolerances),
    StudyPart("budget", "error budget", 0.3, error_budget),
    StudyPart("cost", "operations of inverse dynamics", 0.3, inverse_dynamics_cost),
)

#: What an independent engine computes, with our runs at its step.
ENGINE_STEPS: tuple[StudyPart, ...] = (
    StudyPart("robot-rigid-same-step", "rigid legs, step of the engine", 0.3, _of_preset(rigid_same_step)),
    StudyPart("robot-undamped", "flexible legs without damping", 1, _of_preset(run_undamped)),
    StudyPart("robot-exudyn-rigid", "Exudyn, rigid legs", 2, _of_preset(exudyn_rigid)),
    StudyPart("robot-exudyn", "Exudyn, flexible legs", 25, _of_preset(exudyn_flexible)),
)


def replicate(
    *,
    engines: bool = False,
    progress: Report | None = None,
    keep: Callable[[str, Dataset], None] | None = None,
) -> PaperStudy:
    """Compute the paper's whole study with the presets.

    Parameters
    ----------
    engines : bool
        Also with an independent engine, Exudyn: half a minute more.
    progress : callable, optional
        Called with what is being computed, in words, and the share of the whole that is done.
    keep : callable, optional
        Called with name and Dataset of each part as soon as it is done, so that an interrupt loses only the last.

    Returns
    -------
    PaperStudy

    Raises
    ------
    InputError
        An engine is asked for and not installed.
    ComputationError
        Of our simulations; that of an engine is kept in the result.
    Interrupted
        By Ctrl-C; `keep` has seen what was done before.
    """
    if flag(engines, "engines"):
        check_engine()
    steps = (*STEPS, *ENGINE_STEPS) if engines else STEPS
    whole, done = sum(step.weight for step in steps), 0.0
    parts: dict[str, Dataset] = {}
    failures: dict[str, ComputationError] = {}
    for step in steps:

        def report(share: float, step: StudyPart = step, before: float = done) -> None:
            if progress is not None:
                progress(step.words, (before + step.weight * share) / whole)

        report(0.0)
        try:
            parts[step.name] = step.compute(report)
        except ComputationError as error:
            if step not in ENGINE_STEPS:
                raise
            failures[step.name] = error
        if keep is not None and step.name in parts:
            keep(step.name, parts[step.name])
        done += step.weight
        report(1.0)
    return PaperStudy(parts=parts, failures=failures)
