"""Functions too long for a compiler as a table of rows, sums of products, that a loop of `lanes.h` reads.

To the last bit what the same operations give as statements: 1 x and -1 x are exact, and sums keep their order.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import casadi

from flexapod.mechanics.symbolic.c_functions import FUNCTIONS, constant_text

#: Rows that are no sum of products, by the number that stands for them in the table; sums by their number of terms.
KINDS = {"quotient": 100, "root": 101, "exponential": 102, "sine": 103, "cosine": 104}
MOST = 99  # terms of a row
_ONE_OF_TWO = {
    casadi.OP_SQRT: "root",
    casadi.OP_EXP: "exponential",
    casadi.OP_SIN: "sine",
    casadi.OP_COS: "cosine",
}
Terms = list[tuple[int, int]]
_SUMS: dict[int, Callable[[int, int, "_Rows"], Terms]] = {
    casadi.OP_ADD: lambda a, b, x: [(a, x.one), (b, x.one)],
    casadi.OP_SUB: lambda a, b, x: [(a, x.one), (b, x.minus)],
    casadi.OP_MUL: lambda a, b, x: [(a, b)],
    casadi.OP_SQ: lambda a, b, x: [(a, a)],
    casadi.OP_TWICE: lambda a, b, x: [(a, x.two)],
    casadi.OP_NEG: lambda a, b, x: [(a, x.minus)],
    casadi.OP_ASSIGN: lambda a, b, x: [(a, x.one)],
}


class _Rows:
    """Operations of a function: what is known before (constants, inputs) and rows, by value; outputs."""

    def __init__(self, f: casadi.Function) -> None:
        self.known: dict[int, tuple[int, int, float]] = {}  # input and place in it; -1 and 0 of a constant
        self.sums: dict[int, Terms] = {}
        self.others: dict[int, tuple[str, int, int]] = {}
        self.outputs: list[tuple[int, int, int]] = []
        self._constants: dict[str, int] = {}
        self._count = 0
        self.one, self.minus, self.two = (self._constant(c) for c in (1.0, -1.0, 2.0))
        held: dict[int, int] = {}  # value in each place of casadi's work vector
        for i in range(f.n_instructions()):
            operation, to, of = f.instruction_id(i), f.instruction_output(i), f.instruction_input(i)
            if operation == casadi.OP_OUTPUT:
                self.outputs.append((to[0], to[1], held[of[0]]))
            elif operation == casadi.OP_CONST:
                held[to[0]] = self._constant(f.instruction_constant(i))
            elif operation == casadi.OP_INPUT:
                held[to[0]] = self._new(self.known, (of[0], of[1], 0.0))
            else:
                held[to[0]] = self._row(operation, [held[x] for x in of])
        self._gather()

    def _new(self, into: dict[int, Any], what: object) -> int:
        into[self._count] = what
        self._count += 1
        return self._count - 1

    def _constant(self, c: float) -> int:
        key = float(c).hex()  # tells 0 from -0
        if key not in self._constants:
            self._constants[key] = self._new(self.known, (-1, 0, float(c)))
        return self._constants[key]

    def _row(self, operation: int, of: Sequence[int]) -> int:
        a, b = of[0], of[-1]
        if operation in _SUMS:
            return self._new(self.sums, _SUMS[operation](a, b, self))
        if operation in (casadi.OP_DIV, casadi.OP_INV):
            return self._new(self.others, ("quotient", a if operation == casadi.OP_DIV else self.one, b))
        if operation in _ONE_OF_TWO:
            return self._new(self.others, (_ONE_OF_TWO[operation], a, a))
        if operation in FUNCTIONS:
            return self._new(self.others, (FUNCTIONS[operation].name, a, b))
        raise ValueError(f"operation {operation} of casadi has no row here")

    def of(self, value: int) -> list[int]:
        """Values that a row reads."""
        if value in self.sums:
            return [x for term in self.sums[value] for x in term]
        return list(self.others[value][1:])

    def kind(self, value: int) -> int | str:
        """The number that stands for a row in the table, or the name of a function that no row can have."""
        return len(self.sums[value]) if value in self.sums else KINDS.get(self.others[value][0], self.others[value][0])

    def _gather(self) -> None:
        """Sums and products that one sum alone reads become its terms."""
        used = [0] * self._count
        for value in (*self.sums, *self.others):
            for x in self.of(value):
                used[x] += 1
        for *_, value in self.outputs:
            used[value] += 1
        for value, terms in list(self.sums.items()):
            if len(terms) < 2:
                continue
            # A sum of two; either may come first.
            whole = [used[x] == 1 and y == self.one and len(self.sums.get(x, terms * MOST)) < MOST for x, y in terms]
            first, last = terms if whole[0] or not whole[1] else terms[::-1]
            start = self.sums.pop(first[0]) if any(whole) else [first]
            if used[last[0]] == 1 and last[1] == self.one and len(self.sums.get(last[0], terms)) == 1:
                last = self.sums.pop(last[0])[0]
            self.sums[value] = [*start, last]

    def batches(self) -> Iterator[tuple[int | str, list[int]]]:
        """Rows of one kind after each other, so that a processor guesses what comes next; each after what it reads."""
        waits: dict[int, int] = {}
        readers: dict[int, list[int]] = {}
        ready: dict[int | str, list[int]] = {}
        for value in (*self.sums, *self.others):
            needs = {x for x in self.of(value) if x not in self.known}
            waits[value] = len(needs)
            for x in needs:
                readers.setdefault(x, []).append(value)
            if not needs:
                ready.setdefault(self.kind(value), []).append(value)
        while any(ready.values()):
            kind = max(ready, key=lambda kind: len(ready[kind]))
            found = []
            while ready[kind]:
                found.append(ready[kind].pop())
                for value in readers.get(found[-1], ()):
                    waits[value] -= 1
                    if not waits[value]:
                        ready.setdefault(self.kind(value), []).append(value)
            yield kind, found


def row_table(name: str, f: casadi.Function) -> Iterator[str]:
    """C text of a lane function as a table.

    Parameters
    ----------
    name : str
    f : casadi.Function
        Made of sums, products, quotients, square roots, exponentials, sines, cosines and `c_functions.FUNCTIONS`.

    Raises
    ------
    ValueError
        An operation is none of these.
    """
    rows = _Rows(f)
    batches = list(rows.batches())
    order = [value for _, batch in batches for value in batch]
    last = {x: value for value in order for x in rows.of(value)} | {value: -1 for *_, value in rows.outputs}
    place = {value: k for k, value in enumerate(rows.known)}
    free: list[int] = []
    most, table, parts = len(place), [], []  # parts: tables, and calls between them
    for kind, batch in batches:
        if isinstance(kind, str):
            parts, table = [*parts, table], []
        else:
            table += [kind, len(batch)]
        for value in batch:
            of = rows.of(value)
            read = [place[x] for x in of]
            free += [place[x] for x in dict.fromkeys(of) if last[x] == value and x not in rows.known]
            place[value] = free.pop() if free else most
            most += place[value] == most
            if isinstance(kind, str):
                parts.append(f"  w[{place[value]}] = lanes_{kind}(w[{read[0]}], w[{read[-1]}]);")
            else:
                table += [*read, place[value]]
    results = [(k, j, place[value]) for k, j, value in rows.outputs]
    yield f"void {name}(const lanes *const *in, lanes *const *out) {{"
    yield from _tables([*parts, table], rows, results, most)
    yield "}"


def _tables(parts: list[Any], rows: _Rows, results: list[tuple[int, int, int]], most: int) -> Iterator[str]:
    """Tables and what is called between them: the first one reads inputs, the last one writes outputs."""
    tables = [k for k, part in enumerate(parts) if not isinstance(part, str)]
    called = {k: "table" if len(tables) == 1 else f"table{k}" for k in tables}
    yield from (f"  static const unsigned {called[k]}[] = {{{_list([*parts[k], 0])}}};" for k in tables)
    yield f"  static const RowInput known[] = {{{_list(rows.known.values())}}};"
    yield f"  static const RowOutput results[] = {{{_list(results)}}};"
    yield f"  static _Thread_local lanes w[{most}];"
    for k, part in enumerate(parts):
        if isinstance(part, str):
            yield part
            continue
        inputs, outputs = len(rows.known) if k == tables[0] else 0, len(results) if k == tables[-1] else 0
        yield f"  rows({called[k]}, {inputs}, known, {outputs}, results, in, out, w);"


def _list(items: Iterable[object]) -> str:
    return ",".join(f"{{{_list(x)}}}" if isinstance(x, tuple) else _text(x) for x in items)


def _text(number: object) -> str:
    return constant_text(number) if isinstance(number, float) else repr(number)
