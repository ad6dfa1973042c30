"""Stiffness in closed form: hinged, loaded and clamped legs, and one that is too long."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from scipy.optimize import root_scalar
from scipy.spatial.transform import Rotation
from scipy.special import spherical_jn

from flexapod.analysis.static import modes, stiffness
from flexapod.common.arrays import Array
from flexapod.kinematics import Poses, poses, rigid_limbs
from flexapod.model import CombinedMotion, Robot, Simulation
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.piston import Piston
from flexapod.model.study.payload import Payload
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.statics.equilibrium import equilibria
from flexapod.verification.case import Case, Check, case, checks
from flexapod.verification.robots import CYLINDER, PISTON, eight_legs, hexapod, table, tripod, without_gravity

RADIUS, BASE, HEIGHT = 0.2, 0.35, 0.6  # of `tripod`
MOTIONS = ("along x", "along y", "along z", "about x", "about y", "about z")


@case(
    "Stiffness of a 3-RPS at home: sideways and about the vertical only its pistons' bending holds it",
    source="bars along the legs, EA / L, and cantilevers across the hinges' planes, 3 EI / s^3, summed by hand",
    argument="the shapes contain the static answers: rounding, 1e-16 times the ratio of bars to cantilevers, 1e4, and "
    "the condition of the eliminated joints",
)
def _tripod_stiffness() -> list[Check]:
    load = Payload(mass=50.0, inertia=[2.0, 2.0, 3.0], com=[0.0, 0.0, 0.0])
    ours = stiffness(tripod().replace(gravity=[0, 0, 0], payload=load), modes=6, axial_modes=2).stiffness.values
    span = np.hypot(BASE - RADIUS, HEIGHT)
    sine, cosine = HEIGHT / span, (BASE - RADIUS) / span
    k, kb = PISTON.EA / PISTON.length, 3 * PISTON.EI / (span - CYLINDER.mouth) ** 3
    side, tilt = 1.5 * (k * cosine**2 + kb), 1.5 * k * (RADIUS * sine) ** 2
    coupling = 1.5 * k * RADIUS * sine * cosine
    exact = [side, side, 3 * k * sine**2, tilt, tilt, 3 * kb * RADIUS**2, coupling]
    return checks([*MOTIONS, "x with pitch"], exact, [*np.diag(ours), abs(ours[0, 4])], 1e-9, "N/m, N, N m")


@case(
    "Surge, sway and torsion that follow where heave, roll and pitch of a 3-RPS are commanded, turns to 0.25",
    source="closed form: three balls in the hinges' planes, x = h/2 (R11 - R22), y = -h R21, R12 = R21 (no torsion)",
    argument="closed by Newton's method: rounding of a metre, times the condition of the closures, below 1e3",
)
def _tripod_parasitic_motion() -> Iterator[Check]:
    amplitudes = {"heave": 0.03, "roll": 0.25, "pitch": -0.2}
    motion = CombinedMotion(amplitudes=amplitudes, duration=1.0)  # type: ignore[arg-type]
    path = poses(tripod(), motion, np.array([0.3, 0.5, 1.0]))
    for i, R in enumerate(path.rotation):
        place = [RADIUS / 2 * (R[0, 0] - R[1, 1]), -RADIUS * R[1, 0], 0.0]
        torsion = Rotation.from_matrix(R).as_quat(canonical=True)[2]
        ours = [*path.position[i, :2], torsion]
        names = [f"instant {i + 1}, {name}" for name in ("surge", "sway", "torsion / 2")]
        yield from checks(names, place, ours, 1e-12, "m, 1", absolute=True)


EI, RHOA, SPAN = 5e3, 4.5, 0.8  # of `table`
IMMOVABLE = 1e12  # kg, and kg m^2
STIFF = 1e11  # N: next to nothing is lost by squeezing
Root = Callable[[float, float], float]


def _fixed(a: float, b: float) -> float:
    return 2 * a * b * (1 / np.cosh(a) - np.cos(b)) + (a**2 - b**2) * np.tanh(a) * np.sin(b)


ENDS: dict[str, tuple[str, float, Root]] = {  # chain, buckling load in EI / L^2, what vanishes at a frequency
    "both ends turn": ("UPS", np.pi**2, lambda a, b: np.sin(b)),
    "welded to the platform": ("UPF", 20.190728556427, lambda a, b: a * np.sin(b) - b * np.cos(b) * np.tanh(a)),
    "both ends welded": ("FPF", 4 * np.pi**2, _fixed),
}
SHARES = (0.0, 0.5, 0.99)  # of the buckling load


def _frequency(root: Root, thrust: float) -> float:
    """First frequency [Hz] of a beam under a thrust in EI / L^2: waves cosh a x and cos b x."""

    def value(square: float) -> float:  # rhoA omega^2 L^4 / EI
        middle = np.sqrt(thrust**2 / 4 + square)
        return root(np.sqrt(max(middle - thrust / 2, 0.0)), np.sqrt(middle + thrust / 2))

    grid = np.linspace(1e-3, 30.0, 3000) ** 2
    values = np.array([value(x) for x in grid])
    i = int(np.flatnonzero(values[1:] * values[:-1] < 0)[0])
    square = root_scalar(value, bracket=(grid[i], grid[i + 1]), xtol=1e-14 * grid[i]).root
    return float(np.sqrt(square * EI / RHOA) / SPAN**2 / (2 * np.pi))


def _spread(chain: str) -> Robot:
    """Six legs all of which is piston, which share a vertical load, under an immovable platform."""
    load = Payload(mass=IMMOVABLE, inertia=[IMMOVABLE] * 3, com=[0, 0, 0])
    found = hexapod(chain)
    span = float(found.home_lengths[0])
    piston = Piston(length=SPAN, EA=STIFF, EI=EI, rhoA=RHOA)
    bare = found.legs[0].replace(cylinder=Cylinder(mass=0.0, mouth=0.0), piston=piston)
    joints = {name: getattr(found, name) * SPAN / span for name in ("base_joints", "platform_joints")}
    height = found.home_height * SPAN / span
    return found.replace(**joints, home_height=height, legs=(bare,) * 6, payload=load, gravity=[0, 0, 0])


def _bound(wave: float, thrust: float, left: float) -> float:
    """Relative error of a frequency of which a share `left` of the stiffness remains; of the stiffness it is twice.

    What six polynomials, curvature of degree 5, lack of a sine of this wave (radians along the leg), doubled for what
    a fixed end adds to the sine; and the leg's squeezing, by which its square of length is less.
    """
    n = np.arange(6, 30)
    lacking = float(np.sum((2 * n + 1) * spherical_jn(n, wave / 2) ** 2))
    return 2 * (lacking + thrust / STIFF) / left + 1e-9


@case(
    "Sideways stiffness of a table that does not tilt, four upright legs welded to it, under load: 48 EI / "
    "L^3 or 12 EI / L^3 at none, nothing where the legs buckle",
    source="beam-column in closed form, P / L / (tan x / x - 1) a leg, x = L sqrt(P / EI), welded at the base half of "
    "that",
    argument="as for thrust-on-legs, where a fiftieth of the stiffness is left",
)
def _table_sway() -> Iterator[Check]:
    for ends, chain, base in (("welded", "FPF", 2), ("hinged", "UPF", 1)):
        robot = table(chain, mass=1.0, inertia=1.0, EA=STIFF).replace(gravity=[0, 0, 0])
        for share in (0.01, 0.5, 0.99):
            x = share * np.pi / 2  # of the wave, from where the leg does not turn to where it bears no moment
            thrust = EI * (base * x / SPAN) ** 2
            reference = 4 * thrust / SPAN / (np.tan(x) / x - 1)
            load = [0, 0, -4 * thrust, 0, 0, 0]
            ours = stiffness(robot, load=load, modes=6, axial_modes=2).stiffness.values[0, 0]
            what, bound = f"{ends} at the base, {share:g} of the wave", 2 * _bound(base * x, thrust, 1 - share**2)
            yield Check(what, reference, float(ours), bound, "N/m")


@case(
    "First frequency of a leg between a fixed base and an immovable platform, free to turn or welded there, "
    "to 0.99 of its buckling load, pi^2, 20.19 and 4 pi^2 EI / L^2",
    source="characteristic equations of a beam under thrust in closed form; Timoshenko & Gere, sec. 2.1",
    argument="what six polynomials lack of a sine, twice for ends that are fixed, and the squeezing of the leg, P / "
    "EA; a hundred times that where a hundredth of the stiffness is left",
)
def _thrust_on_legs() -> Iterator[Check]:
    for ends, (chain, buckling, root) in ENDS.items():
        robot = _spread(chain)
        rise = (robot.home_vectors / robot.home_lengths[:, None])[0, 2]
        for share in SHARES:
            thrust = share * buckling
            load = [0, 0, -6 * rise * thrust * EI / SPAN**2, 0, 0, 0]
            ours = modes(robot, load=load, modes=6, axial_modes=2).frequency.values[6:]
            exact = _frequency(root, thrust)
            square = (2 * np.pi * exact) ** 2 * RHOA * SPAN**4 / EI
            wave = np.sqrt(thrust / 2 + np.sqrt(thrust**2 / 4 + square))
            what, bound = f"{ends}, {share:g} of the buckling load", _bound(wave, thrust * EI / SPAN**2, 1 - share)
            yield Check(what, exact, float(ours[0]), bound, "Hz")


def _lever(arm: Array) -> Array:
    """Matrix (6, 6) from shift and turn of a point to those of the point `arm` further on."""
    A = np.eye(6)
    A[:3, 3:] = np.cross(np.eye(3), arm).T
    return A


def _series(vector: Array, axes: Array, end: Array) -> Array:
    """Compliance (6, 6) of a leg at its tip, world axes: cantilever, bar and shaft, then a flexure at either end."""
    s = np.linalg.norm(vector) - CYLINDER.mouth
    shear, both, turn = s**3 / (3 * PISTON.EI), s**2 / (2 * PISTON.EI), s / PISTON.EI
    C = np.diag([shear, shear, PISTON.length / PISTON.EA, turn, turn, PISTON.length / PISTON.torsional_stiffness])
    C[0, 4] = C[4, 0] = both
    C[1, 3] = C[3, 1] = -both
    six, far = np.kron(np.eye(2), axes), _lever(vector)
    return six @ (C + end) @ six.T + far @ six @ end @ six.T @ far.T


def _exact(robot: Robot, end: Array) -> Array:
    total, tool = np.zeros((6, 6)), robot.home_position + robot.payload.tool
    for vector, tip, axes in zip(robot.home_vectors, robot.home_tips, rigid_limbs(robot).frames, strict=True):
        at = _lever(tip - tool)
        total += at.T @ np.linalg.solve(_series(vector, axes, end), at)
    return total


def _welded(joint: Joint, end: Array) -> Iterator[Check]:
    robot = without_gravity(hexapod("FPF", joint=joint))
    ours, exact = stiffness(robot, modes=2, axial_modes=1).stiffness.values, _exact(robot, end)
    scale = np.sqrt(np.diag(exact))
    gap = np.abs(ours - exact) / np.outer(scale, scale)
    yield from checks(MOTIONS, np.diag(exact), np.diag(ours), 1e-8, "N/m, N m")
    yield Check("all 36", 0, float(gap.max()), 1e-8, absolute=True)


WELDED = [
    Case(
        name=f"{name}-hexapod",
        statement=f"Stiffness of a hexapod at its tool, legs {kind}",
        source="in each leg compliances in series, s^3 / 3 EI, s^2 / 2 EI, s / EI, L / EA, L / GJ and those of its "
        "joints a lever away; over the legs stiffnesses in sum",
        argument="the shapes contain the static answers: rounding times the ratio of bars to springs, 1e6",
        compute=partial(_welded, joint, end),
    )
    for name, kind, joint, end in (
        ("welded", "welded at both ends", Joint(), np.zeros((6, 6))),
        (
            "flexure",
            "on flexures at both ends",
            Joint(bending=150.0, torsion=200.0),
            np.diag([0, 0, 0, 1 / 150, 1 / 150, 1 / 200]),
        ),
    )
]


MISFIT, LEG = 1e-4, 2  # m, of leg 3
SHIFT, TURN = np.array([0.03, -0.02, 0.04]), np.array([0.2, -0.15, 0.1])


def least_energy(robot: Robot, position: Array, R: Array, lengths: Array) -> Array:
    """Thrusts (8,) of bars of given lengths where a platform without weight comes to rest: Newton's method."""
    k = np.array([leg.piston.EA / leg.piston.length for leg in robot.legs])
    thrust = np.zeros(len(k))
    for _ in range(12):
        arms = robot.platform_joints @ R.T
        ways = position + arms - robot.home_bases
        now = np.linalg.norm(ways, axis=1)
        along = ways / now[:, None]
        J, thrust = np.hstack([along, np.cross(arms, along)]), k * (lengths - now)
        across = (np.eye(3) - along[:, :, None] * along[:, None, :]) * (thrust / now)[:, None, None]
        turns = np.cross(np.eye(3), arms[:, None]).swapaxes(1, 2)
        moves = np.concatenate([np.broadcast_to(np.eye(3), turns.shape), turns], axis=2)
        K = (J.T * k) @ J - np.einsum("nai,nab,nbj->ij", moves, across, moves)
        step = np.linalg.solve(K, J.T @ thrust)
        position, R = position + step[:3], Rotation.from_rotvec(step[3:]).as_matrix() @ R
    return thrust


@case(
    "Thrusts of an 8-UPS far from home, turned by 0.27, whose third leg is 0.1 mm too long",
    source="least energy of eight bars between the joints, by Newton's method, without shapes or multipliers",
    argument="1e-6 of the largest thrust: kilonewtons from 1e-5 m of stretch, in lengths known to 1e-15 m",
)
def _eight_legs_misfit() -> list[Check]:
    robot = without_gravity(eight_legs())
    robot = robot.replace(legs=tuple(leg.replace(axial_modes=2) for leg in robot.legs))
    position, R = robot.home_position + SHIFT, Rotation.from_rotvec(TURN).as_matrix()
    settings = Simulation(fidelity="assumed-modes", modes=6)
    held = locked_poses(robot, settings, Poses.at_rest(position, R))
    command = held.command.copy()
    command[0, LEG, 0] += MISFIT
    found = equilibria(held.system, held.start, command, held.acts.force, np.zeros(6))
    exact = least_energy(robot, position, R, command[0, :, 0])
    size, names = np.abs(exact).max(), [f"leg {i + 1}" for i in range(8)]
    return checks(names, exact, found.states.drive[0, :, 0], 1e-6 * size, "N", absolute=True)
