"""CalculiX: solid beams, the piston and the beam of the paper's Table 2, and whole locked robots.

Robots are those of the deck that `flexapod export` writes; our solid beam has the same mesh. Rotary inertia and
shear, which a solid beam has and an Euler-Bernoulli beam leaves out, are added to first order. Both are far
below the rest: with the mode's displacement v, slope v' and v''' they add ``rho I int v'^2 dx`` to the kinetic
energy and ``(EI)^2 / (k G A) int v'''^2 dx`` to the complementary energy (Rayleigh's quotient; S. Timoshenko,
"Vibration Problems in Engineering", 3rd ed. 1955, art. 55). The second order is of the size of their square.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.results.arguments import as_pose
from flexapod.analysis.static import modes
from flexapod.common.arrays import Array
from flexapod.mechanics.shapes import lateral_basis
from flexapod.mechanics.shapes.beam_functions import gauss_unit
from flexapod.output.exchange.decks import ELEMENTS, clamped_frequencies, clamped_release
from flexapod.output.exchange.pose_deck import abaqus_deck
from flexapod.solve.fem.frequencies import frequencies
from flexapod.solve.fem.hexahedra import SolidMesh, extrude_section
from flexapod.solve.fem.section_mesh import section_mesh
from flexapod.solve.modal.actuator_modes import actuator_modes
from flexapod.solve.modal.at_poses import robot_modes
from flexapod.solve.modal.modes import RobotModes
from flexapod.verification.case import Check, case, checks
from flexapod.verification.cases.frequencies import ROLLED
from flexapod.verification.engines import calculix
from flexapod.verification.engines.engine import CALCULIX
from flexapod.verification.robots import ROUND, STEEL, with_legs, with_unequal_legs, without_cylinders, without_gravity

ONE_ELEMENT = 2.0
"""E / k G of solid elements at Poisson's ratio 0, one across the height: their section stays plane, so k = 1."""


def clamped_thick(beam: model.Actuator, gyration: float, shear: float, count: int) -> Array:
    """Frequencies [Hz] of a clamped beam with rotary inertia and shear.

    Parameters
    ----------
    beam : Actuator
        All of it outside the hub.
    gyration : float
        Radius of gyration of the section, sqrt(I / A) [m].
    shear : float
        E / k G.
    count : int
    """
    found = actuator_modes(beam, model.Simulation(basis="clamped-free", modes=count))
    shapes, (zeta, weight) = lateral_basis("clamped-free", count), gauss_unit()
    s = beam.free_length
    slope, third = (found.shapes @ shapes.values(zeta, n) / s**n for n in (1, 3))
    return _thick(
        found.frequency,
        beam.rhoA * gyration**2 * s * (slope**2 @ weight),
        beam.EI * gyration**2 * shear * s * (third**2 @ weight),
    )


def robot_thick(robot: model.Robot, found: RobotModes, shear: float) -> Array:
    """Frequencies [Hz] of a robot whose free pistons have rotary inertia and shear, E / k G."""
    shapes, n = found.system.kernel.shapes, found.system.n
    zeta, weight = gauss_unit()
    state = found.equilibrium.state
    legs = found.shapes[:, : 6 * n].reshape(-1, 6, n)
    first, k = 3 + shapes.beam.axial.count, shapes.beam.a.count
    inertia, give = np.zeros(len(legs)), np.zeros(len(legs))
    for i, leg in enumerate(robot.legs):
        s, piston = state.q[i, shapes.l_index] - leg.cylinder.mouth, leg.piston
        square = piston.EI / piston.EA
        turns = (legs[:, i, 1], -legs[:, i, 0] * np.cos(state.q[i, 1]))  # of the cylinder, in directions a and b
        for turn, start in zip(turns, (first, first + k), strict=True):
            amplitudes = legs[:, i, start : start + k]
            slope = turn[:, None] + amplitudes @ shapes.beam.a.values(zeta, 1) / s
            third = amplitudes @ shapes.beam.a.values(zeta, 3) / s**3
            inertia += piston.rhoA * square * s * (slope**2 @ weight)
            give += piston.EI * square * shear * s * (third**2 @ weight)
    return _thick(found.frequency, inertia, give)


def _thick(frequency: Array, inertia: Array, give: Array) -> Array:
    """Frequencies [Hz] of mass-normalised modes, lowered by rotary inertia and by shear.

    Written as one quotient, which for a pinned beam leaves only the product of both out.
    """
    return frequency / np.sqrt(1 + inertia + give / (2 * np.pi * frequency) ** 2)


