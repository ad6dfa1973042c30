"""Time integration in chunks: fixed step or tolerance, failures as text, Eq. (T6.15)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from types import ModuleType

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.solve.system import Flow, System
from flexapod.solve.time import interpreted, native
from flexapod.solve.time.adaptive import adaptive_march
from flexapod.solve.time.problem import CAUSES, Chunk, Problem
from flexapod.solve.time.recording import Counters, Recording, unpack
from flexapod.solve.time.time_events import Stop, just_after, just_before

CHUNK = 100  # output intervals between looks at the tolerance, or at progress where steps are slow
CHUNK_STEPS = 2000  # steps in a chunk of several intervals: tables of fine steps must not outgrow the output
SAFETY = 1.5  # in the error, for the next chunk's step
FINEST = 8192  # steps per output interval before the tolerance is called out of reach
SHORT = 8  # steps per output interval: when a run with longer ones fails, this many are tried before giving up


def initial_step(problem: Problem, step: float | None) -> float:
    """Step for which a start is prepared: the fixed one made to divide the output step (never larger than asked).

    Zero where steps follow the tolerance one by one; half the output step where chunks are compared.
    """
    if problem.adaptive:
        return 0.0
    output_step = problem.output_step
    if step is None:
        return output_step / 2
    return step if step >= output_step else output_step / np.ceil(output_step / step - 1e-9)


def march(problem: Problem, start: Flow, first_step: float, counters: Counters) -> Iterator[Chunk]:
    """Integrate from ``start`` (prepared for ``first_step``) and yield chunks, the first holding the start alone.

    Raises
    ------
    ComputationError
        A step failed or the tolerance is out of reach; the chunks yielded before hold all outputs up to there.
    """
    if problem.adaptive:
        yield from adaptive_march(problem, start, counters)
        return
    table, wrench = problem.tables(np.zeros(1))
    flow, row = first_record(problem.system, start, table, wrench)
    first = unpack(problem.system, np.zeros(1), row, problem.loop and np.zeros((1, problem.loop.width)))
    yield Chunk(recording=first, error=0.0, step=first_step)
    control = _Control(problem, counters, first_step, [np.abs(x).max(initial=0.0) for x in problem.measure(first)])
    longest = CHUNK_STEPS if problem.tolerance is None and problem.system.kernel.library else CHUNK
    done, most, stops = 0, longest, problem.stops
    if 0 in stops.ends:
        flow, _ = _restarted(problem, flow, 0.0, stops.ends[0], first_step)
    while done < problem.outputs:
        count = max(1, min(most, control.longest))
        stop = stops.next(done, min(done + count, problem.outputs), control.coarse)
        kept = control.settings
        try:
            ahead, chunk = control.advance(flow, done, stop - done)
            stop = done + len(chunk.recording.time)
            problem.check(chunk.recording)
        except ComputationError:
            if stop - done == 1:
                raise
            most, control.settings = (stop - done) // 2, kept  # as far as the last output before the failure
            continue
        flow, done, most = ahead, stop, min(2 * most, longest)
        if done in stops.ends:  # what is stored there is the value after the jump
            flow, row = _restarted(problem, flow, done * problem.output_step, stops.ends[done], control.h)
            chunk = replace(chunk, recording=chunk.recording.ending(row))
        yield chunk


@dataclass(frozen=True, kw_only=True)
class _Window:
    """Instants, commands and wrenches of the steps of ``count`` outputs after ``done``, for several chunks at once."""

    done: int = 0
    count: int = 0
    per_output: int = 0
    rows: tuple[Array, ...] = ()

    def holds(self, done: int, count: int, per_output: int) -> bool:
        return per_output == self.per_output and self.done <= done and done + count <= self.done + self.count

    def part(self, done: int, count: int) -> list[Array]:
        first = (done - self.done) * self.per_output
        return [x[first : first + count * self.per_output + 1] for x in self.rows]


class _Control:
    """Step control between chunks; the only object here that remembers anything."""

    def __init__(self, problem: Problem, counters: Counters, first_step: float, scales: list[float]) -> None:
        self.problem, self.counters, self.scales = problem, counters, scales
        self.window = _Window()
        self.h = first_step  # the step for which the flow's auxiliary values are prepared
        self.per_output = max(1, round(problem.output_step / first_step))  # steps of the run that is kept
        if problem.tolerance is not None:
            self.per_output *= 2

    @property
    def longest(self) -> int:
        """Outputs in a chunk whose (coarse) run has as many steps as allowed."""
        return CHUNK_STEPS // self.per_output if self.problem.tolerance is None else 2 * CHUNK_STEPS // self.per_output

    @property
    def coarse(self) -> float:
        """Steps per output of the run with the longest steps."""
        return self.per_output if self.problem.tolerance is None else self.per_output / 2

    @property
    def settings(self) -> tuple[float, int, list[float]]:
        """Memory of the control: step of the flow, steps per output, scales of the errors."""
        return self.h, self.per_output, self.scales

    @settings.setter
    def settings(self, settings: tuple[float, int, list[float]]) -> None:
        self.h, self.per_output, self.scales = settings

    def advance(self, flow: Flow, done: int, count: int) -> tuple[Flow, Chunk]:
        """Return the next ``count`` outputs with the fixed step, or up to ``count`` within the tolerance."""
        if self.problem.tolerance is None:
            result, self.h = self._once(flow, done, count, 1)
            return result.flow, self._chunk(result.rows, done, 0.0, self.per_output, result.control)
        while True:
            count = self._whole(self.problem.stops.next(done, done + count, self.coarse) - done)
            # Errors of chunks add up in part (damping forgets): each may use the root of its share.
            allowed = self.problem.tolerance * np.sqrt(count / self.problem.outputs)
            try:
                error, fine, h = self._twice(flow, done, count)
            except ComputationError:
                if self.per_output >= SHORT:
                    raise
                self.per_output = SHORT
                continue
            wanted = _level(self.per_output * np.sqrt(SAFETY * error / allowed))
            if error <= allowed:
                break
            self.counters.rejected += 3 * count * self.per_output // 2
            if self.per_output >= FINEST:
                now = done * self.problem.output_step
                raise ComputationError(
                    f"tolerance {self.problem.tolerance:g} is out of reach at t = {now:.6g} s: "
                    f"from {self.per_output // 2} to {self.per_output} steps per output the result still changes by "
                    f"{error:.2g}, {allowed:.2g} is the share of the tolerance here, and it would take more than "
                    f"{FINEST}",
                    next_step="Loosen simulation.tolerance, or give a fixed simulation.step.",
                )
            self.per_output = min(max(wanted, _finer(self.per_output)), 8 * self.per_output)
            count = max(1, min(count, self.longest))
        chunk = self._chunk(fine.rows, done, error, self.per_output)
        self.h = h
        self.per_output = min(self.per_output, max(wanted, 2 * (self.per_output // 4), 1))
        return fine.flow, chunk

    def _whole(self, count: int) -> int:
        """Outputs of a chunk: an even number where a coarse step spans two; of a single output two steps are made."""
        if self.per_output == 1 and count == 1:
            self.per_output = 2
        return count - count % 2 if self.per_output == 1 else count

    def _twice(self, flow: Flow, done: int, count: int) -> tuple[float, native.Advance, float]:
        """Run a chunk with steps twice as long and with those to be stored: error, second run, its last step."""
        (coarse, _), (fine, h) = (self._once(flow, done, count, parts) for parts in (1, 2))
        every = count // len(coarse.rows)
        a, b = (self._measured(rows, done, every) for rows in (coarse.rows, fine.rows[every - 1 :: every]))
        return self._error(a, b), fine, h

    def _once(self, flow: Flow, done: int, count: int, parts: int) -> tuple[native.Advance, float]:
        """Run a chunk, each of the longest steps in `parts`; the outcome and the last step's length."""
        stops, per_output = self.problem.stops.unaligned_stops(done, self.coarse), self.coarse * parts
        if stops:
            return self._through(flow, done, stops, parts)
        if self.problem.tolerance is None and per_output > CHUNK_STEPS:
            grid = [self._instants(done, count, self.per_output)]
        else:
            grid = [x[:: round(self.per_output / per_output)] for x in self._grid(done, count, self.per_output)]
        return self._run(flow, grid, per_output), self.problem.output_step / per_output

    def _through(self, flow: Flow, done: int, stops: Sequence[Stop], parts: int) -> tuple[native.Advance, float]:
        """Run one output interval piece by piece, from break to break, with a restart after each that jumps."""
        p, prepared = self.problem, self.h
        begin, end = done * p.output_step, (done + 1) * p.output_step
        samples = p.loop.instants(begin, end, [stop.first for stop in stops]) if p.loop else []
        stops = [*stops, *(Stop(first=t, last=t, jumps=False) for t in samples)]
        stops.sort(key=lambda stop: stop.first)
        edges = [begin, *(stop.first for stop in stops), end]
        spans = np.diff(edges)
        counts = [parts * max(1, int(np.ceil(x / p.output_step * self.coarse - 1e-6))) for x in spans]
        steps, times = spans / counts, _pieces(edges, counts, [*stops, p.stops.ends.get(done + 1)])
        for i, stop in enumerate(stops):
            flow, prepared = self._steps(flow, prepared, steps[i], [times[i]], counts[i]).flow, steps[i]
            if stop.jumps:
                prepared = steps[i + 1]
                flow, _ = _restarted(p, flow, stop.first, stop, prepared)
        return self._steps(flow, prepared, steps[-1], [times[-1]], counts[-1]), steps[-1]

    def _grid(self, done: int, count: int, per_output: int) -> list[Array]:
        """Instants of the steps of a chunk, and the tables of commands and wrench there."""
        if not self.window.holds(done, count, per_output):
            ahead = 2 * self.window.count if self.window.per_output == per_output else count
            most = min(done + min(ahead, CHUNK_STEPS // per_output), self.problem.outputs)
            most = self.problem.stops.next(done, most, self.coarse) - done
            self.window = self._window(done, max(count, most), per_output)
        return self.window.part(done, count)

    def _window(self, done: int, count: int, per_output: int) -> _Window:
        t = self._instants(done, count, per_output)
        return _Window(done=done, count=count, per_output=per_output, rows=(t, *self.problem.tables(t)))

    def _instants(self, done: int, count: int, per_output: int) -> Array:
        p = self.problem
        steps = done * per_output + np.arange(count * per_output + 1)
        t = np.asarray(steps * (p.output_step / per_output), dtype=float)
        if (stop := p.stops.ends.get(done + count)) is not None:
            t[-1] = just_before(min(t[-1], stop.first))
        return t

    def _run(self, flow: Flow, grid: list[Array], per_output: float) -> native.Advance:
        return self._steps(flow, self.h, self.problem.output_step / per_output, grid, max(1, int(per_output)))

    def _steps(self, flow: Flow, prepared: float, h: float, grid: list[Array], every: int) -> native.Advance:
        """Steps of length h over the rows of a grid, from a flow prepared for another; a record after each `every`.

        A grid of instants alone has its tables made for some steps at a time, and one record, at its end.
        """
        p, t = self.problem, grid[0]
        if abs(h - prepared) > 1e-12 * h:
            flow = _rescaled(p.system, flow, prepared, h)
        result, first = None, 0
        while result is None or first < len(t) - 1:
            tables = (grid[1], grid[2]) if grid[1:] else p.tables(t[first : first + CHUNK_STEPS + 1])
            many = min(every, len(tables[0]) - 1)
            around = {"loop": p.loop, "begin": float(t[first])} if p.loop else {}
            result = _loop(p.system).advance(
                p.system, p.method, flow, h, tables, many, self.counters, before=result, **around
            )
            if result.status:
                where = f" in leg {result.leg + 1}" if 0 <= result.leg < p.system.legs else ""
                at = f"at t = {t[first + result.step]:.6g} s (step {h:.3g} s)"
                raise p.stop_error(result.status, f"{at}: {CAUSES[result.status]}{where}")
            flow, first = result.flow, first + len(tables[0]) - 1
        return result

    def _chunk(self, rows: Array, done: int, error: float, per_output: int, control: Array | None = None) -> Chunk:
        time = np.asarray((done + 1 + np.arange(len(rows))) * self.problem.output_step, dtype=float)
        recording = unpack(self.problem.system, time, rows, control)
        return Chunk(recording=recording, error=error, step=self.problem.output_step / per_output)

    def _measured(self, rows: Array, done: int, every: int) -> list[Array]:
        """Quantities whose error is controlled, at each ``every``-th output after ``done``."""
        time = np.asarray((done + every * (1 + np.arange(len(rows)))) * self.problem.output_step, dtype=float)
        return self.problem.measure(unpack(self.problem.system, time, rows))

    def _error(self, coarse: list[Array], fine: list[Array]) -> float:
        """Difference over the largest value so far, group by group: three times the fine run's error, Eq. (T6.15)."""
        self.scales = [max(s, float(np.abs(x).max(initial=0.0))) for s, x in zip(self.scales, fine, strict=True)]
        groups = zip(coarse, fine, self.scales, strict=True)
        return max(float(np.abs(x - y).max(initial=0.0)) / max(s, 1e-9) for x, y, s in groups)


def _pieces(edges: list[float], counts: list[int], ends: Sequence[Stop | None]) -> list[Array]:
    """Instants of even steps from edge to edge, each up to just before its break."""
    times = [np.linspace(a, b, n + 1) for a, b, n in zip(edges[:-1], edges[1:], counts, strict=True)]
    for t, stop in zip(times, ends, strict=True):
        if stop is not None:
            t[-1] = just_before(min(t[-1], stop.first))
    return times


def _restarted(problem: Problem, flow: Flow, t: float, stop: Stop, h: float) -> tuple[Flow, Recording]:
    """Flow after a jump at time t, prepared for steps h, with the new powers; and what is recorded of it."""
    now = just_after(max(t, stop.last))
    table, wrench = problem.tables_under(flow)(np.array([now]))
    flow, row = first_record(problem.system, problem.restart(flow, now, h), table, wrench)
    return flow, unpack(problem.system, np.array([t]), row)


def first_record(system: System, flow: Flow, table: Array, wrench: Array) -> tuple[Flow, Array]:
    """Flow with its powers set, and the record of it, (1, record_width)."""
    return _loop(system).first_record(system, flow, table, wrench)


def _rescaled(system: System, flow: Flow, old: float, new: float) -> Flow:
    """Auxiliary values for another step, Eqs. (T6.13)-(T6.14): a - v_dot grows with h, the defect with h^2."""
    ratio = new / old
    flow = replace(flow, a=flow.v_dot + ratio * (flow.a - flow.v_dot))
    return _loop(system).scaled_defect(system, flow, ratio**2) if system.rows else flow


def _loop(system: System) -> ModuleType:
    return native if system.kernel.library else interpreted


def _finer(steps: int) -> int:
    """Next number of stored steps, 1, 2, 4, 6, 8, 12, 16, 24 ..., for an output interval; half of it if coarse."""
    if steps <= 2:
        return 2 * steps
    return steps * 3 // 2 if steps & (steps - 1) == 0 else steps * 4 // 3


def _level(steps: float) -> int:
    """Smallest of 1, 2, 4, 6, 8, 12 ... that is no less than ``steps``."""
    level = 1
    while level < min(steps, 2 * FINEST):
        level = _finer(level)
    return level
