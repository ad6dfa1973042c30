"""Instants at which the steps of a time integration have to end: breaks of commands and loads, Eq. (T6.17)."""

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

from flexapod.kinematics import Breaks

NEAR = 1e-6  # breaks that are no farther apart are one break, and steps are no shorter: rounding of index 3 [s]
SHARE = 1e-2  # and no farther than this share of a fixed step


@dataclass(frozen=True, kw_only=True)
class Stop:
    """A break, or several that count as one, from `first` to `last` [s]; what `jumps` needs a restart after it."""

    first: float
    last: float
    jumps: bool


@dataclass(frozen=True, kw_only=True)
class Stops:
    """Breaks sorted by the output intervals in which they lie.

    ``ends``: stops on output instants, by the number of the interval that ends there (0: at the start). ``inside``:
    those within an interval, by its number from 0, ascending in time. ``every``: all of them, corners on
    output instants included.
    """

    output_step: float
    ends: dict[int, Stop] = field(default_factory=dict)
    inside: dict[int, list[Stop]] = field(default_factory=dict)
    every: tuple[Stop, ...] = ()

    @classmethod
    def from_breaks(cls, breaks: Breaks, output_step: float, step: float | None, outputs: int) -> "Stops":
        """Sort breaks up to the last output; a corner on an output instant needs nothing."""
        near = min(NEAR, SHARE * (step or output_step))
        stops = cls(output_step=output_step, every=tuple(_joined(breaks, near)))
        for stop in stops.every:
            k = round(stop.first / output_step)
            if max(abs(stop.first - k * output_step), abs(stop.last - k * output_step)) <= near:
                if stop.jumps and k <= outputs:
                    stops.ends[k] = Stop(first=stops.ends.get(k, stop).first, last=stop.last, jumps=True)
            elif (k := int(stop.first // output_step)) < outputs:
                stops.inside.setdefault(k, []).append(stop)
        return stops

    def unaligned_stops(self, interval: int, per_output: float) -> Sequence[Stop]:
        """Stops inside an interval that its steps do not meet anyway: jumps, and corners off the grid of steps."""
        found = self.inside.get(interval, ())
        return () if all(self._met(stop, per_output) for stop in found) else found

    def _met(self, stop: Stop, per_output: float) -> bool:
        place = stop.first / self.output_step * per_output
        return not stop.jumps and abs(place - round(place)) < 1e-6 * per_output

    @cached_property
    def _places(self) -> list[int]:
        """Numbers of the intervals that have a stop, ascending: few of many."""
        return sorted({*self.ends, *self.inside})

    def next(self, done: int, most: int, per_output: float) -> int:
        """Number of outputs up to which steps go on evenly from `done`, at most `most`, at least one more."""
        for k in self._places[bisect_left(self._places, done) : bisect_left(self._places, most)]:
            if k > done and k in self.ends:
                return k
            if self.unaligned_stops(k, per_output):
                return max(k, done + 1)
        return most


def just_before(instant: float) -> float:
    """Just before a break: the value that a command has until then."""
    return instant - 1e-12 * max(1.0, instant)


def just_after(instant: float) -> float:
    """Just after a break."""
    return instant + 1e-12 * max(1.0, instant)


def _joined(breaks: Breaks, near: float) -> list[Stop]:
    """Breaks in order; those within `near` of each other are one stop, which then is a jump."""
    found: list[Stop] = []
    for t, jumps in sorted([*((t, True) for t in breaks.jumps), *((t, False) for t in breaks.corners)]):
        if found and t - found[-1].first <= near:
            found[-1] = Stop(first=found[-1].first, last=t, jumps=True)
        else:
            found.append(Stop(first=t, last=t, jumps=jumps))
    return found
