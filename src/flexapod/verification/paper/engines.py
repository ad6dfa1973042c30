"""The paper's robot by an independent engine, Exudyn with finite elements (Figs. 8 and 9), and ours to compare with."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np
from xarray import Dataset

from flexapod import kinematics, model
from flexapod.analysis.results.attributes import attributes, motion_end
from flexapod.analysis.results.time_history import Share
from flexapod.analysis.results.variables import dataset
from flexapod.analysis.simulation import simulate
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import scale, text
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.engines.exudyn_integration import Integration, extrapolate_first_order
from flexapod.verification.engines.exudyn_robot import MESHES, STEP, RobotResult, simulate_robot
from flexapod.verification.robots import with_legs

NO_GUIDE = 0.0  # m; of rigid pistons
RIGID_TOLERANCE = 1e-8  # N; Newton's method
USUAL = {0: 2.0, 30: 10.0, 60: 15.0}  # s, by elements per piston: for the progress only
TIME_LIMIT = 900.0  # s
COMPARED = (
    *("com_position_rigid", "com_position", "com_deviation"),
    *("actuator_force_rigid", "actuator_force", "tip_deflection"),
)
SETTLED = 0.05  # s; 200 steps, in which a spectral radius of 0.9 leaves 1e-9 of what rings


def check_engine() -> None:
    """Refuse, before anything is computed, to do without the engine.

    Raises
    ------
    InputError
        Exudyn is not installed.
    """
    if not EXUDYN.is_available():
        raise InputError(
            "Exudyn, which it asks, is not installed",
            key="--engines",
            next_step=f"Install it: {EXUDYN.install}; or leave --engines out",
        )


def without_damping(study: model.Study) -> model.Study:
    """Study with undamped pistons: Exudyn's cables have no modal damping."""
    return study.replace(robot=with_legs(study.robot, damping=0.0))


def run_undamped(study: model.Study, report: Share) -> Dataset:
    """Our run to compare with: flexible pistons without damping, at the step and the instants of Exudyn's."""
    return _ours(without_damping(study), None, report)


def rigid_same_step(study: model.Study, report: Share) -> Dataset:
    """Our multibody model with rigid pistons, at the step and the instants of Exudyn's."""
    return _ours(study, "rigid", report)


def _ours(study: model.Study, fidelity: str | None, report: Share) -> Dataset:
    """Compared variables of our run: eight thousand instants of everything would fill 50 MB."""
    data = simulate(
        study, fidelity=fidelity, step=STEP, output_step=STEP, progress=lambda reached, end: report(reached / end)
    )
    return data[list(COMPARED)]


def exudyn_rigid(study: model.Study, report: Share) -> Dataset:
    """The robot with rigid pistons by Exudyn.

    Returns
    -------
    xarray.Dataset
        As `exudyn_flexible`, without deflections.
    """
    found = _solved(study, 0, NO_GUIDE, RIGID_TOLERANCE, report)
    values = {"com_deviation": found.com_deviation, "actuator_force": found.actuator_force}
    return _dataset(study, found.time, values, {**_settings(RIGID_TOLERANCE), "elements": 0, "seconds": found.seconds})


def exudyn_flexible(study: model.Study, report: Share) -> Dataset:
    """The robot with pistons of undamped cable elements by Exudyn, from two meshes extrapolated.

    Returns
    -------
    xarray.Dataset
        `com_position`, `com_position_rigid`, `com_deviation`, `actuator_force`, `tip_deflection`, and
        `actuator_force_rigid` by our Newton-Euler, at every step. Attributes: `engine`, `engine_version`, `elements`
        per piston, `guide` [m], `step` [s], `seconds`, and ``refinement_NAME``: largest change of a variable from the
        finer mesh to the extrapolated value; of `com_deviation` along each axis.

    Raises
    ------
    ComputationError
        Exudyn crashes, does not converge or does not end in time.
    """
    study, meshes = without_damping(study), []
    whole, before = sum(USUAL[elements] for elements, _ in MESHES), 0.0
    for elements, guide in MESHES:
        share, start = USUAL[elements] / whole, before / whole

        def part(done: float, share: float = share, start: float = start) -> None:
            report(start + share * done)

        meshes.append(_solved(study, elements, guide, Integration.tolerance, part))
        before += USUAL[elements]
    coarse, fine = meshes
    names = ("com_deviation", "actuator_force", "tip_deflection")
    values = {name: extrapolate_first_order(getattr(coarse, name), getattr(fine, name)) for name in names}
    changes = {name: np.abs(values[name] - getattr(fine, name)) for name in names}
    refinement = {f"refinement_{name}": float(change.max()) for name, change in changes.items()}
    refinement["refinement_com_deviation"] = changes["com_deviation"].max(axis=0).tolist()
    sizes, guides = ([mesh[i] for mesh in MESHES] for i in (0, 1))
    cost = {"elements": sizes, "guide": guides, "seconds": coarse.seconds + fine.seconds}
    return _dataset(study, fine.time, values, {**_settings(Integration.tolerance), **cost, **refinement})


