"""An electric cylinder around a ball screw of the catalogue: its lengths and masses, and its tables in a study file."""

from __future__ import annotations

import math
from dataclasses import dataclass

from flexapod.common.quantities import number
from flexapod.design.first_robot import sizing
from flexapod.design.first_robot.catalogue import BORE, FASTEST, Screw, joint_stiffness, motor_inertia, motor_mass
from flexapod.design.first_robot.sizing import Joints, SizedLeg
from flexapod.design.first_robot.study_text import (
    LEG,
    Plan,
    comment_lines,
    length_text,
    material_words,
    stroke_origin,
    value_origin,
)
from flexapod.design.first_robot.warm import accuracy_tables
from flexapod.model import MATERIALS

TUBE = 1.7  # diameter of the piston over that of its screw, at least
HOLLOW = 1.25, 0.65  # inner diameter of the piston: over the screw's, over its own, at least
OUTER, INSIDE = 1.5, 1.17  # diameters of the cylinder over the piston's
GUIDED, FREE = 1.0, 1.5  # diameters of the piston: guided at the longest, outside at the shortest
POSITION, NUT, ROOM = 2.0, 2.0, 1.5  # diameters of the screw: bearing from the joint, nut from it, shaft beyond
SLENDER = 10.0  # free length over width below which shear counts
STEEL = MATERIALS["steel"].density
SECANT = "Schaeffler, Rolling bearings HR 1, p. 52-53"


def longest_stroke(joints: Joints, screw: Screw, diameter: float) -> float:
    """The longest stroke of a leg with this screw and this piston [m]."""
    return (joints.length - (GUIDED + FREE) * diameter - (POSITION + NUT) * screw.nominal) / 1.5


def electric_leg(joints: Joints, stroke: float, screw: Screw, diameter: float) -> SizedLeg | None:
    """Lengths of a leg for a stroke about home; None if it does not fit.

    Drawn in, bearing and nut are before the piston in the cylinder; drawn out, one width of it is guided.
    """
    if stroke > longest_stroke(joints, screw, diameter):
        return None
    digit = joints.digit
    shortest = sizing.round_down(joints.length - stroke / 2, digit)
    longest = sizing.round_up(joints.length + stroke / 2, digit)
    least = longest - shortest + GUIDED * diameter + (POSITION + NUT) * screw.nominal
    mouth = sizing.round_down(max(min(sizing.MOUTH * joints.length, shortest - FREE * diameter), least), digit)
    piston = sizing.round_up(longest - mouth + GUIDED * diameter, digit)
    return SizedLeg(shortest=shortest, longest=longest, mouth=mouth, piston=piston, diameter=diameter)


@dataclass(frozen=True, kw_only=True)
class ElectricActuator:
    """Electric drive as chosen: a `screw`, the rated `torque` [N m] of its motor, the `preload` [N] of its nut.

    `load`: thrust on a leg at rest at home [N]; `leg`: its lengths.
    """

    screw: Screw
    torque: float
    preload: float
    load: float
    leg_: SizedLeg

    @property
    def sources(self) -> tuple[str, ...]:
        """Sources of the values of the parts, as text."""
        return (
            f"The legs are electric cylinders with ball screws {self.screw.name}; catalogue values are in the data "
            "sheets that are named. What is chosen besides is in proportion to the preset machine-hexapod.",
        )

    @property
    def inner(self) -> float:
        """Inner diameter of the piston [m]: the screw turns in it."""
        most = max(HOLLOW[0] * self.screw.nominal, HOLLOW[1] * self.leg_.diameter)
        return sizing.round_up(most, BORE) if most > 0.01 else sizing.round_up(most, BORE / 2)

    @property
    def position(self) -> float:
        """Position of the bearing, from the base joint [m]."""
        return round(POSITION * self.screw.nominal, 6)

    @property
    def shaft(self) -> float:
        """Length of the screw from its bearing [m]."""
        leg = self.leg_
        return sizing.round_up(leg.longest - leg.piston - self.position + ROOM * self.screw.nominal, 1e-3)

    @property
    def drag(self) -> float:
        """Torque of friction at the screw [N m]: preload (T15.43), bearing and seals."""
        slope = self.screw.lead / (math.pi * self.screw.root)
        preload = 0.05 / math.sqrt(slope) * self.preload * self.screw.lead / (2 * math.pi)
        return preload + 0.1 * (self.screw.nominal / 0.032) ** 2

    def cylinder(self) -> tuple[float, float, float, float]:
        """Mass [kg], centre of mass [m], inertia across about it and along the axis [kg m^2]."""
        leg, motor = self.leg_, motor_mass(self.torque)
        outer, bore = OUTER * leg.diameter / 2, INSIDE * leg.diameter / 2
        tube = STEEL * math.pi * (outer**2 - bore**2) * leg.mouth
        screw = STEEL * math.pi / 4 * self.screw.nominal**2 * self.shaft
        # mass, place, inertia across and along; the motor stands beside the bearing
        of_tube, of_motor = tube * (outer**2 + bore**2) / 2, motor * (OUTER * leg.diameter) ** 2
        parts = (
            (tube, leg.mouth / 2, tube * leg.mouth**2 / 12 + of_tube / 2, of_tube),
            (screw, self.position + self.shaft / 2, screw * self.shaft**2 / 12, 0.0),
            (motor, self.position, of_motor / 2, of_motor),
        )
        mass = tube + screw + motor
        com = sum(m * at for m, at, _, _ in parts) / mass
        across = sum(m * (at - com) ** 2 + own for m, at, own, _ in parts)
        along = sum(own for *_, own in parts)
        return mass, com, across, along

    def leg(self, plan: Plan) -> list[str]:
        """The table of the legs."""
        return [LEG, *_joints(self, plan), *_bodies(self, plan), "", *_drive(self)]

    def tables(self, plan: Plan) -> list[str]:
        """Tables of temperatures and tolerances of the machine."""
        return accuracy_tables(plan, {"piston": (22, "warmed through the nut"), "cylinder": (22, "as the piston"),
                             "screw": (25, "THK A-715 corrects leads for 2 to 5 K")}, lead=True)  # fmt: skip


