"""The report of the paper's study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from xarray import Dataset

from flexapod import model
from flexapod.analysis.results.attributes import robot_study
from flexapod.analysis.results.summary import summary
from flexapod.common.citations import CITATIONS
from flexapod.common.quantities import number, scale, text
from flexapod.output.report.figures import StoredFigure
from flexapod.output.report.replay import replay
from flexapod.output.report.report import (
    deviation_section,
    figures_section,
    repeat_section,
    replay_section,
    solver_table,
    warnings_section,
)
from flexapod.output.text import html
from flexapod.output.text.html import Html
from flexapod.output.text.parts import Chapter, Item, Lines, Text, TextTable
from flexapod.output.text.study import modes_table
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.paper.claim import (
    BREAKS,
    COPY,
    DONE,
    HERE,
    HOLDS,
    IN_PART,
    INCOMPLETE,
    MISPRINT,
    MISSES,
    NOT,
    OPEN,
    REACHES,
    USELESS,
    Claim,
    axis_motion,
    roll_and_arm,
)
from flexapod.verification.paper.claims import CLAIM_HEAD, group_by_owner, verdict_summary
from flexapod.verification.paper.engines import agreements
from flexapod.verification.paper.figures import ENGINE
from flexapod.verification.paper.study import PaperStudy

_MARKS = {
    HOLDS: "good", HERE: "good", IN_PART: "open", NOT: "bad", OPEN: "open", MISPRINT: "bad", INCOMPLETE: "bad",
    REACHES: "open", MISSES: "open", BREAKS: "open", DONE: "good", USELESS: "bad",
}  # fmt: skip
SHOWN_MODES = 12
_SHOWN = {
    "robot": "Robot, flexible legs",
    "robot-rigid": "Robot, rigid legs",
    "jump": "Start with a jump",
    "actuator-3": "Single actuator, 3 shapes",
}


def paper_page(result: PaperStudy, claims: Sequence[Claim], groups: Mapping[str, Sequence[StoredFigure]]) -> str:
    """The page: deviation and cause, claims, figures, open values, studies, solver."""
    paper = CITATIONS["nourian-akbarzadeh"]
    robot = result["robot"]
    links = {"deviation": "Deviation", "claims": "Claims", "replay": "Replay"}
    links |= {_anchor(name): name for name in groups}
    if _asked(result):
        links[_anchor(ENGINE)] = ENGINE
    links |= {"modes": "Modes", "open": "Open values", "studies": "Studies", "solver": "Solver", "repeat": "Repeat"}
    body = [
        "The paper prints about 5 mm in Y and 10 mm in Z. With its values, ideal joints and rigid drives the "
        f"deviation is micrometres. {_backed_out(robot)} The paper: {paper.authors} ({paper.year}), {paper.title}.",
        html.contents(links),
        deviation_section(robot),
        _claims(claims),
        _replay(robot, result["modes"], [drawn for group in groups.values() for drawn in group]),
        *(
            section
            for i, (name, drawn) in enumerate(groups.items())
            if name != ENGINE
            for section in figures_section(_anchor(name), name, drawn, first=i == 0)
        ),
        *([_engine(result, groups.get(ENGINE, ()))] if _asked(result) else []),
        _modes(result["modes"]),
        _open_values(),
        warnings_section(robot),
        _studies(),
        html.section(
            "solver", "Solver", [Chapter(words, [solver_table(result[name])]) for name, words in _SHOWN.items()]
        ),
        repeat_section("Everything on this page, with data as NetCDF and CSV:", _command(result)),
    ]
    return html.page("flexapod: the paper's study", summary(robot).sentence, body)


def _backed_out(robot: Dataset) -> str:
    """Statement of what in the presets was taken from the paper's results, and what was not."""
    roll, arm = roll_and_arm(robot)
    other = float(np.rad2deg(axis_motion(model.preset("paper-robot-radii")).target[3]))
    return (
        f"The deviation is not tuned. The roll of {np.rad2deg(roll):.3g} deg and the centre of mass {1e3 * arm:.0f} mm "
        "off the platform's centre are backed out of the printed 5 mm, 10 mm and 6 %; with circles read as radii, the "
        f"roll of {other:.3g} deg of the printed 260 mm."
    )


def _replay(data: Dataset, modes: Dataset, figures: Sequence[StoredFigure]) -> Html:
    """The robot in motion and in its modes at the largest roll; on paper the figure of its end."""
    study = robot_study(data)
    still = next((figure for figure in figures if figure.name == "robot-end"), None)
    return replay_section(data, replay(study, data, modes), still)


def _modes(modes: Dataset) -> Html:
    """Frequencies, damping and kinds of the lowest modes at the largest roll."""
    shown = modes.isel(mode=slice(SHOWN_MODES))
    columns = (shown[name].values.tolist() for name in ("frequency", "damping_ratio", "kind"))
    words = "At the largest roll, drives locked, about the static equilibrium."
    return html.section("modes", "Modes", [Text(words, "soft"), modes_table(zip(*columns, strict=True))])


