"""Time integration within a tolerance, chunk by chunk: ends of steps, scales of errors, failures as text."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.solve.system import Flow
from flexapod.solve.time import native
from flexapod.solve.time.chebyshev import Series
from flexapod.solve.time.problem import CAUSES, Chunk, Problem
from flexapod.solve.time.radau import MOST, OUT_OF_REACH, SHORTEST, RadauMemory
from flexapod.solve.time.recording import Counters, Recording, unpack
from flexapod.solve.time.time_events import NEAR, Stop, just_after

FEW, MANY = 4, 500  # outputs of a chunk: of the first ones, which tell the scales; between looks at progress
CHUNK_STEPS = 2000  # steps in a chunk of several outputs
SMALLEST = 1e-9  # scale of an error [m]: what is smaller is rounding
ROUNDING, SEEN = 1e-15, 1e-7  # of lengths of a metre [m]; what is larger is no longer the start from rest [m]
LOOK = 32  # steps to the next look at scales that are unknown at the start and grow; else twice as many as to the last
SAMPLES = 50  # instants of a chunk that tell its scales
FEWEST = 1e-6  # mean step below which a tolerance is called out of reach [s]
FINEST = 1e-3  # pieces of series are no shorter for what bends without being told [s]


def adaptive_march(problem: Problem, start: Flow, counters: Counters) -> Iterator[Chunk]:
    """Integrate from ``start`` and yield chunks, the first holding the start alone.

    Raises
    ------
    ComputationError
        A step failed or the tolerance is out of reach; the chunks yielded before hold all outputs up to there.
    """
    flow, first = _recorded(problem, start, 0.0)
    yield Chunk(recording=first, error=0.0, step=problem.output_step)
    run = _Run(problem, counters, first)
    done, count, stops = 0, FEW, problem.stops
    if 0 in stops.ends:
        flow, _ = run.restart_after(flow, 0.0, stops.ends[0])
    while done < problem.outputs:
        chunk, flow, failure = run.chunk(flow, done, _chunk_end(problem, done, count))
        sound, fault = _sound(problem, chunk.recording)
        done += sound
        if sound:
            yield chunk if fault is None else replace(chunk, recording=chunk.recording.part(slice(sound)))
        if (failure := fault or failure) is not None:
            raise failure
        count = run.next_count(count)


def _chunk_end(problem: Problem, done: int, count: int) -> int:
    """Number of outputs up to which a chunk goes: at most to the next output at which something jumps."""
    ends = sorted(k for k in problem.stops.ends if k > done)
    return min(done + count, problem.outputs, *ends[:1])


def _recorded(problem: Problem, flow: Flow, t: float) -> tuple[Flow, Recording]:
    """Flow with its powers, and its record, stored as that of time t; commands are those at t."""
    table, load = problem.tables_under(flow)(np.array([t]))
    flow, row = native.first_record(problem.system, flow, table, load)
    return flow, unpack(problem.system, np.array([t]), row, problem.loop and np.zeros((1, problem.loop.width)))


def _sound(problem: Problem, recording: Recording) -> tuple[int, ComputationError | None]:
    """Number of instants before the first one at which the model has no meaning, and what is wrong there."""
    fault: ComputationError | None = None
    sound, failing = 0, len(recording.time) + 1
    while failing - sound > 1:
        some = len(recording.time) if failing > len(recording.time) else (sound + failing) // 2
        try:
            problem.check(recording.part(slice(some)))
            sound = some
        except ComputationError as error:
            failing, fault = some, error
    return sound, fault


class _Run:
    """State of the integration that is remembered between chunks."""

    def __init__(self, problem: Problem, counters: Counters, first: Recording) -> None:
        self.problem, self.counters = problem, counters
        self.ends = _ends(problem)
        self.scales = [SMALLEST] * len(problem.weights)
        edges = [0.0, *(stop.first for stop in self.ends), problem.outputs * problem.output_step]
        knots = problem.knots[(problem.knots > 0) & (problem.knots < edges[-1])]
        edges = _apart(sorted([*edges, *knots]))
        series = Series(problem.tables, edges, min(FINEST, problem.output_step))
        self.within = RadauMemory(problem.system, series, edges[-1], problem.tolerance or 0.0, problem.loop)
        self.steps = 0  # of the last chunk
        self.look = MOST  # steps to the next look at the scales
        self._scale(first)
        if self.scales[0] < SEEN:
            self.look = LOOK

    def chunk(self, flow: Flow, done: int, to: int) -> tuple[Chunk, Flow, ComputationError | None]:
        """Outputs after `done` up to `to`, or until it fails, the flow at their end, and the error if any."""
        p, rows, control, before = self.problem, [], [], self.counters.steps
        begin, end, failure = done * p.output_step, to * p.output_step, None
        between = slice(*(bisect_right(self.ends, t, key=_first) for t in (begin + NEAR, end - NEAR)))
        passed: list[float] = []
        for stop in [*self.ends[between], Stop(first=end, last=end, jumps=False)]:
            passed.append(stop.first)
            if not stop.jumps and stop.first < end:
                continue
            found = self._advance(flow, passed, done, to)
            passed.clear()
            flow = found.flow
            rows.append(found.rows)
            control.append(found.control)
            done += len(found.rows)
            if found.status:
                failure = self._failure(found)
                break
            if stop.jumps:
                try:
                    flow, _ = self.restart_after(flow, stop.first, stop)
                except ComputationError as error:
                    failure = error
                    break
        whole = _joined(rows)
        time = np.asarray((done - len(whole) + 1 + np.arange(len(whole))) * p.output_step, dtype=float)
        recording = unpack(p.system, time, whole, _joined(control) if p.loop else None)
        if failure is None and to in p.stops.ends:  # what is stored there is the value after the jump
            flow, last = self.restart_after(flow, end, p.stops.ends[to])
            recording = recording.ending(last)
        self.steps = self.counters.steps - before
        self._scale(recording)
        if failure is None and ROUNDING > self.scales[0] * self.within.tolerance and self.scales[0] > SEEN:
            why = f"rounding leaves {ROUNDING / self.scales[0]:.1g} of the largest value"
            failure = self._out_of_reach(begin, why)
        step = (end - begin) / max(self.steps, 1)
        chunk = Chunk(recording=recording, error=self.within.spent, step=step, force_error=self.within.thrust)
        return chunk, flow, failure

    def _advance(self, flow: Flow, stops: Sequence[float], done: int, to: int) -> native.Advance:
        """Advance to the last of `stops`; where many steps lie between outputs, with looks at the scales on the way."""
        rows, control, now, step = [], [], self.within.time, self.problem.output_step
        while True:
            at = done + sum(map(len, rows))
            outputs, ahead = ((at + 1) * step, step, to - at), np.array([t for t in stops if t > now])
            most = self.look if self.look < MOST else MOST * max(to - at, 1)
            found = self.within.advance(flow, ahead, self._weights(), outputs, most, self.counters)
            rows.append(found.rows)
            control.append(found.control)
            if found.status != OUT_OF_REACH or found.time - now <= (0.0 if most < MOST else MOST * FEWEST):
                return replace(found, rows=_joined(rows), control=_joined(control) if self.problem.loop else None)
            flow, now = found.flow, found.time
            self._scale(_recorded(self.problem, flow, now)[1])

    def restart_after(self, flow: Flow, t: float, stop: Stop) -> tuple[Flow, Recording]:
        """Flow after a jump at time t, and its record."""
        now = just_after(max(t, stop.last))
        self.within.forget_history()
        flow, row = _recorded(self.problem, self.problem.restart(flow, now, 0.0), now)
        return flow, replace(row, time=np.array([t]))

    def next_count(self, count: int) -> int:
        """Outputs of the next chunk."""
        affordable = count * CHUNK_STEPS // max(self.steps, 1)
        return max(1, min(4 * count, MANY, affordable))

    def _failure(self, found: native.Advance) -> ComputationError:
        if found.status == OUT_OF_REACH:
            return self._out_of_reach(
                found.time,
                f"it would take more than {MOST} steps per output and one per microsecond, or steps below "
                f"{1e6 * SHORTEST:g} us",
            )
        where = f" in leg {found.leg + 1}" if 0 <= found.leg < self.problem.system.legs else ""
        at = f"at t = {found.time:.6g} s (step {self.within.step:.3g} s)"
        return self.problem.stop_error(found.status, f"{at}: {CAUSES[found.status]}{where}")

    def _out_of_reach(self, now: float, why: str) -> ComputationError:
        return ComputationError(
            f"tolerance {self.problem.tolerance:g} is out of reach at t = {now:.6g} s: {why}",
            next_step="Loosen simulation.tolerance, or give a fixed simulation.step.",
        )

    def _scale(self, recording: Recording) -> None:
        """Take the largest values of a recording into the scales of the errors."""
        if not len(recording.time):
            return
        before = self.scales[0]
        some = recording.part(slice(None, None, max(1, len(recording.time) // SAMPLES)))
        groups = zip(self.scales, self.problem.measure(some), strict=True)
        self.scales = [max(scale, float(np.abs(x).max(initial=0.0))) for scale, x in groups]
        self.within.weigh(before / self.scales[0])
        if self.look < MOST:
            self.look = LOOK if 2 * before < self.scales[0] else 2 * self.look

    def _weights(self) -> tuple[Array, Array]:
        """One over the displacements that count as an error of one, of a leg's coordinates and of the payload's."""
        pairs = list(zip(self.problem.weights, self.scales, strict=True))
        leg = np.max([weight.leg / scale for weight, scale in pairs], axis=0)
        return leg, np.max([weight.hub / scale for weight, scale in pairs], axis=0)


def _ends(problem: Problem) -> list[Stop]:
    """Instants on which steps end: breaks, and knots of the path."""
    found = list(problem.stops.every)
    at = np.array([-np.inf, *(stop.first for stop in found), np.inf])
    after = np.searchsorted(at, problem.knots)
    apart = np.minimum(problem.knots - at[after - 1], at[after] - problem.knots) > NEAR
    found += [Stop(first=t, last=t, jumps=False) for t in problem.knots[apart].tolist()]
    last = problem.outputs * problem.output_step - NEAR
    return sorted((stop for stop in found if NEAR < stop.first < last), key=_first)


def _joined(parts: list[Array]) -> Array:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _first(stop: Stop) -> float:
    return stop.first


def _apart(instants: Sequence[float]) -> list[float]:
    """Ascending instants without those that repeat another; the last one stays."""
    first, last = instants[0], instants[-1]
    return [first, *(b for a, b in pairwise(instants[:-1]) if b - a > NEAR and last - b > NEAR), last]
