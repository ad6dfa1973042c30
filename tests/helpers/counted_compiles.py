"""A function of next to no code through the cache of kernels, and how often it was built."""

import numpy as np

from flexapod.mechanics.symbolic import compiler
from flexapod.mechanics.symbolic.compiler import CompiledFunction, compiled_library
from flexapod.mechanics.symbolic.functions import NamedFunction
from flexapod.mechanics.symbolic.vocabulary import symbol


def functions(factor: float) -> list[NamedFunction]:
    x = symbol("x", 3)
    return [NamedFunction("scaled", [("x", x)], [("y", factor * x)])]


class Compile:
    """`compile(2.0)`: the function that doubles, through the cache; counts how often it was built."""

    def __init__(self) -> None:
        self.built = 0

    def __call__(self, factor: float = 2.0, *comments: str) -> np.ndarray:
        def build() -> list[NamedFunction]:
            self.built += 1
            return functions(factor)

        library, signatures = compiled_library([factor, *comments], build, compiler.compiler())
        return CompiledFunction(library, "scaled", signatures["scaled"])([1.0, 2.0, 3.0])[0]


def doubled(values: np.ndarray) -> bool:
    return values.tolist() == [2.0, 4.0, 6.0]  # doubling rounds nothing
