"""Generated functions as C: every operation once, for several bodies at a time."""

from collections.abc import Iterator

import casadi

from flexapod.symbolic.functions import NamedFunction

__all__ = ["c_source"]

#: What a value may be: one number, or a vector with a lane for each body.
KINDS = ("double", "lanes")
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
    """C text of a function: ``NAME_double`` (one body), ``NAME_lanes`` (a vector of bodies), ``NAME`` (any number).

    Parameters
    ----------
    function : NamedFunction
        Made of sums, products, quotients, square roots, exponentials, sines and cosines.

    Raises
    ------
    ValueError
        An operation is none of these.
    """
    name, built = function.name, function.build()
    sizes = [built.numel_in(k) for k in range(built.n_in())], [built.numel_out(k) for k in range(built.n_out())]
    inputs, outputs = (", ".join(map(str, x)) for x in sizes)
    head = "static void {0}_{1}(const {1} *const *in, {1} *const *out) {{"
    return "\n".join(
        [
            *(line for kind in KINDS for line in (head.format(name, kind), *_statements(built, kind), "}")),
            f"void {name}(long count, const double *const *in, const long *rows, double *const *out) {{",
            f"  static const long in_size[] = {{{inputs}}}, out_size[] = {{{outputs}}};",
            f"  lanes work[{sum(map(sum, sizes))}];",
            f"  each_body({name}_lanes, count, {built.n_in()}, in_size, in, rows,",
            f"            {built.n_out()}, out_size, out, work);",
            "}\n",
        ]
    )


def _statements(f: casadi.Function, kind: str) -> Iterator[str]:
    """Statements in single assignment form; constants stand where they are used."""
    values: dict[int, str] = {}  # what each place of casadi's work vector holds
    turned: dict[str, int] = {}  # angles whose sine and cosine are there
    for i in range(f.n_instructions()):
        operation, to, of = f.instruction_id(i), f.instruction_output(i), f.instruction_input(i)
        if operation == casadi.OP_OUTPUT:
            yield f"  out[{to[0]}][{to[1]}] = ({kind}){{0}} + {values[of[0]]};"
        elif operation == casadi.OP_CONST:
            values[to[0]] = f"({f.instruction_constant(i)!r})"
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
    raise ValueError(f"operation {operation} of casadi has no C text here")
