"""Recording of a time integration at its output instants, and its cost."""

import itertools
import math
from dataclasses import dataclass, fields, replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.solve.system import System


@dataclass(kw_only=True)
class Counters:
    """Cost of an integration: steps, iterations, factorisations, rejected steps."""

    steps: int = 0
    iterations: int = 0
    factorisations: int = 0
    rejected: int = 0


@dataclass(frozen=True, kw_only=True)
class Recording:
    """States at T output instants (axis 0), see `system.State`.

    ``drive``, (T, legs, ports): the whole force of each port, whatever makes it: held, pushed, a spring [N, N m];
    ``reaction``, (T, 6): force and moment on what is held of the payload; ``energy``: kinetic, gravity, strain;
    ``sums``: lost, drives, wrench, base; ``friction``, (T, legs, bristles): force or moment of what slides;
    ``control``, (T, any): of a sampled controller its last readings, the outputs that it held, its work [J].
    """

    time: Array
    q: Array
    v: Array
    v_dot: Array
    lam: Array
    drive: Array
    pose: Array
    reaction: Array
    energy: Array
    sums: Array
    closure: Array
    friction: Array
    control: Array

    def part(self, which: slice) -> "Recording":
        """Recording at some of the instants."""
        return replace(self, **{field.name: getattr(self, field.name)[which] for field in fields(self)})

    def ending(self, last: "Recording") -> "Recording":
        """The same with another last instant; a controller's readings and outputs there are still those before it."""
        names = [field.name for field in fields(self) if field.name not in ("time", "control")]
        ends = {name: np.concatenate([getattr(self, name)[:-1], getattr(last, name)]) for name in names}
        return replace(self, **ends)


def record_shapes(system: System) -> dict[str, tuple[int, ...]]:
    """Names and shapes of the parts of an output row, in their order."""
    legs, every = system.legs, (system.size,)
    return {
        "q": (legs, system.n),
        "v": every,
        "v_dot": every,
        "lam": (legs, system.rows),
        "drive": (legs, system.ports.size),
        "pose": (7,),
        "reaction": (6,),
        "energy": (3,),
        "sums": (4,),
        "closure": (),
        "friction": (legs, system.kernel.shapes.bristles),
    }


def record_places(system: System) -> dict[str, slice]:
    """Slices of the parts in an output row, by name."""
    shapes = record_shapes(system)
    ends = [0, *itertools.accumulate(map(math.prod, shapes.values()))]
    return {name: slice(*both) for name, both in zip(shapes, itertools.pairwise(ends), strict=True)}


def record_width(system: System) -> int:
    """Numbers in one output row."""
    return sum(map(math.prod, record_shapes(system).values()))


def unpack(system: System, time: Array, rows: Array, control: Array | None = None) -> Recording:
    """Name the columns of output rows (T, record_width); `control`: rows of a controller's record."""
    shapes = record_shapes(system)
    parts = {name: rows[:, at].reshape(len(rows), *shapes[name]) for name, at in record_places(system).items()}
    return Recording(time=time, control=np.zeros((len(rows), 0)) if control is None else control, **parts)