def _asked(result: PaperStudy) -> bool:
    """Test whether an independent engine was to compute."""
    return bool(result.failures) or "robot-exudyn" in result.parts


def _command(result: PaperStudy) -> str:
    return f"flexapod replicate {'--engines ' if _asked(result) else ''}--out DIR"


def _engine(result: PaperStudy, figures: Sequence[StoredFigure]) -> Html:
    """Section on the engine: what it is, its agreement with us, its figures, and how to repeat it."""
    rows = []
    for row in agreements(result.parts):
        unit = scale([row.ours, row.theirs], row.unit)
        apart = [text(value, row.unit, 2) if value == value else "" for value in (row.difference, row.refinement)]
        rows.append((row.quantity, unit.text(row.ours, 5), unit.text(row.theirs, 5), *apart))
    head = ("Largest", "Ours", EXUDYN.name, "Largest difference of the curves", "Exudyn's last refinement changes")
    failures = [f"{name}: {error}" for name, error in result.failures.items()]
    told: list[Item] = [
        *(Text(f"Not computed: {words}", "bad") for words in failures),
        *(Text(words, "soft") for words in _engine_words(result)),
        *([TextTable(head, rows)] if rows else []),
        *(html.figure(figure.title, figure.picture, figure.plot) for figure in figures),
        "To repeat this:",
        Lines(f"{EXUDYN.install}\n{_command(result)}"),
    ]
    return html.section(_anchor(ENGINE), ENGINE, told)


def _engine_words(result: PaperStudy) -> list[str]:
    done = [result[name] for name in ("robot-exudyn-rigid", "robot-exudyn") if name in result.parts]
    if not done:
        return []
    attrs = done[0].attrs
    words = [
        f"{attrs['engine']} {attrs['engine_version']}, in a process of its own, {number(_seconds(done), 2)} s: legs as "
        "kinematic trees, spherical joints by multipliers, prescribed strokes; generalized-alpha, steps of "
        f"{number(1e3 * attrs['step'], 2)} ms, spectral radius {attrs['rho_inf']:g}, and the same in ours."
    ]
    if "robot-exudyn" in result.parts:
        coarse, fine = result["robot-exudyn"].attrs["elements"]
        near, nearer = result["robot-exudyn"].attrs["guide"]
        words.append(
            f"Flexible pistons are {coarse} and {fine} cable elements (Euler-Bernoulli, finite strains and rotations), "
            f"extrapolated, that slide through two rings on the cylinder, {number(1e3 * near, 2)} and "
            f"{number(1e3 * nearer, 2)} mm apart, in place of our clamp; without damping, which these elements do not "
            "have in our form. The rings are softer than a clamp: that is most of the difference."
        )
    return words


def _seconds(done: Sequence[Dataset]) -> float:
    return sum(float(data.attrs["seconds"]) for data in done)


def _anchor(name: str) -> str:
    return name.lower().replace(" ", "-")


def _claims(claims: Sequence[Claim]) -> Html:
    words = (
        "What the paper says, what we get, and why: first its own claims, then what it asks for next, then variants of "
        "ours, which read it in other ways and vary what it leaves open. Deviations are the largest of the centre of "
        "mass along each axis. The paper was at hand as a text made from its pages, without its figures: what that "
        "copy may have lost is said to stand "
        f"'{COPY}', what is so in any reading is said to be, and rows on figures say that these were not seen."
    )
    tables = [
        Chapter(title, [verdict_summary(some), _claim_table(some)]) for title, some in group_by_owner(claims).items()
    ]
    return html.section("claims", "Claims", [Text(words, "soft"), *tables])


def _claim_table(claims: Sequence[Claim]) -> TextTable:
    return TextTable(CLAIM_HEAD, [(c.where, c.says, c.ours, c.verdict, c.reason) for c in claims], marks=_MARKS)


def _open_values() -> Html:
    """The values of the presets that the paper does not give, each with the reason for ours."""
    told: list[Item] = [Text("The paper does not give these values. Each is ours, for the reason beside it.", "soft")]
    for name in model.PAPER_PRESETS:
        rows = [(value.key, value.value, value.reason) for value in model.open_values(name)]
        told.append(Chapter(name, [TextTable(("Value", "Ours", "Reason"), rows)]))
    return html.section("open", "Values that the paper leaves open", told)


def _studies() -> Html:
    words = "Half-angles, jumps and drives change these presets; each data file carries its own study."
    files = [Lines(model.preset_text(name), name) for name in model.PAPER_PRESETS]
    return html.section("studies", "Studies", [Text(words, "soft"), *files])
