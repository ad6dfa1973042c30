"""Time integration within a tolerance: Radau's method of order 5 with steps of its own, Eqs. (T6.28)-(T6.33)."""

from ctypes import Structure, byref, c_double, c_long, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.common.piecewise_chebyshev import NODES
from flexapod.solve.system import Flow, System
from flexapod.solve.time.chebyshev import Series
from flexapod.solve.time.native import Advance, Call, address, loops, memory, settings
from flexapod.solve.time.recording import Counters, record_width

if TYPE_CHECKING:
    from flexapod.solve.time.sampled_control import SampledLoop

OUT_OF_REACH = 4  # as in radau.c
FIRST = 1e-5  # of the first step, and after a jump [s]; it grows four times a step
LONGEST, SHORTEST = np.inf, 1e-7  # s
UNSOLVED = 0.05  # share of a step's error that corrections may leave, in the displacements that its rates bring
MOST = 8192  # steps per output in a call
#: Places in the memory, as in `Memory` of radau.c; what follows is C's own.
TIME, STEP, SPENT, PEAK, STAGES, REJECTED, RECORDED, THRUST = 0, 1, 2, 4, 6, 7, 8, 9


class _Control(Structure):
    _fields_ = [
        *[(name, c_double) for name in ("horizon", "tolerance")],
        ("weight", c_void_p),
        ("hub_weight", c_void_p),
        *[(name, c_double) for name in ("longest", "shortest", "unsolved", "output_first", "output_step")],
        *[(name, c_long) for name in ("outputs", "pieces", "terms", "most", "stops")],
        *[(name, c_void_p) for name in ("edges", "series", "stop")],
        *[(name, c_long) for name in ("along", "springs")],
        ("forces", c_double),
    ]


class RadauMemory:
    """The method's memory from call to call: time, step, local errors so far, and all that C works with.

    Parameters
    ----------
    system : System
    series : Series
        Commands and loads.
    horizon : float
        When the run ends [s]: the local errors up to there may add up to the tolerance.
    tolerance : float
    loop : SampledLoop, optional
        A controller, at whose samples steps end.
    """

    system: System
    series: Series
    horizon: float
    tolerance: float

    def __init__(
        self, system: System, series: Series, horizon: float, tolerance: float, loop: "SampledLoop | None" = None
    ) -> None:
        self.system, self.series, self.horizon, self.tolerance = system, series, horizon, tolerance
        self.loop: SampledLoop | None = loop
        self._along, self._rigid = _along(system), is_rigid(system)
        self._memory = memory(loops(system.kernel).radau_memory(byref(settings(system, GeneralizedAlpha(1.0), 1.0, 1))))
        self._memory[STEP] = FIRST

    @property
    def spent(self) -> float:
        """Sum of the local errors, an estimate of the error: relative to what the weights say."""
        return float(self._memory[SPENT])

    @property
    def thrust(self) -> float | None:
        """Sum of the local errors of the force along a leg, the largest of all legs [N]; None: not estimated.

        Of rigid legs it is the largest error of a step: their forces follow from the motion of that instant.
        """
        told = self._along[1] or self._rigid
        return float(self._memory[THRUST : THRUST + self.system.legs].max()) if told else None

    @property
    def time(self) -> float:
        """Instant reached [s]."""
        return float(self._memory[TIME])

    @property
    def step(self) -> float:
        """Step that is to be tried next [s]."""
        return float(self._memory[STEP])

    def weigh(self, ratio: float) -> None:
        """Go on with weights that are `ratio` times those before: what is remembered of errors is in their units."""
        self._memory[[SPENT, PEAK]] *= ratio

    def forget_history(self) -> None:
        """Forget what is extrapolated from: commands have jumped."""
        self._memory[[STEP, PEAK, STAGES]] = FIRST, 0.0, 0.0

    def advance(
        self,
        flow: Flow,
        stops: Array,
        weights: tuple[Array, Array],
        outputs: tuple[float, float, int],
        most: int,
        counters: Counters,
    ) -> Advance:
        """Advance to the last of `stops`, ascending instants on which steps end, or by `most` steps.

        `outputs`: first instant, distance and number of the records on the way.
        """
        new, rows = flow.copy(), np.empty((outputs[2], record_width(self.system)))
        call = Call(self.system, new, rows, GeneralizedAlpha(1.0), 1.0, 1)
        edges, series = (
            np.ascontiguousarray(x) for x in self.series.covering_pieces(float(self._memory[TIME]), stops[-1])
        )
        leg, hub = (np.ascontiguousarray(x) for x in weights)
        control = _Control(
            self.horizon, self.tolerance, address(leg), address(hub), LONGEST, SHORTEST,
            UNSOLVED, *outputs, len(series), NODES, most, len(stops),
            address(edges), address(series), address(stops), *self._along, self.tolerance * self._rigid,
        )  # fmt: skip
        before, found = self._memory[REJECTED], np.empty((len(rows), self.loop.width if self.loop else 0))
        around, _held = self.loop.call(new, self.time, float(stops[-1]), found) if self.loop else (None, ())
        status = loops(self.system.kernel).radau(
            byref(call.settings), byref(call.state), byref(control), address(self._memory),
            byref(around) if around else None,
        )  # fmt: skip
        counters.steps += call.state.steps
        counters.iterations += call.state.iterations
        counters.factorisations += call.state.factorisations
        counters.rejected += int(self._memory[REJECTED] - before)
        written = int(self._memory[RECORDED])
        return Advance(
            flow=new, rows=rows[:written], status=status, leg=call.state.bad_leg, time=self.time,
            control=found[:written] if self.loop else None,
        )  # fmt: skip


def _along(system: System) -> tuple[int, int]:
    """Coordinates whose springs carry the force along a leg, first and number: of its stretch, else its stroke."""
    shapes = system.kernel.shapes
    if shapes.beam.axial.count:
        return shapes.index("c"), shapes.beam.axial.count
    return shapes.l_index, int(not system.held[:, shapes.l_index].any())


def is_rigid(system: System) -> bool:
    """Test whether legs have neither shapes nor a spring along them: a given motion determines their forces."""
    beam = system.kernel.shapes.beam
    return bool(system.rows) and not (_along(system)[1] or beam.a.count or beam.b.count or beam.inside)
