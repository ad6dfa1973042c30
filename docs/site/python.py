"""The Python reference: every public name on a page, ranked; the text is that of the docstrings."""

from __future__ import annotations

import inspect
from pathlib import Path
from types import ModuleType

import flexapod as fx

FOLDER = Path("reference/python")

#: What everybody needs, in the order in which it is needed.
FIRST = ("load", "preset", "simulate", "modes", "stiffness", "budget", "parts", "inverse_dynamics", "plot", "sweep")
#: All names by task: title, words, names. A name may be in FIRST, too; its page is here.
TASKS: dict[str, tuple[str, tuple[str, ...]]] = {
    "Studies": (
        "What is analysed: read, written in Python, changed.",
        ("load", "loads", "preset", "open_values", "Study", "ActuatorStudy"),
    ),
    "Simulation": (
        "A study in time.",
        ("simulate", "run", "simulate_actuator", "simulate_solid"),
    ),
    "Statics and modes": (
        "At a pose, about the equilibrium.",
        ("modes", "stiffness", "parts", "vibration"),
    ),
    "Errors": (
        "How far the tool is from where it should be, and why.",
        ("budget", "accuracy", "play"),
    ),
    "Decisions": (
        "Does a machine keep what is required, which number matters, which values are best: "
        "[requirements](../../how-to/does-my-box-fit.md), [sensitivities](../../sensitivity.md), "
        "[optima](../../optimise.md).",
        ("verdict", "sensitivity", "optimise"),
    ),
    "Linear systems": (
        "A robot about rest, its response to frequencies, responses that were measured; loops about it: "
        "[`fx.control`](control.md).",
        ("linearize", "compliance", "transmissibility", "read_frf"),
    ),
    "Commands ahead of time": (
        "What is known of a robot beforehand, put into its motion: [chapter](../../ahead.md).",
        ("compensate", "shape", "time_optimal"),
    ),
    "Other programs": (
        "The robot as a file for others: [formats](../../exports.md).",
        ("export",),
    ),
    "Rigid robot": (
        "Kinematics and dynamics without any compliance.",
        ("inverse_kinematics", "forward_kinematics", "inverse_dynamics", "mobility"),
    ),
    "Many runs": (
        "Variants of a study, poses of a robot, settings of a computation.",
        ("sweep", "workspace_map", "converge", "ladder"),
    ),
    "Elements of your own": (
        "Classes for parts that flexapod does not have: [tutorial](../../an-element-of-your-own.md).",
        ("Element", "Key", "Quantity", "Energies", "Along", "Frame", "Output", "Contribution"),
    ),
    "Errors raised": (
        "All errors that are raised on purpose.",
        ("FlexapodError", "InputError", "ComputationError"),
    ),
    "Paper and citations": (
        "The published study, and whose work this is.",
        ("replicate", "cite", "__version__"),
    ),
}
PACKAGES = {
    "plot": True,
    "control": True,
    "study": False,
    "model": False,
    "kinematics": False,
}  # with the whole text of each name, or a line


def on_pages() -> set[str]:
    """Every name that has a page."""
    return {name for _, names in TASKS.values() for name in names} | set(PACKAGES)


def pages() -> dict[Path, str]:
    """Pages by place."""
    made = {FOLDER / f"{_file(title)}.md": _task(title, *task) for title, task in TASKS.items()}
    made |= {FOLDER / f"{name}.md": _package(name, whole=whole) for name, whole in PACKAGES.items()}
    made[FOLDER / "index.md"] = _index()
    return made


def first_line(thing: object) -> str:
    """What a thing is, in a line, for the cell of a table."""
    return (inspect.getdoc(thing) or "").split("\n\n")[0].replace("\n", " ").replace("|", "\\|")


def _file(title: str) -> str:
    return title.lower().replace(" ", "-")


def _row(name: str, place: str, thing: object) -> str:
    words = f"version of the package, `{thing}`" if isinstance(thing, str) else first_line(thing)
    return f"| [`fx.{name}`]({place}) | {words} |"


def _index() -> str:
    places = {name: f"{_file(title)}.md#fx-{name}" for title, (_, names) in TASKS.items() for name in names}
    places |= {name: f"{name}.md" for name in PACKAGES}
    places = {name: place.split("#")[0] for name, place in places.items()}
    parts = [
        "# Python",
        "`import flexapod as fx` gives all that follows, and `dir(fx)` lists just these names; what is on none of\n"
        "these pages may change without notice. Every call takes a study, a robot with its motion, or the path of\n"
        "a study file, and returns an `xarray.Dataset` in SI units ([variables](../variables/index.md)).",
        "## Ten to begin with",
        _table([_row(name, places[name], getattr(fx, name)) for name in FIRST]),
        "## By task",
    ]
    for title, (words, names) in TASKS.items():
        rows = [_row(name, places[name], getattr(fx, name)) for name in names]
        parts += [f"### {title}", words, _table(rows)]
    parts += ["### Packages", _table([_row(name, places[name], getattr(fx, name)) for name in PACKAGES])]
    listed = "\n".join([*map(_file, TASKS), *PACKAGES])
    return "\n\n".join(parts) + f"\n\n```{{toctree}}\n:hidden:\n\n{listed}\n```\n"


def _table(rows: list[str]) -> str:
    return "\n".join(["| Name | What it is |", "| --- | --- |", *rows])


def _task(title: str, words: str, names: tuple[str, ...]) -> str:
    parts = [f"# {title}", words]
    for name in names:
        thing = getattr(fx, name)
        parts += [f"## `fx.{name}`"]
        parts += (
            [f"The version of the package, as text: `{thing}`."] if isinstance(thing, str) else [_auto(name, thing)]
        )
    return "\n\n".join(parts) + "\n"


def _auto(name: str, thing: object, module: str = "flexapod") -> str:
    kind = "autoclass" if inspect.isclass(thing) else "autofunction"
    return f"```{{eval-rst}}\n.. currentmodule:: {module}\n\n.. {kind}:: {name}\n```"


def _package(name: str, *, whole: bool) -> str:
    package: ModuleType = getattr(fx, name)
    names = [n for n in package.__all__ if not n.startswith("_")]
    parts = [f"# `fx.{name}`", first_line(package)]
    if whole:
        parts += [x for n in names for x in (f"## `fx.{name}.{n}`", _auto(n, getattr(package, n), f"flexapod.{name}"))]
    else:
        rows = []
        for n in names:
            thing = getattr(package, n)
            told = first_line(thing) if callable(thing) else ""
            rows.append(f"| `{n}` | {told} |")
        parts.append(_table(rows))
    return "\n\n".join(parts) + "\n"