def _solved(study: model.Study, elements: int, guide: float, tolerance: float, report: Share) -> RobotResult:
    plan = Integration(duration=study.duration, step=STEP, rho_inf=study.simulation.rho_inf, tolerance=tolerance)
    with _by_the_clock(report, USUAL[elements]):
        return simulate_robot(study.robot, study.motion, plan, elements=elements, guide=guide, time_limit=TIME_LIMIT)


@contextmanager
def _by_the_clock(report: Share, usual: float) -> Iterator[None]:
    """Report progress of a program that reports none: rises to 0.76 in the `usual` seconds, never to 1.

    `report` is called from a second thread; the computation stays in this one, where Ctrl-C ends its process.
    """
    ended, begin = threading.Event(), time.perf_counter()

    def tick() -> None:
        while not ended.wait(0.25):
            report(float(np.tanh((time.perf_counter() - begin) / usual)))

    clock = threading.Thread(target=tick, name="progress", daemon=True)
    clock.start()
    try:
        yield
    finally:
        ended.set()
        clock.join()


def _settings(tolerance: float) -> dict[str, object]:
    return {
        "engine": EXUDYN.name,
        "engine_version": version(EXUDYN.module),
        "integrator": "generalized-alpha",
        "step": STEP,
        "newton_tolerance": tolerance,
    }


def _dataset(study: model.Study, instants: Array, values: Mapping[str, Array], attrs: Mapping[str, object]) -> Dataset:
    """Results of Exudyn with our rigid path and rigid forces at the same instants."""
    path = kinematics.poses(study.robot, study.motion, instants)
    centre, _, _ = path.point(study.robot.payload.com)
    forces = kinematics.inverse_dynamics(study.robot, path).actuator_force
    known = {"com_position_rigid": centre, "com_position": centre + values["com_deviation"]}
    own = {**attributes(study), "title": "Exudyn: parallel robot", "rho_inf": study.simulation.rho_inf}
    return dataset({**known, **values, "actuator_force_rigid": forces}, {"time": instants}, {**own, **attrs})


@dataclass(frozen=True, kw_only=True)
class Agreement:
    """A quantity by us and by Exudyn [`unit`]: largest values, and the largest difference over all instants.

    `refinement`: how far Exudyn's finer mesh is from the extrapolated value; NaN for rigid pistons.
    """

    quantity: str
    unit: str
    ours: float
    theirs: float
    difference: float
    refinement: float

    @property
    def words(self) -> str:
        """The numbers in a sentence's form."""
        unit = scale([self.ours, self.theirs], self.unit)
        apart = f"curves at most {text(self.difference, self.unit, 2)} apart"
        return f"ours {unit.text(self.ours, 5)}, Exudyn {unit.text(self.theirs, 5)}, {apart}"


def agreements(parts: Mapping[str, Dataset]) -> list[Agreement]:
    """Agreement between Exudyn and us, of those parts of the paper's study that are there."""
    rows: list[Agreement] = []
    if {"robot-rigid-same-step", "robot-exudyn-rigid"} <= set(parts):
        rows += _rigid_agreements(parts["robot-rigid-same-step"], parts["robot-exudyn-rigid"])
    if {"robot-undamped", "robot-exudyn"} <= set(parts):
        rows += _flexible_agreements(parts["robot-undamped"], parts["robot-exudyn"])
    return rows


def _rigid_agreements(ours: Dataset, theirs: Dataset) -> Iterator[Agreement]:
    name, both = "drive force, rigid legs", (theirs.actuator_force_rigid.values, theirs.actuator_force.values)
    yield _agreement(f"{name} (ours: multibody model)", "N", ours.actuator_force.values, both[1])
    yield _agreement(f"{name} (ours: Newton-Euler)", "N", *both)
    words = f"{name} (the same, without {1e3 * SETTLED:.0f} ms after start and end of the roll)"
    yield _agreement(words, "N", *(forces[_calm(theirs)] for forces in both))


def _flexible_agreements(ours: Dataset, theirs: Dataset) -> Iterator[Agreement]:
    changes = dict(zip("xyz", theirs.attrs["refinement_com_deviation"], strict=True))
    for axis in ("y", "z"):
        own, other = (data.com_deviation.sel(axis=axis).values for data in (ours, theirs))
        yield _agreement(f"deviation of the centre of mass in {axis.upper()}", "m", own, other, changes[axis])
    words = {
        "actuator_force": ("drive force, flexible legs", "N"),
        "tip_deflection": ("deflection of a piston's tip", "m"),
    }
    for name, (quantity, unit) in words.items():
        change = theirs.attrs[f"refinement_{name}"]
        yield _agreement(quantity, unit, ours[name].values, theirs[name].values, change)


def _calm(data: Dataset) -> Array:
    """Instants (T,) at which nothing rings any more of the jerk's jumps at the start and at the end of the motion."""
    instants, end = data.time.values, motion_end(data)
    calm = instants > SETTLED
    return calm if end is None else calm & ((instants < end) | (instants > end + SETTLED))


def _agreement(quantity: str, unit: str, ours: Array, theirs: Array, refinement: float = np.nan) -> Agreement:
    return Agreement(
        quantity=quantity,
        unit=unit,
        ours=float(np.abs(ours).max()),
        theirs=float(np.abs(theirs).max()),
        difference=float(np.abs(ours - theirs).max()),
        refinement=float(refinement),
    )
