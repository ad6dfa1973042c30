"""A robot's march with fixed steps as C that needs nothing else: `robot.h`, `robot.c`, and a program that runs it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from flexapod import model
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.common.piecewise_chebyshev import NODES
from flexapod.mechanics.symbolic.compiler import PRELUDE, STRAIGHT
from flexapod.output.exchange.c_source_data import OF_PAYLOAD, Channel, CMarch, prepare_c_march
from flexapod.output.exchange.formats import Content
from flexapod.solve.kernel import FOR_LOOPS, Equations, text_of_one_unit
from flexapod.solve.time import native
from flexapod.solve.time.recording import record_places

HERE = Path(__file__).parent / "c"
#: What the numbers rest on, and what makes a run as fast as those of flexapod.
FLAGS = ("-std=gnu11", "-O2", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off")
LOOPS = ("system.h", "lu.c", "legs.c", "arrow.c", "state.c", "loop.c", "march.c")
TABLES, BODIES = "/* A function as a table", "/* A lane function for `count` bodies"  # begins of parts of the prelude
WIDER = 2  # memory with vectors of another width against that with those of this machine, at most
_COUNTS = ("n", "rows", "leg_p", "joint", "command", "common", "plate", "posed", "floor", "bristles", "loop")


def c(study: model.Study, commands: str = "inputs", step: float | str | None = None) -> Content:
    """A folder with the C of a robot in fixed steps.

    Parameters
    ----------
    study : Study
    commands : str
        "inputs": the drives' commands come from outside; "motion": the study's own motion is built in.
    step : float, optional
        Length of the steps [s]; that of the study, if it has a fixed one.

    Returns
    -------
    Content
        `robot.h`, `robot.c`, `main.c`.

    Raises
    ------
    InputError
        As of `prepare_c_march`.
    """
    found = prepare_c_march(study, commands, step)
    flags = " ".join(FLAGS)
    remarks = (
        f"Compile with `cc {flags} robot.c main.c -lm`; `./a.out 1000` makes 1000 steps and prints the longest.",
        "Numbers are the same to the bit for one set of flags; vectors of another width (-mavx, -mavx512f) sum in "
        "another order.",
    )
    return Content(
        files=source_texts(found) | {"main.c": (HERE / "main.c").read_text()}, left_out=found.left_out, remarks=remarks
    )


def source_texts(found: CMarch) -> dict[str, str]:
    """`robot.h` and `robot.c` of a march."""
    before = "enum { ROBOT_ALIGNMENT"
    header = (HERE / "robot.h").read_text().replace(before, f"{_public(found)}\n{before}")
    loops = [(native.NATIVE / name).read_text() for name in LOOPS]
    equations = text_of_one_unit(found.march.system.kernel.shapes)
    parts = [
        '#include "robot.h"', "#define EXPORTED static __attribute__((unused))", _prelude(equations),
        "#if defined(__GNUC__) && !defined(__clang__)\n#pragma GCC push_options\n#endif", STRAIGHT,
        equations,
        "#if defined(__GNUC__) && !defined(__clang__)\n#pragma GCC pop_options\n#endif",
        *loops, _numbers(found), (HERE / "robot.c").read_text(),
    ]  # fmt: skip
    return {"robot.h": header, "robot.c": "\n".join(parts)}


def _prelude(equations: str) -> str:
    """C text that equations need before them; what tables are read with only where one of them is a table."""
    ours = PRELUDE.read_text().partition(BODIES)[0]
    return ours if "RowInput" in equations else ours.partition(TABLES)[0]


def _public(found: CMarch) -> str:
    """Public part of `robot.h`: sizes, the step, and a comment on each number."""
    inputs, outputs = (sum(x.size for x in channels) for channels in (found.inputs, found.outputs))
    room = found.march.system
    call = native.settings(room, GeneralizedAlpha(1.0), 1.0, 1)
    size = WIDER * native.loops(room.kernel).march_memory(native.byref(call)) + 65536 + 16 * len(found.row)
    size += 8 * (inputs + 8 * found.march.start.q.size + 2 * found.law(np.zeros(1))[0].size)
    size *= 2  # as it is, and as the last call left it
    lines = [
        f"enum {{ ROBOT_INPUTS = {inputs}, ROBOT_OUTPUTS = {outputs} }};",
        f"#define ROBOT_STEP {found.march.step!r}      /* s */",
        f"enum {{ ROBOT_BYTES = {-(-int(size) // 64) * 64} }};      /* enough for vectors of any width */",
    ]
    for words, channels in (("Inputs", found.inputs), ("Outputs", found.outputs)):
        lines.append(f"/* {words}, by the first of their numbers:")
        lines += [f"     {x.first:4d}  {x.name}{list(x.shape) or ''} [{x.units}]: {x.words}" for x in channels]
        lines[-1] += " */"
    lines += ["extern const char *const robot_input_names[], *const robot_output_names[];"]
    return "\n".join(lines)


def _labels(channels: Iterable[Channel]) -> list[str]:
    """A name for each number, as leg_force[2][1], from 1."""
    found = []
    for channel in channels:
        places = np.ndindex(channel.shape) if channel.shape else [()]
        found += [channel.name + "".join(f"[{k + 1}]" for k in place) for place in places]
    return found


def _array(name: str, values: ArrayLike, kind: str = "double") -> str:
    flat = np.ravel(np.asarray(values))
    texts = [repr(float(x)) for x in flat] if kind == "double" else [str(int(x)) for x in flat]
    rows = [", ".join(texts[k : k + 8]) for k in range(0, len(texts), 8)] or ["0"]
    return f"static const {kind} {name}[] = {{\n  " + ",\n  ".join(rows) + "};"


def _names(name: str, channels: Iterable[Channel]) -> str:
    words = ", ".join(f'"{label}"' for label in _labels(channels))
    return f"const char *const {name}[] = {{{words or '0'}}};"


def _constants(found: CMarch) -> Mapping[str, int]:
    system, firsts = found.march.system, {x.name: x.first for x in (*found.inputs, *found.outputs)}
    at = record_places(system)
    used = found.matrix != 0
    tool, quaternion, velocity = (firsts.get(name, 0) for name in list(OF_PAYLOAD)[1:])
    return {
        "LEG_COUNT": system.legs, "N_OF_LEG": system.n, "HAS_HUB": int(system.hub), "ROW_COUNT": system.rows,
        "PORT_COUNT": system.ports.size, "BRISTLE_COUNT": system.kernel.shapes.bristles,
        "PIECES": len(found.series), "TERMS": NODES, "COMMANDED": int(found.commanded), "PARTS": int(used.sum()),
        "FIRST_FORCE": firsts["control_input"], "FIRST_WRENCH": firsts.get("wrench", 0),
        "POSE_AT": at["pose"].start, "TURN_AT": at["v"].stop - 3,
        "TOOL_AT": tool, "QUATERNION_AT": quaternion, "VELOCITY_AT": velocity,
    }  # fmt: skip


def _numbers(found: CMarch) -> str:
    """All numbers of the robot."""
    system, start, robot = found.march.system, found.start, found.study.robot
    table, load = found.law(np.zeros(1))
    equations, size = _known(found), system.n
    read = dict(zip(("HELD", "HUB_HELD", "LEG_P", "JOINT_P", "PAYLOAD_P"), system.as_read_by_c, strict=True))
    arrays = read | {
        "BASE_TABLE": table, "BASE_LOAD": load, "EDGES": found.edges, "SERIES": found.series,
        "PER_TURN": found.turns, "ZERO_OF_DRIVE": found.zero, "STRETCH": found.stretch, "SHIFT": found.shift,
        "OFFSETS": found.offset,
        "TOOL_ARM": robot.tool - robot.com, "START_INPUTS": np.concatenate([x.start for x in found.inputs]),
    }  # fmt: skip
    bristles = start.bristles if start.bristles.size else np.zeros((system.legs, 2 * system.kernel.shapes.bristles))
    arrays |= {
        "START_Q": start.q, "START_V": start.v, "START_V_DOT": start.v_dot, "START_A": start.a, "START_LAM": start.lam,
        "START_DRIVE": start.drive, "START_POSE": start.pose, "START_BRISTLES": bristles, "START_SUMS": start.sums,
    }  # fmt: skip
    whole = {"DRIVE_PORT": found.drive_port, "FORCE_PORT": found.force_port, "KEEPS": found.keeps}
    lists = {"ORDER_OF": equations.order[:size], "PLACE_OF": equations.place[:size]}
    rows, columns = np.nonzero(found.matrix)
    parts = ", ".join(f"{{{i}, {j}, {float(found.matrix[i, j])!r}}}" for i, j in zip(rows, columns, strict=True))
    return "\n".join(
        [
            "enum { " + ", ".join(f"{name} = {value}" for name, value in _constants(found).items()) + " };",
            *(_array(name, values) for name, values in arrays.items()),
            *(_array(name, values, "int") for name, values in whole.items()),
            *(_array(name, values, "long") for name, values in lists.items()),
            f"static const struct {{ int output, at; double times; }} PART[] = {{{parts}}};",
            _names("robot_input_names", found.inputs),
            _names("robot_output_names", found.outputs),
            _equations(found),
            _settings(found),
        ]
    )


def _known(found: CMarch) -> Equations:
    """Equations as compiled loops know them; `prepare_c_march` refuses others."""
    equations = found.march.system.kernel.equations
    if equations is None:
        raise RuntimeError("these equations are not compiled")
    return equations


def _equations(found: CMarch) -> str:
    equations = _known(found)
    there = [name for name in FOR_LOOPS if getattr(equations, name)]
    kinds = {name: "double" if name.startswith("payload") else "lanes" for name in there}
    fields = [f".{name} = {getattr(equations, name)}" for name in _COUNTS]
    fields += [".order = ORDER_OF", ".place = PLACE_OF", *(f".{name} = {name}_{kinds[name]}" for name in there)]
    return f"static const Equations EQUATIONS = {{{', '.join(fields)}}};"


def _settings(found: CMarch) -> str:
    system, method = found.march.system, found.march.problem.method
    weights = {name: repr(float(getattr(method, name))) for name in ("alpha_m", "alpha_f", "beta", "gamma")}
    fields = {
        "of": "&EQUATIONS", "legs": system.legs, "hub": int(system.hub), "ports": system.ports.size,
        "port": "{" + ", ".join(map(str, system.ports.tolist())) + "}",
        "held": "HELD", "hub_held": "HUB_HELD", "leg_p": "LEG_P", "joint_p": "JOINT_P", "payload_p": "PAYLOAD_P",
        "h": repr(float(found.march.step)), **weights,
        "tol_closure": native.TOL_CLOSURE, "tol_force": native.TOL_FORCE, "force_floor": repr(system.force_floor),
        "max_iterations": native.MAX_ITERATIONS, "max_age": native.MAX_AGE * (8 if system.n > native.LARGE else 1),
        "output_every": 1,
    }  # fmt: skip
    return "#define SETTINGS {" + ", ".join(f".{name} = {value}" for name, value in fields.items()) + "}"
