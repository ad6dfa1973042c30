"""The report of a run: one self-contained page whose first sentence is the answer.

The section of the linear model states vibration by disturbances about rest and damping by a controller.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from platform import python_version
from typing import TYPE_CHECKING

from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.results.attributes import carried_study
from flexapod.analysis.results.summary import POINT_WORDS, RobotSummary, summaries
from flexapod.common.errors import FlexapodError
from flexapod.common.files import temporary_folder, write_text
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.quantities import column, sentence, text
from flexapod.model import ActuatorStudy
from flexapod.output.report.replay import MOST_POINTS, locked_modes, replay
from flexapod.output.text import html
from flexapod.output.text.answers import bodies_words, distances_table, idealization_remarks
from flexapod.output.text.budget import peak_budget, peak_items
from flexapod.output.text.description import control_words, vibration_words
from flexapod.output.text.html import Html
from flexapod.output.text.parts import Chapter, Item, Lines, Remarks, Text, TextTable, warning_lines
from flexapod.output.text.study import modes_section, study_items
from flexapod.output.text.verdict import study_verdict, verdict_items

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import analysis
    from flexapod.analysis import predicted_damping
    from flexapod.analysis.description.actuator_description import ActuatorDescription
    from flexapod.analysis.description.robot_description import RobotDescription
    from flexapod.analysis.pose_errors import disturbances
    from flexapod.analysis.requirements import record
    from flexapod.analysis.results.summary import ActuatorSummary
    from flexapod.model import ActuatorStudy, Study
    from flexapod.output import figures as output_figures
    from flexapod.output.report import figures as report_figures
    from flexapod.output.report.figures import StoredFigure
else:
    analysis = LazyModule("flexapod.analysis")
    disturbances = LazyModule("flexapod.analysis.pose_errors.disturbances")
    record = LazyModule("flexapod.analysis.requirements.record")
    predicted_damping = LazyModule("flexapod.analysis.predicted_damping")
    output_figures = LazyModule("flexapod.output.figures")
    report_figures = LazyModule("flexapod.output.report.figures")


def linear_section(study: Study | ActuatorStudy | None) -> list[Html]:
    """Vibration by the study's disturbances and damping by its controller; nothing where it has neither."""
    if study is None or isinstance(study, ActuatorStudy):
        return []
    told: list[Item] = [*_vibration_section(study), *_damping_table(study)]
    return [html.section("linear", "Linear model about home", told)] if told else []


def _vibration_section(study: Study) -> Iterator[Item]:
    """Words and figure of the vibration by disturbances."""
    if study.disturbance is None:
        return

    try:
        data = analysis.vibration(study)
    except FlexapodError as error:
        yield Text(f"The vibration by disturbances cannot be said: {error}", "bad")
        return
    yield from map(sentence, vibration_words(disturbances.shaking(data), "at home"))
    with temporary_folder() as folder:
        drawn = report_figures.store_figure(
            output_figures.vibration(data),
            "Rms of the tool by frequencies from here up",
            folder / "vibration",
            ("png",),
        )
    yield html.figure(drawn.title, drawn.picture, drawn.plot)


def _damping_table(study: Study) -> Iterator[Item]:
    """A table of damping without the controller and with it."""
    if study.control is None:
        return

    try:
        found = predicted_damping.predicted_damping(study)
    except FlexapodError as error:
        yield Text(f"What the controller does to damping cannot be said: {error}", "bad")
        return
    if found is None:
        return
    both = ((found.frequency, found.ratio), (found.frequency_with, found.ratio_with))
    columns = [text for f, ratio in both for text in (column(f, "Hz", 6)[1], column(100 * ratio, "")[1])]
    head = ["frequency [Hz]", "damping [%]", "with the controller [Hz]", "its damping [%]"]
    yield TextTable(head, list(zip(*columns, strict=True)), left=())
    yield Text("Predicted by the linear model, from sample to sample, without noise and limits.", "soft")
    yield from map(sentence, control_words(predicted_damping.control_effect(study)))


