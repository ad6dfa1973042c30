"""CalculiX: a deck in, numbers out. It runs in a folder of its own that is gone afterwards."""

from __future__ import annotations

import re
import shutil
import signal
from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.files import temporary_folder
from flexapod.common.processes import run_program
from flexapod.verification.engines.engine import CALCULIX

TIME_LIMIT = 300.0
"""Seconds after which CalculiX is stopped."""

_LAST = 8  # lines of its output in a message
_JOB = "deck"
_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
_BLOCK = re.compile(r"^ displacements \(vx,vy,vz\) for set (\S+) and time +(\S+)")


@dataclass(frozen=True, kw_only=True)
class CalculixRun:
    """Output of a run: `printed`, its table of results (``.dat``), and `output`, its text on the way."""

    printed: str
    output: str

    def frequencies(self) -> Array:
        """Frequencies of the last ``*FREQUENCY`` step, ascending [Hz]; those of motions without stiffness are 0.

        Raises
        ------
        ComputationError
            There are none.
        """
        lines = self.printed.splitlines()
        heads = [i for i, line in enumerate(lines) if "E I G E N V A L U E" in line.upper() and "O U T P U T" in line]
        found = []
        for line in lines[heads[-1] + 1 :] if heads else []:
            parts = line.split()
            if len(parts) == 5 and parts[0].isdigit():
                found.append(float(parts[1]))  # omega^2; the column of frequencies has fewer digits
            elif found:
                break
        if not found:
            raise ComputationError("CalculiX found no frequencies", next_step=_said(self.output))
        return np.sqrt(np.maximum(found, 0.0)) / (2 * np.pi)

    def displacements(self, name: str) -> tuple[Array, Array]:
        """Instants (T,) [s] and displacements (T, n, 3) [m] of the nodes of a set printed by ``*NODE PRINT``.

        Raises
        ------
        ComputationError
            There are none, or the run broke off within an instant.
        """
        times: list[float] = []
        rows: list[list[list[float]]] = []
        inside = False
        for line in self.printed.splitlines():
            head = _BLOCK.match(line)
            if head:
                inside = head[1].upper() == name.upper()
                if inside:
                    times.append(float(head[2]))
                    rows.append([])
            elif inside and (parts := line.split()):
                inside = parts[0].isdigit() and len(parts) == 4
                if inside:
                    rows[-1].append([float(x) for x in parts[1:]])
        if not rows or len({len(block) for block in rows}) != 1:
            raise ComputationError(f"CalculiX printed no displacements of {name}", next_step=_said(self.output))
        return np.array(times), np.array(rows)


def run(deck: str, *, time_limit: float = TIME_LIMIT) -> CalculixRun:
    """Run CalculiX on the text of a deck, on one core.

    Parameters
    ----------
    deck : str
    time_limit : float
        Seconds after which it is stopped.

    Raises
    ------
    ComputationError
        CalculiX is not installed, does not end in time, crashes, or reports an error: with its last lines.
    """
    program = shutil.which(CALCULIX.program)
    if program is None:
        raise ComputationError("CalculiX (ccx) is not installed", next_step=f"Install it: {CALCULIX.install}")
    with temporary_folder() as folder:
        (folder / f"{_JOB}.inp").write_text(deck, encoding="ascii")
        output, code = run_program([program, "-i", _JOB], folder, time_limit, _ONE_THREAD)
        table = folder / f"{_JOB}.dat"
        printed = table.read_text(encoding="ascii", errors="replace") if table.exists() else ""
    if code is None:
        raise ComputationError(
            f"CalculiX did not end within {time_limit:g} s and was stopped. {_said(output)}",
            next_step="Use fewer elements",
        )
    if code < 0:
        signal_name = signal.Signals(-code).name if -code in set(signal.Signals) else str(-code)
        raise ComputationError(
            f"CalculiX crashed ({signal_name}). {_said(output)}", next_step="Try `ccx` on a smaller deck"
        )
    if code > 0 or "*ERROR" in output:
        raise ComputationError(f"CalculiX stopped with an error (exit code {code}). {_said(output)}")
    return CalculixRun(printed=printed, output=output)


def _said(output: str) -> str:
    """The last lines of its output, as a sentence."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return f"Its last lines: {' | '.join(lines[-_LAST:])}" if lines else "It said nothing"