LENGTH = 0.6  # m, of the piston
COARSE, FINE = 0.02, 0.005  # m, elements in its section: 12 and 32, edges half as long along the circle
FLAT = model.Rectangle(width=0.1524, height=0.0095)  # Table 2
EI, RHO_A = 756.65, 4.02
ALUMINIUM = model.Material(name="Table 2", E=EI / FLAT.second_moment, density=RHO_A / FLAT.area)
FREE, TIP = 1.83, 5e-3  # m
ROUNDING = 1e-5  # of eigenvalues, eps (length / thickness)^4, and of seven printed digits
SAME = 2e-5  # likewise of a body 385 times as long as thick: 5e-6 in either program
SHORT, FLATWISE = 0.3, [0, 2]  # m, and the modes across the thickness
HELD = 9 * 0.005 * 0.5 / 2**2  # of EI: hourglass control of cubes, two across the depth (T10.28)
STEP, DURATION = 1e-3, 0.22  # s: half a period
_THREE_MESHES = "CalculiX, C3D20R on three meshes and the limit of two"


def _mesh(section: model.Tube | model.Rectangle, size: float, length: float, layers: int, kind: str) -> SolidMesh:
    return extrude_section(section_mesh(section, size, kind), length, layers)


def _theirs(mesh: SolidMesh, material: model.Material, poisson: float, *, reduced: bool) -> Array:
    """CalculiX's frequencies of the clamped mesh [Hz]."""
    deck = clamped_frequencies(mesh, E=material.E, density=material.density, poisson=poisson, reduced=reduced)
    return calculix.run(deck).frequencies()


def _limit(coarse: Array, fine: Array) -> Array:
    """Limit of two meshes, the second with half the edges; errors fall with their fourth power (Richardson)."""
    return fine + (fine - coarse) / 15


def _compared(found: dict[str, Array], limit: Array, ours: Array, tolerance: Array) -> Iterator[Check]:
    """Compare ours with each mesh and their limit, within `tolerance` plus the mesh's distance from it."""
    for name, f in {**found, "limit": limit}.items():
        bound = tolerance + np.abs(limit / f - 1)
        yield from checks([f"{name}, bending {i + 1}" for i in range(len(ours))], f, ours, bound, "Hz")


def _correction(beam: model.Actuator, thick: Array) -> Array:
    """Relative decrease of the frequencies by shear and rotary inertia."""
    thin = actuator_modes(beam, model.Simulation(basis="clamped-free", modes=5)).frequency
    return 1 - thick / thin[: len(thick)]


@case(
    "Bending frequencies of the paper's Table 2 beam, 1.83 m clamped, Poisson's ratio 0",
    source=_THREE_MESHES,
    argument="as calculix-piston; shear and rotary inertia take 1e-4 at most",
    engine=CALCULIX,
)
def _calculix_beam() -> Iterator[Check]:
    beam = model.Actuator(length=FREE, free_length=FREE, EI=EI, rhoA=RHO_A)
    ours = clamped_thick(beam, FLAT.height / np.sqrt(12), ONE_ELEMENT, 5)[:3]
    found = {}
    for layers in (10, 20, 40):
        flat = _mesh(FLAT, FLAT.width, FREE, layers, "hex20")
        both = _theirs(flat, ALUMINIUM, 0.0, reduced=True)
        found[f"{layers} elements"] = both[[0, 1, 3]]  # the third bends the other way
    limit = _limit(found["20 elements"], found["40 elements"])
    return _compared(found, limit, ours, ROUNDING + _correction(beam, ours) ** 2)


@case(
    "Bending frequencies of the clamped piston, 27 mm by 600 mm of steel, Poisson's ratio 0",
    source=_THREE_MESHES,
    argument="ours with first-order shear and rotary inertia, r / L = 0.011, which take 0.1 to 1.6 %; the square of "
    "that and rounding, 1e-5; of a mesh what it differs from the limit: a circle of 8 parabolas is not a circle",
    engine=CALCULIX,
)
def _calculix_piston() -> Iterator[Check]:
    meshes = {"12 x 12 elements": (COARSE, 12), "12 x 24 elements": (COARSE, 24), "32 x 24 elements": (FINE, 24)}
    found = {
        name: _theirs(_mesh(ROUND, size, LENGTH, layers, "hex20"), STEEL, 0.0, reduced=True)[[0, 2, 4]]
        for name, (size, layers) in meshes.items()
    }
    beam = model.Actuator.from_section(section=ROUND, material=STEEL, length=LENGTH, free_length=LENGTH)
    ours = clamped_thick(beam, ROUND.diameter / 4, 2 * 7 / 6, 5)[:3]  # E / G = 2; k = 6 / 7 of a circle (Cowper)
    limit = _limit(found["12 x 12 elements"], found["32 x 24 elements"])
    return _compared(found, limit, ours, ROUNDING + _correction(beam, ours) ** 2)


