"""Elementary functions beside those of `vocabulary`, of symbols or numbers: for the energies of elements."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.common.lazy_imports import LazyModule
from flexapod.mechanics.symbolic.vocabulary import cos, exp, sin, sqrt

if TYPE_CHECKING:
    import casadi
else:
    casadi = LazyModule("casadi")

__all__ = [
    "acos",
    "acosh",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "ceil",
    "copysign",
    "cos",
    "cosh",
    "erf",
    "exp",
    "expm1",
    "fabs",
    "floor",
    "fmax",
    "fmin",
    "fmod",
    "hypot",
    "log",
    "log1p",
    "logic_and",
    "logic_not",
    "logic_or",
    "sign",
    "sin",
    "sinh",
    "sqrt",
    "tan",
    "tanh",
    "where",
]


def log(x: Any) -> Any:
    """Natural logarithm, of symbols or numbers."""
    return _either("log", np.log, x)


def log1p(x: Any) -> Any:
    """Natural logarithm of 1 + x, of symbols or numbers."""
    return _either("log1p", np.log1p, x)


def expm1(x: Any) -> Any:
    """Exponential less 1, of symbols or numbers."""
    return _either("expm1", np.expm1, x)


def tan(x: Any) -> Any:
    """Tangent [rad], of symbols or numbers."""
    return _either("tan", np.tan, x)


def asin(x: Any) -> Any:
    """Inverse sine [rad], of symbols or numbers."""
    return _either("asin", np.arcsin, x)


def acos(x: Any) -> Any:
    """Inverse cosine [rad], of symbols or numbers."""
    return _either("acos", np.arccos, x)


def atan(x: Any) -> Any:
    """Inverse tangent [rad], of symbols or numbers."""
    return _either("atan", np.arctan, x)


def sinh(x: Any) -> Any:
    """Hyperbolic sine, of symbols or numbers."""
    return _either("sinh", np.sinh, x)


def cosh(x: Any) -> Any:
    """Hyperbolic cosine, of symbols or numbers."""
    return _either("cosh", np.cosh, x)


def tanh(x: Any) -> Any:
    """Hyperbolic tangent, of symbols or numbers."""
    return _either("tanh", np.tanh, x)


def asinh(x: Any) -> Any:
    """Inverse hyperbolic sine, of symbols or numbers."""
    return _either("asinh", np.arcsinh, x)


def acosh(x: Any) -> Any:
    """Inverse hyperbolic cosine, of symbols or numbers."""
    return _either("acosh", np.arccosh, x)


def atanh(x: Any) -> Any:
    """Inverse hyperbolic tangent, of symbols or numbers."""
    return _either("atanh", np.arctanh, x)


def fabs(x: Any) -> Any:
    """Absolute value, of symbols or numbers."""
    return _either("fabs", np.abs, x)


def sign(x: Any) -> Any:
    """Sign: 1, 0 or -1, of symbols or numbers."""
    return _either("sign", np.sign, x)


def floor(x: Any) -> Any:
    """Largest integer that is not above x, of symbols or numbers."""
    return _either("floor", np.floor, x)


def ceil(x: Any) -> Any:
    """Smallest integer that is not below x, of symbols or numbers."""
    return _either("ceil", np.ceil, x)


def atan2(y: Any, x: Any) -> Any:
    """Angle of the point (x, y) [rad], of symbols or numbers."""
    return _either("atan2", np.arctan2, y, x)


def hypot(x: Any, y: Any) -> Any:
    """Root of the sum of two squares, of symbols or numbers."""
    return _either("hypot", np.hypot, x, y)


def fmin(x: Any, y: Any) -> Any:
    """Smaller of two, of symbols or numbers."""
    return _either("fmin", np.fmin, x, y)


def fmax(x: Any, y: Any) -> Any:
    """Larger of two, of symbols or numbers."""
    return _either("fmax", np.fmax, x, y)


def fmod(x: Any, y: Any) -> Any:
    """Rest of x over y, with the sign of x, of symbols or numbers."""
    return _either("fmod", np.fmod, x, y)


def copysign(x: Any, y: Any) -> Any:
    """Absolute value of x with the sign of y, of symbols or numbers."""
    return _either("copysign", np.copysign, x, y)


def erf(x: Any) -> Any:
    """Error function, of symbols or numbers."""
    return _either("erf", np.vectorize(math.erf, otypes=[float]), x)


def where(condition: Any, x: Any, y: Any) -> Any:
    """First of two where a condition holds, as `a < b`, else the second; of symbols or numbers.

    Both are evaluated and differentiated: neither may be without a value where the other one holds.
    """
    return _either("if_else", np.where, condition, x, y)


def logic_and(x: Any, y: Any) -> Any:
    """Condition that both conditions hold, of symbols or numbers."""
    return _either("logic_and", np.logical_and, x, y)


def logic_or(x: Any, y: Any) -> Any:
    """Condition that one of two conditions holds, of symbols or numbers."""
    return _either("logic_or", np.logical_or, x, y)


def logic_not(x: Any) -> Any:
    """Condition that a condition does not hold, of symbols or numbers."""
    return _either("logic_not", np.logical_not, x)


def _either(name: str, of_numbers: Callable[..., Any], *x: Any) -> Any:
    """A function of casadi where a symbol is among the arguments, else that of numbers."""
    return getattr(casadi, name)(*x) if any(hasattr(one, "is_symbolic") for one in x) else of_numbers(*x)