def stiffness_text(stiffness: float, digits: int = 3) -> str:
    """A stiffness in N/um."""
    return f"{number(1e-6 * stiffness, digits)} N/um"


def joint_lines(bore: float, load: float, friction: str) -> list[str]:
    """Joints on needle bearings, with `friction` at the base."""
    bearings, whole = joint_stiffness(bore, load)
    along, across = stiffness_text(whole, 2), stiffness_text(0.75 * whole, 2)
    stiffness = f'stiffness = {{ axial = "{along}", radial = "{across}", loss = 0.03 }}'
    return [
        f"base_joint     = {{ {stiffness}{friction} }}",
        f"platform_joint = {{ {stiffness} }}",
        *comment_lines(
            f"stiffness: computed; needle bearings of bore {length_text(bore)} in two yokes have "
            f"{stiffness_text(bearings)} along the leg under the {number(load, 3)} N at rest ({SECANT}); "
            "pins, forks and bolts give way as much again; across the leg it is three quarters"
        ),
    ]


def plate_lines(plan: Plan) -> list[str]:
    """Lines of the study file for compliant plates at the joints."""
    ends = {"base_plate": (plan.joints.base / 0.6, "base"), "top_plate": (plan.joints.platform / 0.35, "platform")}
    springs = ", ".join(
        f'{name} = {{ stiffness = "{stiffness_text(1e9 * size, 2)}", at = "{at}", loss = 0.03 }}'
        for name, (size, at) in ends.items()
    )
    return [
        f"springs = {{ {springs} }}",
        *comment_lines(
            "springs: chosen, plates where forks are bolted to them; those of machine-hexapod with 1000 N/um, in "
            "proportion to their radii"
        ),
    ]


def _joints(self: ElectricActuator, plan: Plan) -> list[str]:
    bore = self.screw.bore
    seals = 0.1 * (bore / 0.03) ** 2
    friction = f', friction = {{ M0 = "{number(seals, 2)} N m", f1 = 0.0005, diameter = "{length_text(1.2 * bore)}" }}'
    return [
        *joint_lines(bore, self.load, friction),
        *comment_lines(
            "friction: f1 of needle bearings (HR 1, p. 55); M0 chosen for seals and preload, 0.1 N m at a bore of 30 "
            "mm, as its square; joints at the platform would add as much again"
        ),
        *plate_lines(plan),
    ]


