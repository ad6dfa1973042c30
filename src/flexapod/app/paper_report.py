"""The report of the paper's study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.app import html
from flexapod.app.figures import Drawn
from flexapod.app.report import by_axis, figures_section, repeat_section, solver_table, warnings_section
from flexapod.study.paper.claim import BREAKS, HOLDS, IN_PART, MISPRINT, NOT, OPEN, REACHES

if TYPE_CHECKING:
    from flexapod.study.paper.claims import Claim
    from flexapod.study.paper.study import PaperStudy

__all__ = ["paper_page"]

_MARKS = {HOLDS: "good", IN_PART: "open", NOT: "bad", OPEN: "open", MISPRINT: "bad", REACHES: "open", BREAKS: "bad"}
_SHOWN = {
    "robot": "Robot, flexible legs",
    "robot-rigid": "Robot, rigid legs",
    "jump": "Start with a jump",
    "actuator-3": "Single actuator, 3 shapes",
}


def paper_page(result: PaperStudy, claims: Sequence[Claim], groups: Mapping[str, Sequence[Drawn]]) -> str:
    """The page: deviation and cause, claims, figures, open values, studies, solver."""
    from flexapod.citations import CITATIONS
    from flexapod.study.summary import summary

    paper = CITATIONS["nourian-akbarzadeh"]
    robot = result["robot"]
    links = {"deviation": "Deviation", "claims": "Claims", **{_anchor(name): name for name in groups}}
    links |= {"open": "Open values", "studies": "Studies", "repeat": "Repeat"}
    body = [
        html.paragraph(
            "The paper prints about 5 mm in Y and 10 mm in Z. With its values, ideal joints and rigid drives the "
            "deviation is micrometres; nothing here is tuned to the printed figures. "
            f"The paper: {paper.authors} ({paper.year}), {paper.title}.",
        ),
        "<nav>" + " ".join(f'<a href="#{anchor}">{words}</a>' for anchor, words in links.items()) + "</nav>",
        by_axis(robot),
        _claims(claims),
        *(figures_section(_anchor(name), name, drawn) for name, drawn in groups.items()),
        _open_values(),
        warnings_section(robot),
        _studies(),
        html.section("solver", "Solver", *(_solver(result, name, words) for name, words in _SHOWN.items())),
        repeat_section("Everything on this page, with data as NetCDF and CSV:", "flexapod replicate --out DIR"),
    ]
    return html.page("flexapod: the paper's study", summary(robot).sentence, body)


def _anchor(name: str) -> str:
    return name.lower().replace(" ", "-")


def _claims(claims: Sequence[Claim]) -> str:
    from flexapod.study.paper.claims import CLAIM_HEAD

    rows = [(c.where, c.says, c.ours, c.verdict, c.reason) for c in claims]
    words = (
        "What the paper says, what we get, and why. Deviations are the largest of the centre of mass along each axis. "
        "Half-angles, times, and the last four rows vary what the paper leaves open."
    )
    return html.section("claims", "Claims", html.paragraph(words, "soft"), html.table(CLAIM_HEAD, rows, _MARKS))


def _open_values() -> str:
    """The values of the presets that the paper does not give, each with the reason for ours."""
    parts = [html.paragraph("The paper does not give these values. Each is ours, for the reason beside it.", "soft")]
    for name in model.PRESETS:
        rows = [(value.key, value.value, value.reason) for value in model.open_values(name)]
        parts += [f"<h3>{name}</h3>", html.table(("Value", "Ours", "Reason"), rows)]
    return html.section("open", "Values that the paper leaves open", *parts)


def _studies() -> str:
    blocks = [html.code(model.preset_text(name), name) for name in model.PRESETS]
    words = "Half-angles, jumps and drives change these presets; each data file carries its own study."
    return html.section("studies", "Studies", html.paragraph(words, "soft"), *blocks)


def _solver(result: PaperStudy, name: str, words: str) -> str:
    return f"<h3>{words}</h3>" + solver_table(result[name])
