"""Exudyn in a process of its own: it writes to the console, may not come to an end, and can fall with its host."""

from __future__ import annotations

import os
import pickle
import re
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from flexapod.common.errors import ComputationError, FlexapodError
from flexapod.common.files import temporary_folder
from flexapod.common.processes import run_program
from flexapod.verification.engines.engine import EXUDYN

TIME_LIMIT = 300.0
"""Seconds after which Exudyn is stopped."""

Problem = TypeVar("Problem")
Answer = TypeVar("Answer")

_TELLING = re.compile(r"fail|singular|error", re.IGNORECASE)
_LAST = 3  # telling lines of its output in a message


def solve_in_process(solve: Callable[[Problem], Answer], problem: Problem, *, time_limit: float = TIME_LIMIT) -> Answer:
    """Compute ``solve(problem)`` in a process of its own and return the result.

    Parameters
    ----------
    solve : callable
        A function of a module; it may import Exudyn.
    problem : object
        Its argument; argument and result must be picklable.
    time_limit : float
        Seconds after which the process is stopped.

    Raises
    ------
    ComputationError
        Exudyn is not installed, does not end in time, crashes, or does not converge: with what it said.
    FlexapodError
        Raised by the solver itself.
    """
    if not EXUDYN.is_available():
        raise ComputationError("Exudyn is not installed", next_step=f"Install it: {EXUDYN.install}")
    with temporary_folder() as folder:
        given, found = folder / "problem", folder / "result"
        given.write_bytes(pickle.dumps((solve, problem)))
        # -P: no file of the folder that the user works in takes the place of a module.
        command = [sys.executable, "-P", "-m", "flexapod.verification.engines.exudyn_process", str(given), str(found)]
        modules = {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, _paths()))}
        said, code = run_program(command, folder, time_limit, modules)
        if code is None:
            raise ComputationError(
                f"Exudyn did not end within {time_limit:g} s and was stopped. {_said(said)}",
                next_step="Use fewer elements or a longer step",
            )
        if not found.exists():
            raise ComputationError(f"Exudyn crashed ({_code(code)}). {_said(said)}")
        answer, error = pickle.loads(found.read_bytes())
    if isinstance(error, FlexapodError):
        raise error
    if error:
        raise ComputationError(
            f"Exudyn did not solve the problem ({error}). {_said(said)}",
            next_step="Use fewer elements, a larger tolerance of Newton's method or a shorter step",
        )
    return answer


def main(given: str, found: str) -> None:
    """Solve the problem in the file `given`; leave result and error, one of them None, in the file `found`."""
    solve, problem = pickle.loads(Path(given).read_bytes())
    try:
        outcome = solve(problem), None
    except FlexapodError as error:
        outcome = None, error
    except Exception as error:  # Exudyn's errors have no common base
        outcome = None, f"{type(error).__name__}: {error}"
    Path(found).write_bytes(pickle.dumps(outcome))


def _said(output: str) -> str:
    lines = [line.strip() for line in output.splitlines() if _TELLING.search(line)]
    return "Its output: " + " | ".join(lines[:_LAST]) if lines else "It said nothing about it."


def _paths() -> list[str]:
    """Folders of ``PYTHONPATH``, in which modules are looked for besides the usual places."""
    return [path for path in os.environ.get("PYTHONPATH", "").split(os.pathsep) if path]


def _code(code: int) -> str:
    return signal.Signals(-code).name if -code in set(signal.Signals) else f"exit code {code}"


if __name__ == "__main__":
    main(*sys.argv[1:])
