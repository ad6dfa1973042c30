"""Vocabulary in which the equations are written; casadi loads with the first of these: tables do without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.lazy_imports import LazyModule

if TYPE_CHECKING:
    import casadi
    from casadi import SX
else:
    casadi = LazyModule("casadi")


def __getattr__(name: str) -> Any:
    if name == "SX":
        return casadi.SX
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def cos(x: Any) -> Any:
    """Cosine [rad], of symbols or numbers."""
    return x.cos() if hasattr(x, "cos") else np.cos(x)


def sin(x: Any) -> Any:
    """Sine [rad], of symbols or numbers."""
    return x.sin() if hasattr(x, "sin") else np.sin(x)


def exp(x: Any) -> Any:
    """Exponential, of symbols or numbers."""
    return x.exp() if hasattr(x, "exp") else np.exp(x)


def sqrt(x: Any) -> Any:
    """Square root, of symbols or numbers."""
    return x.sqrt() if hasattr(x, "sqrt") else np.sqrt(x)


def dot(a: SX, b: SX) -> SX:
    """Scalar product of two columns."""
    return casadi.dot(a, b)


def mtimes(a: SX, b: SX) -> SX:
    """Product of two matrices."""
    return casadi.mtimes(a, b)


def trace(matrix: SX) -> SX:
    """Sum of the diagonal."""
    return casadi.trace(matrix)


def vertcat(*parts: SX | float) -> SX:
    """Matrices one below the other."""
    return casadi.vertcat(*parts)


def horzcat(*parts: SX | float) -> SX:
    """Matrices one beside the other."""
    return casadi.horzcat(*parts)


def diagcat(*parts: SX) -> SX:
    """Blocks along the diagonal."""
    return casadi.diagcat(*parts)


def reshape(matrix: SX, *shape: int) -> SX:
    """The same entries, column by column, in another shape."""
    return casadi.reshape(matrix, *shape)


def gradient(expression: SX, x: SX) -> SX:
    """Column of first derivatives of a scalar."""
    return casadi.gradient(expression, x)


def jacobian(expression: SX, x: SX) -> SX:
    """Matrix of first derivatives."""
    return casadi.jacobian(expression, x)


def jtimes(expression: SX, x: SX, way: SX) -> SX:
    """Directional derivative."""
    return casadi.jtimes(expression, x, way)


def symbol(name: str, size: int = 1) -> SX:
    """Column of ``size`` symbols."""
    return casadi.SX.sym(name, size)


def constant(array: ArrayLike) -> SX:
    """Numeric array as a dense symbolic constant."""
    return casadi.SX(np.atleast_2d(np.asarray(array, dtype=float)) if np.ndim(array) else float(np.asarray(array)))


def zeros(rows: int, columns: int = 1) -> SX:
    """Matrix of zeros."""
    return casadi.SX.zeros(rows, columns)


def identity(size: int) -> SX:
    """Matrix of ones on the diagonal."""
    return casadi.SX.eye(size)


def substitute(expression: SX, old: Sequence[SX], new: Sequence[SX]) -> SX:
    """Expression with every ``old`` symbol replaced by its ``new`` expression."""
    return casadi.substitute([expression], list(old), list(new))[0]


def depends_on(expression: SX, x: SX) -> bool:
    """Test whether any symbol of a column is in an expression."""
    return bool(x.numel()) and casadi.depends_on(expression, x)


def cross(a: SX, b: SX) -> SX:
    """Vector product of two columns of three."""
    return vertcat(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def hessian(expression: SX, x: SX) -> SX:
    """Matrix of second derivatives."""
    return casadi.hessian(expression, x)[0]


@dataclass(frozen=True, kw_only=True)
class ChainRule:
    """Derivatives by x of expressions that are written in x and in a few symbols y that stand for functions of x."""

    x: SX
    y: SX
    of_x: SX

    def value(self, expression: SX) -> SX:
        """Expression in x alone."""
        return substitute(expression, (self.y,), (self.of_x,))

    def gradient(self, expression: SX) -> SX:
        """Column of first derivatives."""
        inner = self.value(gradient(expression, self.y))
        return self.value(gradient(expression, self.x)) + jacobian(self.of_x, self.x).T @ inner

    def jacobian(self, expression: SX) -> SX:
        """Matrix of first derivatives."""
        return self.value(jacobian(expression, self.x)) + self.value(jacobian(expression, self.y)) @ jacobian(
            self.of_x, self.x
        )

    def hessian(self, expression: SX) -> SX:
        """Matrix of second derivatives."""
        xx, yy = hessian(expression, self.x), hessian(expression, self.y)
        by_x, by_y = gradient(expression, self.x), gradient(expression, self.y)
        inner = jacobian(self.of_x, self.x)
        mixed = self.value(jacobian(by_x, self.y)) @ inner
        bend = sum((self.value(by_y)[i] * hessian(self.of_x[i], self.x) for i in range(self.y.numel())), zeros(1))
        return self.value(xx) + mixed + mixed.T + inner.T @ self.value(yy) @ inner + bend


def matrix33(columns: SX) -> SX:
    """3 x 3 matrix from its nine entries, column by column."""
    return reshape(columns, 3, 3)


def quadratic(x: SX, matrix: np.ndarray | SX) -> SX:
    """x^T matrix x for a symmetric matrix, summed over one triangle; zero when there are no shapes."""
    if not x.numel():
        return zeros(1)
    if isinstance(matrix, casadi.SX):
        return dot(x, mtimes(2 * casadi.triu(matrix, False) + casadi.diag(casadi.diag(matrix)), x))
    triangle = 2 * np.triu(matrix, 1) + np.diag(np.diag(matrix))
    return dot(x, mtimes(casadi.SX(casadi.sparsify(casadi.DM(triangle))), x))


def bilinear(x: SX, matrix: np.ndarray | SX, y: SX) -> SX:
    """x^T matrix y; zero when either has no shapes."""
    if not (x.numel() and y.numel()):
        return zeros(1)
    return dot(x, mtimes(casadi.sparsify(casadi.SX(matrix)), y))


def taylor_series(expressions: Sequence[SX], x: SX) -> tuple[list[SX], tuple[SX, SX]]:
    """Expressions of a symbol as their Taylor series of second order about its value; what stands for that value.

    To be differentiated twice at most, by anything: what is in the expressions is differentiated here, by x alone.
    Returned are the series, and (symbols, what to put for them in the end).
    """
    value = casadi.densify(vertcat(*(reshape(e, e.numel(), 1) for e in expressions)))
    slope = jtimes(value, x, casadi.SX(1.0))
    known = vertcat(x, value, slope, jtimes(slope, x, casadi.SX(1.0)))
    at, n = symbol("at", known.numel()), value.numel()
    step = x - at[0]
    series = at[1 : n + 1] + step * (at[n + 1 : 2 * n + 1] + step / 2 * at[2 * n + 1 :])
    found, start = [], 0
    for e in expressions:
        found.append(reshape(series[start : start + e.numel()], *e.shape))
        start += e.numel()
    return found, (at, known)


def time_derivative(expression: SX, *pairs: tuple[SX, SX]) -> SX:
    """d/dt of an expression by the chain rule; ``pairs`` are (variable, its rate)."""
    return sum((jtimes(expression, x, x_dot) for x, x_dot in pairs), casadi.SX.zeros(*expression.shape))


def symbols(layout: Sequence[tuple[str, int]], name: str) -> tuple[SX, SimpleNamespace]:
    """One symbolic column and its named pieces, in the order of ``layout`` (name, size)."""
    column = casadi.SX.sym(name, sum(size for _, size in layout))
    return column, split(column, layout)


def split(column: SX, layout: Sequence[tuple[str, int]]) -> SimpleNamespace:
    """Return the named pieces of a column."""
    pieces, start = {}, 0
    for key, size in layout:
        pieces[key] = column[start : start + size]
        start += size
    return SimpleNamespace(**pieces)


def weighted_gram(left: SX, weight: SX, right: SX) -> SX:
    """Inner products of rows (m, K) and (n, K) under weights (1, K), (m, n)."""
    return (left * repeat_row(weight, left)) @ right.T


def repeat_row(row: SX, like: SX) -> SX:
    """Matrix of the rows of another one, each the given row."""
    return vertcat(*[row] * like.shape[0])