SOLVER = {
    "integrator": "Time integration",
    "rho_inf": "Spectral radius at infinite frequency",
    "fidelity": "Fidelity",
    "basis": "Lateral shapes",
    "modes": "Shapes per plane",
    "axial_modes": "Axial shapes",
    "start": "Start",
    "compiled": "Compiled equations",
    "tolerance": "Tolerance of the step control",
    "estimated_error": "Largest estimated error",
    "estimated_force_error": "Estimated error of the legs' forces over their peak",
    "step": "Smallest step (with a tolerance: least mean over some outputs) [s]",
    "output_step": "Output step [s]",
    "steps": "Steps",
    "newton_iterations": "Newton iterations",
    "factorisations": "Factorisations",
    "rejected_steps": "Rejected steps",
    "impact_energy": "Energy step of an impact at the start [J]",
    "wall_time": "Time of the integration [s]",
}
THINNED = (
    "Drag over a figure to zoom, double-click to see all again; point at a curve to read it. Curves of more than "
    f"{MOST_POINTS} points are thinned for this page, and keep their least and largest values; the data are whole."
)
TITLES = {"linear": "Linear model"}  # of links, where they are not the name
STILLS = ("robot", "path")  # figures that stand for the replay on paper
_PACKAGES = ("flexapod", "numpy", "scipy", "casadi", "xarray", "matplotlib", "plotly")


def robot_report(study: Study | ActuatorStudy, data: Dataset) -> str:
    """The report of a robot's or an actuator's run, whole or partial, as text, with figures drawn for it."""
    with temporary_folder() as folder:
        return _page(study, data, lambda: report_figures.draw_figures(data, folder, ("png",)))


def write_report(
    data: Dataset,
    folder: str | Path,
    figures: Callable[[], Sequence[StoredFigure]] = tuple,
    verdict: Dataset | None = None,
) -> Path:
    """Write ``report.html`` of a robot's or an actuator's run, whole or partial, with drawn `figures`; its path.

    ``verdict``: on the requirement of its study, where that is known; else it is computed.

    The figures are asked for last. The folder is made if needed; an existing report is replaced when the new one is
    complete. InputError: the folder cannot be written to.
    """
    return write_text(Path(folder) / "report.html", _page(carried_study(data), data, figures, verdict))


def _page(
    study: Study | ActuatorStudy | None,
    data: Dataset,
    figures: Callable[[], Sequence[StoredFigure]],
    verdict: Dataset | None = None,
) -> str:
    first, *further = summaries(data)
    judged = verdict if verdict is not None else _verdict(study, data)
    lead, told = first.sentence, []
    if judged is not None:
        lead, *told = verdict_items(judged)  # type: ignore[assignment]
        told.append(first.sentence)
    described = _described(study)
    name = Path(str(data.attrs.get("study_file") or "study")).name
    modes = modes_section(study, described)
    budget = peak_budget(data) if isinstance(first, RobotSummary) else None
    moving, others = _replay(study, data, figures)
    linear = linear_section(study)
    parts = {"replay": moving, "figures": others, "modes": modes, "linear": linear}
    numbers = {"deviation": "Deviation"} if isinstance(first, RobotSummary) else {"deflection": "Deflection"}
    links = {
        **numbers,
        **({} if budget is None else {"budget": "Error budget"}),
        "warnings": "Warnings",
        "study": "Study",
    }
    links |= {part: TITLES.get(part, part.capitalize()) for part, there in parts.items() if there}
    links |= {"solver": "Solver", "toml": "Study file", "repeat": "Repeat"}
    body = [
        *told,
        *(*(found.sentence for found in further), *bodies_words(data)),
        *filter(None, idealization_remarks(study)),
        Text(f"Report of {name}, flexapod {data.attrs['flexapod_version']}.", "soft"),
        html.contents(links),
        *_partial(data),
        deviation_section(data) if isinstance(first, RobotSummary) else _actuator_numbers(first),
        *([] if budget is None else [html.section("budget", "Error budget", peak_items(budget))]),
        warnings_section(data),
        html.section("study", "What was computed", () if study is None else study_items(study, described)),
        *moving,
        *figures_section("figures", "Figures", others),
        *modes,
        *linear,
        html.section("solver", "Solver", [solver_table(data)]),
        html.section("toml", "Study file", [Lines(str(data.attrs["study"]))]),
        repeat_section("Save the study file above as study.toml, then", "flexapod run study.toml --out results"),
    ]
    return html.page(f"flexapod: {name}", str(lead), body)