def _bodies(self: ElectricActuator, plan: Plan) -> list[str]:
    leg, request = self.leg_, plan.request
    mass, com, across, along = self.cylinder()
    diameter = value_origin(
        request.diameter,
        f"at least {TUBE:g} times the screw that turns inside, {sizing.SAFETY:g} times safe against buckling at its "
        f"longest and against yield, no longer outside than {sizing.SLENDER:g} times its width",
    )
    shear = leg.shortest - leg.mouth < SLENDER * leg.diameter
    return [
        f'cylinder = {{ mass = "{mass:.4g} kg", com = "{length_text(sizing.round_significant(com))}", '
        f'inertia = {across:.4g}, mouth = "{length_text(leg.mouth)}", axial_inertia = {along:.3g} }}',
        *comment_lines(
            f"mouth: computed, {sizing.MOUTH:g} of the leg at home, but as deep as stroke, bearing and nut need when "
            "drawn in, and one and a half widths of the piston stay outside"
        ),
        *comment_lines(
            f"mass, com, inertia, axial_inertia: computed for a steel tube {number(1e3 * OUTER * leg.diameter, 3)}/"
            f"{number(1e3 * INSIDE * leg.diameter, 3)} mm up to the mouth, the screw, and a motor with brake of "
            f"{number(motor_mass(self.torque), 2)} kg beside the bearing"
        ),
        f'piston = {{ diameter = "{length_text(leg.diameter)}", inner_diameter = "{length_text(self.inner)}", '
        f'length = "{length_text(leg.piston)}", material = "{request.material}"{", shear = true" if shear else ""} }}',
        *comment_lines(f"diameter: {diameter}"),
        *comment_lines("inner_diameter: chosen, the screw turns inside; length: computed, one width stays guided"),
        *comment_lines(f"{material_words(request)}{'; shear: it is short and thick' if shear else ''}"),
        f'stroke = {{ min = "{length_text(leg.shortest)}", max = "{length_text(leg.longest)}" }}   # joint to joint',
        *comment_lines(f"stroke: {stroke_origin(request)}; half of it either way"),
        "damping = 0.005              # chosen: usual for bare metal; joints, nut and bearing damp more",
    ]


def _drive(self: ElectricActuator) -> list[str]:
    screw, torque, drag = self.screw, self.torque, self.drag
    loss = "0.03 in all springs: with it the lowest frequencies are damped by 1 to 2 %, as in machines"
    return [
        "[leg.drive]",
        'type = "screw"',
        f'lead = "{length_text(screw.lead)}"',
        f'root_diameter = "{length_text(screw.root)}"',
        *comment_lines(f"{screw.shaft}; the thinnest that carries thrust and speed of the path, and a 33rd of the leg "
               "at least where one fits and legs weigh no more than three payloads: such machines are sized for "
               "stiffness"),
        f'length = "{length_text(self.shaft)}"   # computed: the way of the nut, and room',
        'material = "steel"',
        "efficiency = 0.9             # THK's examples; HIWIN: 0.85 to 0.95",
        'mounting = "fixed-free"      # chosen: the far end turns inside the piston, as in all electric cylinders',
        f'bearing = {{ stiffness = "{stiffness_text(screw.bearing)}", position = "{length_text(self.position)}", '
        "loss = 0.03 }",
        *comment_lines(f"{screw.support}; position: chosen, behind the joint's fork; loss: chosen, {loss}"),
        f'nut = {{ rigidity = "{stiffness_text(screw.rigidity)}", preload = "{number(self.preload, 4)} N", '
        f'dynamic_load = "{number(screw.dynamic_load, 4)} N", loss = 0.03 }}',
        *comment_lines(f"{screw.nut}; preload: computed, {100 * self.preload / screw.dynamic_load:.3g} % of the load "
               "rating (a tenth is the most, HIWIN 3.6): no thrust of the path unloads half of the nut"),
        f'rotor = {{ inertia = "{motor_inertia(torque):.2g} kg m^2", ratio = 1 }}',
        *comment_lines(f"rotor: chosen, a servo motor of {number(torque)} N m with brake and coupling, by size from "
               "the one of machine-hexapod"),
        f'friction = {{ torque = "{number(drag, 2)} N m", viscous = "{drag / FASTEST:.2g} N m s/rad" }}',
        *comment_lines("friction: computed, the preload by THK eq. 5 (A-688), bearing and seals chosen; viscous: "
               "grease, as much again at 3000 rpm"),
        f'limits = {{ speed = "3000 rpm", torque = "{number(3 * torque)} N m", rms_torque = "{number(torque)} N m" }}',
        *comment_lines("limits: chosen, the smallest servo motor of makers' steps that moves the path; three times its "
               "torque for a short time"),
        f'brake = {{ torque = "{number(torque)} N m" }}   # chosen: usual for such a motor',
        'command = "position"         # chosen: a stiff position loop; its errors are not those of this study',
    ]  # fmt: skip