@case(
    "Frequencies of our solid and of CalculiX on the same meshes of Table 2 beam and piston, Poisson's ratio 0.3",
    source="CalculiX, C3D8 and C3D20",
    argument="the same elements and quadrature: rounding of either, eps (length / thickness)^4 = 5e-6",
    engine=CALCULIX,
)
def _calculix_solid() -> Iterator[Check]:
    for name, material, mesh in (
        ("Table 2 beam, C3D8", ALUMINIUM, _mesh(FLAT, 0.05, 3.66, 73, "hex8")),
        ("Table 2 beam, C3D20", ALUMINIUM, _mesh(FLAT, 0.05, 3.66, 36, "hex20")),
        ("piston, C3D20", STEEL, _mesh(ROUND, COARSE, LENGTH, 12, "hex20")),
    ):
        theirs = _theirs(mesh, material, 0.3, reduced=False)
        ours = frequencies(mesh, E=material.E, density=material.density, poisson=0.3, count=len(theirs))
        yield from checks([f"{name}, mode {i + 1}" for i in range(len(theirs))], theirs, ours, SAME, "Hz")


@case(
    "Linear elements by kind: first frequencies across the thickness of the Table 2 beam, 0.3 m clamped, "
    "two elements of 4.75 mm deep, Poisson's ratio 0",
    source="CalculiX, C3D8, C3D8I and C3D8R",
    argument="C3D8 is the same element: rounding, 2e-5; C3D8I of another author: as far as it is itself from "
    "quadratic elements; C3D8R: half the share of the bending stiffness that its hourglass control has, whose "
    "constant is each program's own",
    engine=CALCULIX,
)
def _calculix_linear() -> list[Check]:
    kinds = ("hex20", "hex8", "hex8i", "hex8r")
    meshes = {kind: _mesh(FLAT, FLAT.height / 2, SHORT, 63, kind) for kind in kinds}
    found = {kind: _theirs(mesh, ALUMINIUM, 0.0, reduced=False)[FLATWISE] for kind, mesh in meshes.items()}
    allowed = {
        "hex8": np.full(2, SAME),
        "hex8i": np.abs(found["hex8i"] / found["hex20"] - 1),
        "hex8r": np.full(2, 0.5 * HELD / (0.75 + HELD)),
    }
    rows = []
    for kind, tolerance in allowed.items():
        ours = frequencies(meshes[kind], E=ALUMINIUM.E, density=ALUMINIUM.density, count=3)[FLATWISE]
        names = [f"{ELEMENTS[kind, False]}, flatwise {i}" for i in (1, 2)]
        rows += checks(names, found[kind], ours, tolerance, "Hz")
    return rows


@case(
    "Tip of the Table 2 beam, 1.83 m clamped, released from 5 mm, over half a period: our modes and a solid",
    source="CalculiX, *DYNAMIC, 24 elements C3D20, average acceleration, 1 ms",
    argument="the method lengthens periods by (omega h)^2 / 12: 0.007 mm in modes 1 to 3; higher ones, of 0.0075 mm "
    "together, may come with any phase",
    engine=CALCULIX,
)
def _calculix_release() -> list[Check]:
    mesh = _mesh(FLAT, FLAT.width, FREE, 24, "hex20")
    deck = clamped_release(
        mesh, E=ALUMINIUM.E, density=ALUMINIUM.density, force=3 * EI / FREE**3 * TIP, duration=DURATION, step=STEP
    )
    time, moved = calculix.run(deck).displacements("TIP")
    theirs = 1e3 * moved[:, :, 1].mean(axis=1)
    still = model.ActuatorMotion()
    beam = model.Actuator(length=FREE, free_length=FREE, EI=EI, rhoA=RHO_A)
    initial = model.ActuatorInitial(tip_displacement=TIP)
    ours = simulate_actuator(
        beam, still, initial=initial, modes=6, step=1e-4, duration=DURATION, output_step=STEP, rho_inf=1.0
    )
    picks = np.arange(0, len(time), 20)  # the static step ends at 1 s
    tip = np.interp(time[picks] - 1, ours.time.values, 1e3 * ours.tip_deflection.values)
    names = [f"tip at {1e3 * (t - 1):.0f} ms" for t in time[picks]]
    return checks(names, theirs[picks], tip, 0.022, "mm", absolute=True)