def _verdict(study: Study | ActuatorStudy | None, data: Dataset) -> Dataset | None:
    """Verdict on the requirement of a run's study; None without one, or where it cannot be judged at all."""
    try:
        found = study_verdict(study)
    except FlexapodError:
        return None
    return None if found is None else record.with_record(found, study, data)  # type: ignore[arg-type]


def _described(study: Study | ActuatorStudy | None) -> RobotDescription | ActuatorDescription | None:
    """The study as `flexapod check` describes it; None where it cannot be."""
    try:
        return None if study is None else describe(study)
    except FlexapodError:
        return None


def _replay(
    study: Study | ActuatorStudy | None, data: Dataset, figures: Callable[[], Sequence[StoredFigure]]
) -> tuple[list[Html], list[StoredFigure]]:
    """The replay, with the figure that stands for it on paper, and the other figures."""
    if study is None:
        return [], list(figures())

    told = replay(study, data, locked_modes(study))
    drawn = figures()
    still = next((figure for figure in drawn if figure.name in STILLS), None)
    return [replay_section(data, told, still)], [figure for figure in drawn if figure is not still]


def replay_section(data: Dataset, told: Mapping[str, object], still: StoredFigure | None) -> Html:
    """Section with the data of `flexapod.output.report.replay` and the figure that replaces it on paper."""
    title = "The robot in motion" if "com_deviation" in data else "The beam in motion"
    words = str(told["words"])
    shown = len(told["time"])  # type: ignore[arg-type]
    title += f", {shown} of {data.sizes['time']} instants; {words}. {told['mouse']}."
    return html.section("replay", "Replay", [html.replay(title, told, still and (still.title, still.picture))])


def deviation_section(data: Dataset) -> Html:
    """Largest and rms deviation along each axis, of the centre of mass and of a tool elsewhere."""
    tables = {x.point: distances_table(x) for x in summaries(data) if isinstance(x, RobotSummary)}
    several = [Chapter(POINT_WORDS[point].capitalize(), [table]) for point, table in tables.items()]
    note = "Flexible minus rigid at the same instant, world axes; it contains the sag at rest. Per cent of the travel: "
    note += "largest deviation over the rigid point's peak-to-peak travel, n/a where that is below 1 µm."
    told = several if len(several) > 1 else tables.values()
    return html.section("deviation", "Deviation by axis", [*told, Text(note, "soft")])


def _actuator_numbers(found: ActuatorSummary) -> Html:
    start, end = (text(length, "m", 4) for length in found.lengths)
    rows = [
        ("Largest deflection of the tip", f"{text(found.peak, 'm')} at {found.time:.3f} s"),
        ("rms", text(found.rms, "m")),
        ("At the end", text(found.end, "m")),
        ("Free length", f"{start} at the start, {end} at the end"),
    ]
    return html.section("deflection", "Deflection of the tip", [TextTable((), rows)])


def _partial(data: Dataset) -> list[Item]:
    if not data.attrs.get("partial"):
        return []
    return [Text(f"Incomplete: computed to t = {float(data.time[-1]):.6g} s. {data.attrs.get('failure', '')}", "bad")]


def warnings_section(data: Dataset) -> Html:
    """Section with the warnings of a result, or "None."."""
    found = warning_lines(data)
    return html.section("warnings", "Warnings", [Remarks(found) if found else "None."])


def figures_section(name: str, title: str, figures: Sequence[StoredFigure], *, first: bool = True) -> list[Html]:
    """Figures, one below the other, nothing where there are none; the first of a page say how they are read."""
    parts = [html.figure(figure.title, figure.picture, figure.plot) for figure in figures]
    read = [Text(THINNED, "soft screen")] if first else []
    return [html.section(name, title, [*read, *parts])] if parts else []


def solver_table(data: Dataset) -> TextTable:
    """Settings and counters of the time integration."""
    attrs: Mapping[object, object] = data.attrs
    return TextTable((), [(words, _shown(attrs[key], key)) for key, words in SOLVER.items() if key in attrs])


def _shown(value: object, key: str) -> str:
    if key == "compiled":
        return "yes" if value else "no (interpreted: slow)"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def repeat_section(words: str, command: str) -> Html:
    """Section on repeating the run: the command, and the versions of all packages that were used."""
    versions = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    note = Text(f"Python {python_version()}, {versions}.", "soft")
    return html.section("repeat", "How to repeat this", [words, Lines(command), note])
