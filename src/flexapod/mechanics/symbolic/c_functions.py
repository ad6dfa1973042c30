"""Functions of one or two numbers that C has besides roots, exponentials, sines and cosines, and their C text.

A text with one of them defines it once, lane by lane from libm; texts without them stay what they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import casadi


class CFunction(NamedTuple):
    """A function by its name in C, and what it is of x and y [of x alone where it takes one number]."""

    name: str
    value: str


#: By casadi's operations: comparisons are 1 or 0, as casadi has them.
FUNCTIONS: dict[int, CFunction] = {
    getattr(casadi, f"OP_{operation}"): CFunction(f"of_{operation.lower()}", value)
    for operation, value in {
        "LOG": "log(x)",
        "LOG1P": "log1p(x)",
        "EXPM1": "expm1(x)",
        "POW": "pow(x, y)",
        "CONSTPOW": "pow(x, y)",
        "HYPOT": "hypot(x, y)",
        "TAN": "tan(x)",
        "ASIN": "asin(x)",
        "ACOS": "acos(x)",
        "ATAN": "atan(x)",
        "ATAN2": "atan2(x, y)",
        "SINH": "sinh(x)",
        "COSH": "cosh(x)",
        "TANH": "tanh(x)",
        "ASINH": "asinh(x)",
        "ACOSH": "acosh(x)",
        "ATANH": "atanh(x)",
        "ERF": "erf(x)",
        "FABS": "fabs(x)",
        "SIGN": "x < 0 ? -1 : x > 0 ? 1 : x",
        "COPYSIGN": "copysign(x, y)",
        "FLOOR": "floor(x)",
        "CEIL": "ceil(x)",
        "FMOD": "fmod(x, y)",
        "REMAINDER": "remainder(x, y)",
        "FMIN": "fmin(x, y)",
        "FMAX": "fmax(x, y)",
        "LT": "x < y",
        "LE": "x <= y",
        "EQ": "x == y",
        "NE": "x != y",
        "NOT": "!x",
        "AND": "x && y",
        "OR": "x || y",
        "IF_ELSE_ZERO": "x ? y : 0",
        "LIFT": "x",
    }.items()
}
#: Written as operators or by hand in `lanes.h`, and what moves values.
_OTHERS = frozenset(
    getattr(casadi, f"OP_{name}")
    for name in (
        *("ADD", "SUB", "MUL", "DIV", "NEG", "SQ", "TWICE", "INV", "SQRT", "EXP", "SIN", "COS", "ASSIGN"),
        *("CONST", "INPUT", "OUTPUT"),
    )
)


def without_text(function: casadi.Function) -> list[str]:
    """Names of a function's operations that have no C text, as casadi calls them."""
    found = {function.instruction_id(i) for i in range(function.n_instructions())}
    known = {getattr(casadi, name): name[3:].lower() for name in dir(casadi) if name.startswith("OP_")}
    return sorted(known[operation] for operation in found - _OTHERS - set(FUNCTIONS))


def definitions(function: casadi.Function) -> Iterator[str]:
    """C text of the functions that a casadi function needs; a unit may have it several times."""
    found = {function.instruction_id(i) for i in range(function.n_instructions())}
    for name, value in sorted(FUNCTIONS[operation] for operation in found & set(FUNCTIONS)):
        yield from (
            f"#ifndef {name.upper()}",
            f"#define {name.upper()}",
            f"static inline double double_{name}(double x, double y) {{ (void)y; return {value}; }}",
            f"static inline lanes lanes_{name}(lanes x, lanes y) {{",
            f"  for (int i = 0; i < LANES; i++) x[i] = double_{name}(x[i], y[i]);",
            "  return x;",
            "}",
            "#endif",
        )


def constant_text(number: float) -> str:
    """A number as C has it."""
    return {"inf": "INFINITY", "-inf": "-INFINITY", "nan": "NAN"}.get(repr(number), repr(number))


def call(name: str, kind: str, of: Iterable[str]) -> str:
    """C text of a call with one or two values; constants, in brackets, become vectors."""
    found = [f"{x} - ({kind}){{0}}" if x.startswith("(") else x for x in of]
    return f"{kind}_{name}({found[0]}, {found[-1]})"
