"""The paper's whole study: single actuator, robot, and what its deviation depends on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.errors import ComputationError
from flexapod.paper.claim import axis_motion
from flexapod.paper.cost import inverse_dynamics_cost
from flexapod.paper.engines import check_engine, exudyn_flexible, exudyn_rigid, rigid_same_step, undamped
from flexapod.paper.light import light_pistons
from flexapod.paper.printed_lines import printed_lines
from flexapod.paper.readings import actuator_preset, readings, robot_preset, tripod
from flexapod.paper.trials import TRIAL_STEP, trials
from flexapod.paper.variants import (
    HALF_ANGLES,
    JUMP_STEP,
    assumptions,
    half_angle_sweep,
    jump_motion,
    with_half_angle,
)
from flexapod.paper.welded import welded_map
from flexapod.study.actuator import simulate_actuator
from flexapod.study.record import Report, Share
from flexapod.study.simulation import run, simulate
from flexapod.study.solid import simulate_solid
from flexapod.study.static import modes

if TYPE_CHECKING:
    from xarray import Dataset

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


@dataclass(frozen=True, kw_only=True)
class Step:
    """A part of the study: name, words, usual share of the time, and how it is computed."""

    name: str
    words: str
    weight: float
    compute: Callable[[Share], Dataset]


def _over(report: Share) -> Callable[[float, float], None]:
    """Progress of one simulation as a share."""
    return lambda time, end: report(time / end)


def _actuator(count: int) -> Callable[[Share], Dataset]:
    return lambda report: simulate_actuator(actuator_preset(), modes=count, progress=_over(report))


def _free_actuator(report: Share) -> Dataset:
    """The same beam set free on a hub without friction or inertia, with the printed velocities at the start."""
    study, none = actuator_preset(), model.ConstantLaw(value=0.0)
    laws = study.motion.rotation, study.motion.extension
    turn, feed = (law.rate if isinstance(law, model.RateLaw) else 0.0 for law in laws)
    free = study.replace(
        motion=model.ActuatorMotion(rotation=None, extension=None),
        load=model.ActuatorLoad(torque=none, force=none),
        initial=study.initial.replace(angle_rate=turn, length_rate=feed),
    )
    return simulate_actuator(free, duration=FREE_TIME, progress=_over(report))


def _finest_actuator(fidelity: str, count: int) -> Callable[[Share], Dataset]:
    def compute(report: Share) -> Dataset:
        study = actuator_preset()
        return simulate_actuator(
            study,
            fidelity=fidelity,
            modes=count,
            step=COMPARED_STEP,
            output_step=COMPARED_OUTPUT,
            progress=_over(report),
        )

    return compute


def _solid(size: float, kind: str) -> Callable[[Share], Dataset]:
    def compute(report: Share) -> Dataset:
        study = actuator_preset()
        return simulate_solid(study, size=size, kind=kind, output_step=COMPARED_OUTPUT, progress=_over(report))

    return compute


def _robot(name: str) -> Callable[[Share], Dataset]:
    return lambda report: run(robot_preset(name), progress=_over(report))


def _fidelity(name: str, step: float) -> Callable[[Share], Dataset]:
    return lambda report: simulate(robot_preset("paper-robot"), fidelity=name, step=step, progress=_over(report))


def _jump(name: str, angle: float | None = None) -> Callable[[Share], Dataset]:
    def compute(report: Share) -> Dataset:
        study = robot_preset(name) if angle is None else with_half_angle(robot_preset(name), angle)
        return simulate(study, jump_motion(study), step=JUMP_STEP, progress=_over(report))

    return compute


def _modes(_: Share) -> Dataset:
    study = robot_preset("paper-robot")
    return modes(study, axis_motion(study).target)


def _sweep(name: str) -> Callable[[Share], Dataset]:
    return lambda report: half_angle_sweep(robot_preset(name), HALF_ANGLES, report)


STEPS: tuple[Step, ...] = (
    *(
        Step(name=f"actuator-{k}", words=f"single actuator, {k} shapes", weight=0.2 * k, compute=_actuator(k))
        for k in ACTUATOR_MODES
    ),
    Step(name="actuator-free", words="single actuator, set free", weight=0.5, compute=_free_actuator),
    Step(
        name="actuator-fine",
        words="single actuator, 8 shapes",
        weight=3,
        compute=_finest_actuator("assumed-modes", 8),
    ),
    Step(
        name="actuator-beam", words="single actuator, beam elements", weight=6, compute=_finest_actuator("beam-fem", 24)
    ),
    *(
        Step(name=f"actuator-solid-{name}", words=f"solid elements, {words}", weight=weight, compute=_solid(size, kind))
        for name, words, weight, size, kind in SOLIDS
    ),
    Step(name="printed-lines", words="energies as printed", weight=2, compute=printed_lines),
    Step(name="robot", words="robot with flexible legs", weight=4, compute=_robot("paper-robot")),
    Step(name="robot-rigid", words="robot with rigid legs", weight=0.3, compute=_fidelity("rigid", 5e-4)),
    Step(name="robot-lumped", words="robot whose legs only stretch", weight=0.3, compute=_fidelity("lumped", 2.5e-4)),
    Step(
        name="robot-fem",
        words="robot whose legs are beam elements",
        weight=0.5,
        compute=lambda report: simulate(
            robot_preset("paper-robot"), fidelity="beam-fem", modes=BEAM_SHAPES, progress=_over(report)
        ),
    ),
    Step(name="modes", words="modes at the largest roll", weight=0.2, compute=_modes),
    Step(name="robot-radii", words="circles read as radii", weight=4, compute=_robot("paper-robot-radii")),
    Step(name="jump", words="start with a jump of the velocity", weight=2, compute=_jump("paper-robot")),
    Step(name="jump-radii", words="the same, circles read as radii", weight=2, compute=_jump("paper-robot-radii")),
    Step(name="jump-27", words="the same, half-angles of 27 deg", weight=2, compute=_jump("paper-robot", 27.0)),
    Step(name="half-angles", words="half-angles of the joints", weight=4, compute=_sweep("paper-robot")),
    Step(name="half-angles-radii", words="half-angles, radii", weight=4, compute=_sweep("paper-robot-radii")),
    Step(
        name="assumptions",
        words="other assumptions",
        weight=3,
        compute=lambda r: assumptions(robot_preset("paper-robot"), r),
    ),
    Step(name="readings", words="other readings of the paper", weight=4, compute=lambda r: trials(readings(), r)),
    Step(
        name="tripod",
        words="a tripod of the same pistons",
        weight=1,
        compute=lambda report: simulate(tripod(), step=TRIAL_STEP, progress=_over(report)),
    ),
    Step(name="light", words="lighter pistons", weight=1, compute=light_pistons),
    Step(name="welded", words="ball joints that carry moments", weight=8, compute=welded_map),
    Step(
        name="cost",
        words="operations of inverse dynamics",
        weight=0.3,
        compute=lambda _: inverse_dynamics_cost(robot_preset("paper-robot")),
    ),
)


def _engine(compute: Callable[[model.Study, Share], Dataset]) -> Callable[[Share], Dataset]:
    return lambda report: compute(robot_preset("paper-robot"), report)


#: What an independent engine computes, with our runs at its step.
ENGINE_STEPS: tuple[Step, ...] = (
    Step(name="robot-rigid-same-step", words="rigid legs, step of the engine", weight=0.3,
         compute=_engine(rigid_same_step)),
    Step(name="robot-undamped", words="flexible legs without damping", weight=1, compute=_engine(undamped)),
    Step(name="robot-exudyn-rigid", words="Exudyn, rigid legs", weight=2, compute=_engine(exudyn_rigid)),
    Step(name="robot-exudyn", words="Exudyn, flexible legs", weight=25, compute=_engine(exudyn_flexible)),
)  # fmt: skip


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
    if engines:
        check_engine()
    steps = (*STEPS, *ENGINE_STEPS) if engines else STEPS
    whole, done = sum(step.weight for step in steps), 0.0
    parts: dict[str, Dataset] = {}
    failures: dict[str, ComputationError] = {}
    for step in steps:

        def report(share: float, step: Step = step, before: float = done) -> None:
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
