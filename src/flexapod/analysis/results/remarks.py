"""Remarks of doubt that results carry, by kind: their words, and the numbers that stand in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from flexapod.common.quantities import brief, fill_template
from flexapod.common.ranking import largest_item
from flexapod.solve.modal.modal_loops import UNSTABLE

FLOOR_ENDS = "the floor's spectrum ends at"
_ABOVE = "at t = {time:.6g} s, above the limit of {limit:~4}"
_TAKE = "take {size}, and {times} times as much while they are made"
_SHEAR = (
    "shear counts. Below {limit:g} shear, which an Euler-Bernoulli beam leaves out, is no longer small: it deflects by "
    "about {deflection:.2g} % too little under a force across its end, and its first bending frequency is up to "
    "{frequency:.2g} % too high (Timoshenko's beam, clamped and pinned)"
)
_ROTARY = (
    "rotary inertia counts. Below {limit:g} rotary inertia, which the solid's shapes leave out, is no longer small: "
    "its first frequency of bending is up to {inertia:.2g} % too high (a pinned beam's)"
)
_ONLY = "the free length is only {ratio:.3g} times the width{when}: "
_FALLS = "the free length falls to {ratio:.3g} times the width of the piston: "

#: Words by kind; those of a leg follow "leg 1: ".
REMARKS: Mapping[str, str] = {
    # a leg
    "slope": "the tip slope reaches {slope:.3g}{when}: above {limit:g} second-order theory is strained",
    "stroke": (
        "its drive leaves the stroke of {low:g} to {high:g} m by {excess:.3g} mm{when}: end stops are not part of the "
        "model"
    ),
    "buckling": "the axial load reaches {share:.0%} of the Euler load ({force:.4g} N{when}): the leg {does}",
    "nut": (
        "the thrust reaches {thrust:.4g} N{when}, beyond {limit:.4g} N (2.83 times the preload of the nut). One half "
        "of the nut then carries nothing, and it is softer than assumed"
    ),
    "thick": _ONLY + _SHEAR,
    "thick, solid": _ONLY + _ROTARY,
    "thick on the path": _FALLS + _SHEAR + "; leg.piston.shear = true takes it in",
    "thick on the path, solid": _FALLS + _ROTARY,
    "yield": "the stress reaches {stress:.4g} MPa{when}, above the yield stress of {limit:.4g} MPa",
    # a screw
    "force": "the thrust reaches {value:~4} N " + _ABOVE + " N",
    "speed": "the motor's speed reaches {value:~4} rpm " + _ABOVE + " rpm",
    "torque": "the motor's torque reaches {value:~4} N m " + _ABOVE + " N m",
    "rms torque": (
        "the motor's torque is {value:~4} N m (root mean square), above the limit of {limit:~4} N m. It gets too hot"
    ),
    "buckling shaft": (
        "the screw is pushed with {share:~3} times the {thrust:~3 N} that its shaft may bear at t = {time:.6g} s (half "
        "the Euler load). A thicker shaft would do, or both ends held"
    ),
    "critical speed": (
        "the screw turns {share:~3} times as fast as its shaft may (0.8 of the first bending frequency). A thicker or "
        "shorter shaft would do, a longer lead, or its far end held"
    ),
    "static load": "the nut bears {share:~3} times its static load rating: its grooves keep dents",
    "brake": "the brake holds {brake:~3 N m}, and the largest thrust turns the motor back with {torque:~3 N m}",
    # a hydraulic cylinder
    "pressure": "the thrust needs a pressure of {value:~4} bar " + _ABOVE + " bar",
    "flow": "the motion needs a flow of {value:~4} l/min " + _ABOVE + " l/min",
    # a path and its loads
    "near singular": (
        "the path comes near a singular pose at t = {time:.6g} s: smallest singular value {value:.3g} of the scaled "
        "Jacobian, condition {condition:.3g} (remarked on below {limit:g})"
    ),
    "legs overlap": "Legs {one} and {other} run into each other: they overlap by {overlap:~3 m} at t = {time:.4g} s",
    "bearing": (
        "leg {leg}: its {end} joint bears {load:~4 N} at the start, and its stiffness is taken about {known:~4 N}. "
        "It grows as load^0.16"
    ),
    "yields": "leg {leg} yields: a stress of {stress:.4g} MPa at t = {time:.6g} s, {ratio:.3g} times its yield stress",
    "not in time": "a simulation is not possible: {key} = {value} {what}",
    "open forces": "rigid statics leaves {forces} open; shown are those of least strain energy in the legs",
    # times and room
    "long step": (
        "simulation.step = {step:g} s is longer than output_step = {output_step:g} s: results are stored at every step"
    ),
    "cut duration": (
        "the duration of {duration:g} s is not a multiple of simulation.{name} = {step:g} s: results end at "
        "t = {end:g} s"
    ),
    "many instants": (
        "the results are of {count:.3g} instants: they " + _TAKE + ", and most of the time goes into them; "
        "output_step = {step:.1g} (s) keeps some {few}"
    ),
    "large results": "the results " + _TAKE,
    # steps and loops
    "few steps": (
        "the motion leaves the tool vibrating by some {amplitude:~2} um at {frequency:~3} Hz: {steps:~3} steps a "
        "period are fewer than the {needed:~2} that follow it. Set simulation.tolerance = 1e-4 in place of step, or "
        "step = {step:.1g} s"
    ),
    "unstable": UNSTABLE.replace("{where}", ""),
    "unstable on the way": UNSTABLE.replace("{where}", " at {count} of {instants} instants, most at t = {worst:~3 s}"),
    "unstable at poses": UNSTABLE.replace("{where}", " at {count} of {poses} poses, most {worst}"),
    "inexact forces": (
        "forces of the legs may be off by {error:.2g} % of their peak, {times:.0f} times the tolerance: steps pass "
        "over vibrations that hardly move the payload. Where forces matter set simulation.tolerance = {tolerance}"
    ),
    "summed forces": (
        "the controller sums forces without a high-pass, so that static stiffness is lost: nothing holds at rest what "
        "the drives carry; give high_pass, for example a tenth of the first frequency, or springs beside them"
    ),
    # errors of a pose
    "first order": "pose_error is of first order, shared by the compliance of the legs: {why}",
    "floor": (
        "the lowest mode lies at {frequency:.4g} Hz, but " + FLOOR_ENDS + " {end:.4g} Hz: no resonance is in its "
        "vibration"
    ),
    "no vibration": "vibration by disturbances has no row: {why}",
}


def remark(kind: str, **numbers: object) -> str:
    """The words of a kind with its numbers."""
    return fill_template(REMARKS[kind], **numbers)


@dataclass(frozen=True, kw_only=True)
class Doubt:
    """A remark on a leg, numbers from 0: its kind, how bad it is (value over limit), and its numbers."""

    leg: int
    kind: str
    severity: float
    numbers: Mapping[str, object]

    @property
    def words(self) -> str:
        """The remark."""
        return remark(self.kind, **self.numbers)


def worst_remarks(found: Iterable[Doubt]) -> list[str]:
    """One sentence for each kind of remark: of the leg where it is worst, and which others share it."""
    kinds: dict[str, list[Doubt]] = {}
    for doubt in found:
        kinds.setdefault(doubt.kind, []).append(doubt)
    texts = []
    for same in kinds.values():
        worst = largest_item(same, key=lambda doubt: doubt.severity)
        others = sorted(doubt.leg + 1 for doubt in same if doubt is not worst)
        also = f" (also legs {', '.join(map(str, others))})" if others else ""
        first, rest = brief(worst.words)
        texts.append(f"leg {worst.leg + 1}: {first}{also}" + (f". {rest}" if rest else ""))
    return texts