COUNT = 17  # the platform's six frequencies and first bending of the pistons
BENDING = slice(3, 13)  # of these the ones of the pistons, of the preset at home
SHAPES = model.Simulation(modes=6)  # to 1e-11 of the exact frequencies in first bending
MESHES = (16, 32)  # elements along a free piston
REST = 1e-5  # the spring for a locked stroke takes 5e-6; seven digits of a squared frequency
WEIGHT = 1.5e-4  # m g d / (2 omega^2 I) of a cylinder with what is inside, its joint below: 6 N m, 0.14 kg m^2, 63 Hz
TURNING = 1e-4  # of the sag: what turning joint forces add, m g times a platform's arm, over the stiffness about y


def _preset(name: str = "paper-robot") -> model.Robot:
    return model.preset(name).robot  # type: ignore[union-attr]


def _robot_frequencies(name: str, robot: model.Robot, pose: tuple[float, ...] | None) -> list[Check]:
    """CalculiX's frequencies in the limit of two meshes against ours with first-order shear and rotary inertia."""
    coarse, fine = (
        calculix.run(abaqus_deck(robot, pose, elements=n, modes=COUNT + 3)).frequencies()[:COUNT] for n in MESHES
    )
    limit = _limit(coarse, fine)
    robot = with_legs(robot, axial_modes=4)
    found = robot_modes(robot, SHAPES, as_pose(robot, pose))
    ours = robot_thick(robot, found, ONE_ELEMENT)[:COUNT]
    correction = 1 - ours / found.frequency[:COUNT]
    tolerance = REST + correction**2 + 0.5 * np.abs(limit / fine - 1)
    return checks([f"{name}, mode {i}" for i in range(1, COUNT + 1)], limit, ours, tolerance, "Hz")


@case(
    "Frequencies of the whole locked robot without gravity: the preset, pistons without cylinders, six "
    "different legs at a rolled pose",
    source="CalculiX on the deck of `flexapod export`, pistons of 16 and 32 elements C3D20 and their limit",
    argument="ours with first-order shear and rotary inertia, 1e-4 to 1e-2; its square, half of what the limit of the "
    "meshes adds, and 1e-5 for the spring that locks a stroke",
    engine=CALCULIX,
)
def _calculix_robot() -> list[Check]:
    robot = without_gravity(_preset())
    return [
        *_robot_frequencies("preset", robot, None),
        *_robot_frequencies("no cylinders", without_cylinders(robot), None),
        *_robot_frequencies("unlike legs, rolled", with_unequal_legs(robot), ROLLED),
    ]


@case(
    "The locked robot under gravity, which shifts bending frequencies by -0.6 to 0.4 %: frequencies about "
    "the sagged state, and the sag",
    source="CalculiX, *STATIC with NLGEOM, then *FREQUENCY, on the deck of `flexapod export`",
    argument="as calculix-robot, and 1.5e-4 for the weight of a turning cylinder, which linear equations leave out, m "
    "g d / (2 omega^2 I); the sag 1e-4 for the turning payload, likewise: 390 N m over 5.7e6 N m",
    engine=CALCULIX,
)
def _calculix_prestress() -> list[Check]:
    robot = _preset()
    found = [replace(check, tolerance=check.tolerance + WEIGHT) for check in _robot_frequencies("preset", robot, None)]
    _, moved = calculix.run(abaqus_deck(robot)).displacements("PAYLOAD")
    theirs = 1e6 * moved[0].mean(axis=0)  # six equal masses about the centre
    ours = 1e6 * modes(robot).com_sag.values
    sag = checks(["sag y", "sag z"], theirs[1:], ours[1:], TURNING, "um")
    return [*found[BENDING], *sag]


@case(
    "Frequencies of the presets tripod (3-RPS), flight-simulator (6-UCU) and machine-hexapod (as drawn: "
    "joints and plates that give way, screws) under gravity, drives locked",
    source="CalculiX, *STATIC with NLGEOM, then *FREQUENCY, on the deck of `flexapod export`, 20 elements a piston",
    argument="shear and rotary inertia, which beams have not: ten times (thickness / length)^2 in stiffness, at most "
    "1e-2; and the weight of what turns, which the deck's linear equations leave out",
    engine=CALCULIX,
)
def _calculix_mechanisms() -> list[Check]:
    found = []
    for name in ("tripod", "flight-simulator", "machine-hexapod"):
        robot = _preset(name).replace(heat=None)
        theirs = calculix.run(abaqus_deck(robot, elements=20, modes=8)).frequencies()[:6]
        ours = modes(robot).frequency.values[:6]
        found += checks([f"{name}, mode {i}" for i in range(1, 7)], theirs, ours, 5e-3, "Hz")
    return found
