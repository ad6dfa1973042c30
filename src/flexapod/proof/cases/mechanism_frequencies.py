"""Frequencies of robots of many kinds with their drives locked, against exact dynamic stiffness."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from flexapod.model import Robot
from flexapod.proof import dynamic_stiffness
from flexapod.proof.case import Case, Check
from flexapod.proof.locked_robot import legs_and_body, missing_polynomials, missing_sines, missing_twist
from flexapod.proof.parallel_robots import eight_legs, hexapod, planar, table, tricept, tripod
from flexapod.proof.unlike import without_gravity
from flexapod.study.static import modes

__all__ = ["FREQUENCIES"]

COUNT, LATERAL, AXIAL = 5, 6, 2
ROUNDING = 1e-9  # of the eigenproblem: the softest motion's squared frequency is 1e-7 of the stiffest


def _compute(make: Callable[[], Robot]) -> list[Check]:
    robot = without_gravity(make())
    legs, body = legs_and_body(robot, (0.0,) * 6)
    exact = dynamic_stiffness.robot_frequencies(legs, body, COUNT)
    ours = modes(robot, modes=LATERAL, axial_modes=AXIAL).frequency.values
    bound = missing_polynomials(legs, exact, LATERAL) + missing_sines(legs, exact, AXIAL)
    bound += missing_twist(legs, exact) + ROUNDING
    return [
        Check(what=f"frequency {i + 1}", reference=float(exact[i]), ours=float(ours[i]), tolerance=float(bound[i]),
              unit="Hz")
        for i in range(COUNT)
    ]  # fmt: skip


def _case(name: str, robot: str, make: Callable[[], Robot]) -> Case:
    return Case(
        name=name,
        statement=f"Lowest frequencies of {robot}, drives locked; six shapes a plane",
        source="exact dynamic stiffness, transcendental in the frequency, joints as axes about which ends turn; roots "
        "counted after Wittrick & Williams 1971, none missed",
        argument="what the shapes leave out: polynomials of degree 5 of a sine, sines of bars beyond the second "
        "shape and of shafts beyond the first; rounding where bars are 1e7 times as stiff as what bends",
        compute=partial(_compute, make),
    )


FREQUENCIES = (
    _case("frequencies-tripod", "a tripod 3-RPS, hinged at the base", tripod),
    _case("frequencies-tricept", "a Tricept 3-UPS+UP, its passive leg welded to the platform", tricept),
    _case("frequencies-eight-legs", "an 8-UPS, two drives more than motions", eight_legs),
    _case("frequencies-planar", "a planar 3-PRR with slender rods", planar),
    _case("frequencies-welded", "a hexapod 6-UPF, legs welded to the platform", partial(hexapod, "UPF")),
    _case("frequencies-table", "a table on four upright legs welded at both ends",
          partial(table, "FPF", mass=500.0, inertia=50.0)),
)  # fmt: skip
