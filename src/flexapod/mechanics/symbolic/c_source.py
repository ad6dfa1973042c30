"""Generated functions as C: every operation once, for several bodies at a time."""

import re
from collections.abc import Iterator, Sequence

import casadi

from flexapod.mechanics.symbolic.c_functions import FUNCTIONS, call, constant_text, definitions
from flexapod.mechanics.symbolic.c_rows import row_table
from flexapod.mechanics.symbolic.functions import NamedFunction

#: Statements beyond which a C function is written in parts, and those of a part: the time and memory of a compiler grow
#: faster than the text, while a residual in parts takes some per cent longer.
WHOLE, LONGEST = 6000, 2500
PART = "static __attribute__((noinline)) void"
#: Operations beyond which a function is a table: as statements each costs a compiler 0.2 ms.
TABLED = 30_000
_VALUE = re.compile(r"\b[tsc]\d+\b")
_BINARY = {casadi.OP_ADD: "+", casadi.OP_SUB: "-", casadi.OP_MUL: "*", casadi.OP_DIV: "/"}
_UNARY = {
    casadi.OP_NEG: "-{0}",
    casadi.OP_SQ: "{0} * {0}",
    casadi.OP_TWICE: "{0} + {0}",
    casadi.OP_INV: "1.0 / {0}",
    casadi.OP_SQRT: "{1}_sqrt({0})",
    casadi.OP_EXP: "{1}_exp({0})",
    casadi.OP_ASSIGN: "{0}",
}


def c_source(function: NamedFunction) -> str:
    """C text of a function: ``NAME_lanes`` (a vector of bodies), ``NAME`` (any number), ``NAME_double`` (one body).

    The last where it is called alone: what nobody calls takes the compiler a third of its memory.

    Parameters
    ----------
    function : NamedFunction
        Made of sums, products, quotients, square roots, exponentials, sines, cosines and `c_functions.FUNCTIONS`.

    Raises
    ------
    ValueError
        An operation is none of these.
    """
    name, built = function.name, function.build()
    sizes = [built.numel_in(k) for k in range(built.n_in())], [built.numel_out(k) for k in range(built.n_out())]
    inputs, outputs = (", ".join(map(str, x)) for x in sizes)
    return "\n".join(
        [
            *_kinds(function, built, ("double", "lanes") if function.alone else ("lanes",)),
            f"void {name}(long count, const double *const *in, const long *rows, double *const *out) {{",
            f"  static const long in_size[] = {{{inputs}}}, out_size[] = {{{outputs}}};",
            f"  lanes work[{sum(map(sum, sizes))}];",
            f"  each_body({name}_lanes, count, {built.n_in()}, in_size, in, rows,",
            f"            {built.n_out()}, out_size, out, work);",
            "}\n",
        ]
    )


def unit_source(function: NamedFunction) -> str:
    """C text for callers in the same unit: ``NAME_double`` where it is called for one body, else ``NAME_lanes``."""
    lines = _kinds(function, function.build(), ("double",) if function.alone else ("lanes",))
    lines = [f"{x}\n  (void)in; (void)out; (void)w;" if x.startswith(PART) else x for x in lines]
    return "\n".join(f"static {x}" if x.startswith("void ") else x for x in lines) + "\n"


def _kinds(function: NamedFunction, built: casadi.Function, kinds: Sequence[str]) -> list[str]:
    lines = [line for kind in kinds for line in _lines(f"{function.name}_{kind}", kind, built)]
    return [*definitions(built), *lines]


def _lines(name: str, kind: str, built: casadi.Function) -> Iterator[str]:
    if kind == "lanes" and built.n_instructions() > TABLED:
        return row_table(name, built)
    return _definition(name, kind, list(_statements(built, kind)))


def _definition(name: str, kind: str, statements: list[str]) -> Iterator[str]:
    """A function of these statements, in parts where they are many; `w` holds what a later part needs."""
    taken = f"const {kind} *const *in, {kind} *const *out"
    if len(statements) <= WHOLE:
        yield from (f"void {name}({taken}) {{", *statements, "}")
        return
    parts = [statements[k : k + LONGEST] for k in range(0, len(statements), LONGEST)]
    found = [set(_VALUE.findall("\n".join(part))) for part in parts]
    places: dict[str, int] = {}
    for k, part in enumerate(parts):
        later = set().union(*found[k + 1 :])
        here = {value: f"w[{place}]" for value, place in places.items() if value in found[k]}
        yield f"{PART} {name}_{k}({taken}, {kind} *restrict w) {{"
        for line in part:
            yield _VALUE.sub(lambda match, here=here: here.get(match[0], match[0]), line)
            for value in line.split("=")[0].split(";")[0].replace(",", " ").split()[1:]:  # what it declares
                if _VALUE.fullmatch(value) and value in later:
                    places[value] = len(places)
                    yield f"  w[{places[value]}] = {value};"
        yield "}"
    calls = (f"  {name}_{k}(in, out, w);" for k in range(len(parts)))
    yield from (f"void {name}({taken}) {{", f"  {kind} w[{len(places)}];", *calls, "}")


def _statements(f: casadi.Function, kind: str) -> Iterator[str]:
    """Statements in single assignment form; constants stand where they are used."""
    values: dict[int, str] = {}  # what each place of casadi's work vector holds
    turned: dict[str, int] = {}  # angles whose sine and cosine are there
    for i in range(f.n_instructions()):
        operation, to, of = f.instruction_id(i), f.instruction_output(i), f.instruction_input(i)
        if operation == casadi.OP_OUTPUT:
            yield f"  out[{to[0]}][{to[1]}] = ({kind}){{0}} + {values[of[0]]};"
        elif operation == casadi.OP_CONST:
            values[to[0]] = f"({constant_text(f.instruction_constant(i))})"
        elif operation in (casadi.OP_SIN, casadi.OP_COS):
            angle = values[of[0]]
            if angle not in turned:
                turned[angle] = i
                yield f"  {kind} s{i}, c{i}; {kind}_turn(({kind}){{0}} + {angle}, &s{i}, &c{i});"
            values[to[0]] = f"{'s' if operation == casadi.OP_SIN else 'c'}{turned[angle]}"
        else:
            yield f"  const {kind} t{i} = {_expression(operation, of, values, kind)};"
            values[to[0]] = f"t{i}"


def _expression(operation: int, of: list[int], values: dict[int, str], kind: str) -> str:
    if operation == casadi.OP_INPUT:
        return f"in[{of[0]}][{of[1]}]"
    if operation in _BINARY:
        return f"{values[of[0]]} {_BINARY[operation]} {values[of[1]]}"
    if operation in _UNARY:
        return _UNARY[operation].format(values[of[0]], kind)
    if operation in FUNCTIONS:
        return call(FUNCTIONS[operation].name, kind, (values[x] for x in of))
    raise ValueError(f"operation {operation} of casadi has no C text here")
