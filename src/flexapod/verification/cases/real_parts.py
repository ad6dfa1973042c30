"""Real parts of a leg: catalogues' worked examples, springs in series, rotors."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexapod import model
from flexapod.analysis.checks.screws import buckling_thrust
from flexapod.analysis.elastic_parts import parts
from flexapod.analysis.static import modes
from flexapod.common.arrays import Array
from flexapod.mechanics.elements.friction import bristle_friction
from flexapod.mechanics.elements.springs import springs_along
from flexapod.mechanics.symbolic.functions import Interpreted, NamedFunction
from flexapod.mechanics.symbolic.vocabulary import constant, substitute, symbol, zeros
from flexapod.model import Robot, ScrewDrive
from flexapod.model.leg.drive import Feedback, ServoDrive
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.material import Material
from flexapod.model.leg.screw import Bearing, Limits, Nut
from flexapod.verification.case import Check, case, checks
from flexapod.verification.robots import with_legs

UM = 1e6  # N/m of an N/um


def machine(**changes: Any) -> Robot:
    """Preset machine-hexapod without heat, with parts of its legs changed."""
    return with_legs(model.preset("machine-hexapod").robot.replace(heat=None), **changes)


def _screw(robot: Robot) -> ScrewDrive:
    drive = robot.legs[0].screw
    if drive is None:
        raise ValueError("a robot on screws is needed")
    return drive


@case(
    "Screws of a catalogue: stiffness of a shaft with the nut at two places, error of a load there; "
    "buckling, preloaded nut and bearing",
    source="THK General Catalogue, Ball Screw, A-694, A-696, A-707 to A-714 (BNF2512-2.5: root 21.9 mm, 2.06e5 N/mm^2, "
    "1500 N; 17.5 mm over 1100 mm); IBC Ball screw support bearings, p. 9: twice the preload, 1.26 times the stiffness",
    argument="half a unit of the printed digits; of the buckling load 1 %, as its formula has factors of two digits",
)
def _screw_catalogue() -> list[Check]:
    steel = Material(name="given", E=2.06e11, density=7850.0)
    screw = _screw(machine()).replace(root_diameter=0.0219, mounting="fixed-supported", material=steel)
    leg = machine(drive=screw).legs[0]
    shaft = next(spring for spring in springs_along(leg) if spring.name == "screw")
    begin = leg.piston.length + screw.bearing.position
    stiffness = 1 / shaft.at_length(np.array([0.1, 0.7]) + begin) / UM
    gives = 1500 / stiffness  # um
    thrust = buckling_thrust(screw.replace(root_diameter=0.0175, mounting="fixed-fixed", length=1.1), np.array([1.1]))
    pair = {"model": "angular-contact", "position": 0.06, "balls": 16, "ball_diameter": 7e-3, "contact_angle": 1.0}
    bearings = [Bearing(preload=preload, **pair).k for preload in (1700.0, 3400.0)]  # type: ignore[arg-type]
    nut = Nut(rigidity=1130 * UM, preload=3080.0, dynamic_load=30.8e3).k / (1130 * UM)
    return [
        *checks(["nut at 100 mm", "nut at 700 mm"], [776, 111], stiffness, 0.5, "N/um", absolute=True),
        *checks(["gives at 100 mm", "at 700 mm"], [1.9, 13.5], gives, 0.05, "um", absolute=True),
        Check("difference of the two", 11.6, gives[1] - gives[0], 0.05, "um", absolute=True),
        Check("allowed thrust, fixed at both ends", 15500.0, float(thrust[0]), 0.01, "N"),
        Check("nut at a tenth of its dynamic load, of its rigidity", 0.8, nut, 1e-12),
        Check("bearing, twice the preload", 1.26, bearings[1] / bearings[0], 0.005, absolute=True),
    ]


PRINTED = (780.60, 780.60, 903.89, 1061.43, 1061.43, 1269.66)


@case(
    "Preset nano-hexapod: struts of its flexures and actuators in series, frequencies with ideal joints",
    source="github.com/tdehaeze/stewart-simscape: flexures of 93.95 N/um and struts of 20 N/um, which are 14.03 N/um; "
    "frequencies that its model prints for struts of 20 N/um without gravity",
    argument="half a unit of the printed digits; its struts have the inertia of their sections, 3e-4 of a frequency",
)
def _flexures_in_series() -> list[Check]:
    robot = model.preset("nano-hexapod").robot
    leg = robot.legs[0]
    plain = leg.replace(piston=leg.piston.replace(EA=1e12), drive=ServoDrive(stiffness=20 * UM, damping=20.0))
    ideal = plain.replace(chain="UPS", base_joint=Joint(), platform_joint=Joint())
    found = modes(robot.replace(type="6-UPS", gravity=np.zeros(3), legs=(ideal,) * 6), fidelity="lumped")
    whole = float(parts(robot.replace(legs=(plain,) * 6)).leg_stiffness[0]) / UM
    names = [f"frequency {k}" for k in range(1, 7)]
    return [
        Check("20 N/um between two flexures", 14.03, whole, 0.005, "N/um", absolute=True),
        *checks(names, PRINTED, found.frequency.values[:6], 3e-4, "Hz"),
    ]


@case(
    "A mass on six screws in heave: rotors held, and free to turn back",
    source="sqrt(k / M) / 2 pi and sqrt(k (1 / M + 1 / m)) / 2 pi, k of shaft, twist, nut, bearing and piston by hand, "
    "m of motor and screw by the lead",
    argument="legs without mass: rounding; the loop of the free ones is 1e-7 of k",
)
def _screws_and_rotors() -> list[Check]:
    ideal = {"base_joint": Joint(), "platform_joint": Joint(), "springs": (), "damping": 0.0}
    robot = machine(**ideal)
    screw, leg = _screw(robot), robot.legs[0]
    light = {
        "cylinder": leg.cylinder.replace(mass=0.0, inertia=0.0, com=0.0, axial_inertia=0.0),
        "piston": leg.piston.replace(rhoA=0.0, axial_inertia=0.0),
    }
    robot = machine(**ideal, **light)
    length, height = robot.home_lengths[0], robot.home_height
    E, G, d = screw.material.E, screw.material.E / (2 * (1 + screw.material.poisson)), screw.root_diameter
    reach = length - leg.piston.length - screw.bearing.position
    shaft, twist = E * np.pi / 4 * d**2 / reach, G * np.pi / 32 * d**4 / reach * (2 * np.pi / screw.lead) ** 2
    piston = leg.piston.EA / leg.piston.length
    give = 1 / shaft + 1 / twist + 1 / screw.nut.k + 1 / screw.bearing.k
    k = 6 * (height / length) ** 2 / (give + 1 / piston)
    turning = screw.rotor.inertia + screw.material.density * screw.length * np.pi / 32 * d**4
    rotors = 6 * turning * (2 * np.pi / screw.lead) ** 2 * (height / length) ** 2
    mass, found = robot.payload.mass, []
    loose = screw.replace(command="servo", loop=Feedback(stiffness=1e-4), limits=Limits(), brake=None)
    for name, drive, inertia in (("held", screw, 1 / mass), ("free", loose, 1 / mass + 1 / rotors)):
        frequencies = modes(machine(**ideal, **light, drive=drive).replace(gravity=np.zeros(3)), fidelity="lumped")
        exact = np.sqrt(k * inertia) / (2 * np.pi)
        ours = frequencies.frequency.values
        found.append(Check(f"rotors {name}", exact, float(ours[np.abs(ours - exact).argmin()]), 1e-6, "Hz"))
    return found


@case(
    "A kilogram on a rough table, pulled through a spring at 0.1 m/s: place and bristle after 25 s of slips",
    source="Exudyn, Examples/lugreFrictionTest.py, with the parameters of Canudas de Wit, Olsson, Åström & Lischinsky, "
    "IEEE Trans. Automatic Control 40 (1995) 419, Table I",
    argument="SciPy's LSODA with a relative tolerance of 1e-12: 3e-10 m",
)
def _stick_slip() -> list[Check]:
    from scipy.integrate import solve_ivp  # a tenth of a second, of which the other cases have no use

    table = constant(np.array([1.0, 0.0, 1e-5, 0.5, 1e3, 0.4, np.sqrt(1e5) / 1e5, 0.0]))
    v, z, h = symbol("v"), symbol("z"), symbol("h")
    found = bristle_friction(table, zeros(1), v, v, z, h, falling=False)
    parts = [(name, substitute(getattr(found, name), (h,), (zeros(1),))) for name in ("force", "rate")]
    friction = Interpreted(NamedFunction("friction", [("v", v), ("z", z)], parts))

    def rates(t: float, y: Array) -> list[float]:
        force, rate = friction(y[1:2], y[2:])
        return [y[1], 2 * (0.1 * t - y[0]) - float(force[0]), float(rate[0])]

    x, _, bristle = solve_ivp(rates, (0, 25), [0, 0, 0], method="LSODA", rtol=1e-12, atol=1e-14).y[:, -1]
    return [
        Check("place", 1.908839199226505, x, 1e-8, "m", absolute=True),
        Check("bristle", 1.1816795455868868e-05, bristle, 1e-8, "m", absolute=True),
    ]
