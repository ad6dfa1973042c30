"""Machines as built, at operating temperature and base-excited, and their error budgets."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from flexapod import kinematics, model
from flexapod.analysis.error_budget import budget
from flexapod.analysis.simulation import simulate
from flexapod.common.arrays import Array
from flexapod.model import Geometry, Heat
from flexapod.model.leg.drive import PrescribedDrive
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.material import MATERIALS
from flexapod.solve.linear.random_vibration import LinearRobot, Source, random_vibration
from flexapod.verification.case import Check, case, checks
from flexapod.verification.cases.real_parts import machine
from flexapod.verification.robots import hexapod

# Nominal and real parameters of Nategh & Agheli's hexapod [mm].
S = [(92.1597, 84.4488), (27.055, 122.037), (-119.2146, 37.5882)]
U = [(305.4001, 111.1565), (-56.4357, 320.0625), (-248.9644, 208.9060)]
REAL_S = [
    (96.6610, 81.7602, 1.0684), (22.2476, 125.2511, -0.5530), (-122.4519, 36.6453, 4.3547),
    (-120.6859, -34.4565, -4.9014), (24.7769, -125.0489, -4.8473), (91.3462, -80.9866, 0.2515),
]  # fmt: skip
REAL_U = [
    (305.2599, 115.0695, 2.6210), (-55.2814, 322.9819, 4.2181), (-244.7954, 208.0087, 3.9365),
    (-252.5755, -211.8783, -3.0128), (-53.9678, -320.6115, 4.3181), (302.4266, -109.4351, 3.3812),
]  # fmt: skip
L0, REAL_L0 = 604.8652, (604.4299, 607.2473, 600.4441, 605.9031, 604.5251, 600.0616)
POSE, PLACE, ANGLES = (-0.025, -0.75, 0.8), (21.31, -731.19, 818.91), (0.95, 3.68, -9.14)


def _mirrored(points: list[tuple[float, float]]) -> Array:
    return np.array([(x, y, 0.0) for x, y in points] + [(x, -y, 0.0) for x, y in points[::-1]])


@case(
    "Pose of a hexapod whose 42 parameters differ from its drawing by up to 7 mm, commanded to (-25, -750, 800) mm",
    source="Nategh & Agheli's parameters, calibration.m and html/calibration.html of "
    "github.com/tabathaviso/hexapod-parallel-manipulator",
    argument="printed to 0.01 mm; its solver left angles at about a hundredth of a degree",
)
def _built_hexapod() -> list[Check]:
    base, platform = 1e-3 * _mirrored(U), 1e-3 * _mirrored(S)
    geometry = Geometry(
        base_joints=1e-3 * np.array(REAL_U) - base,
        platform_joints=1e-3 * np.array(REAL_S) - platform,
        leg_offset=1e-3 * (np.array(REAL_L0) - L0),
    )
    robot = hexapod().replace(base_joints=base, platform_joints=platform, geometry=geometry)
    found = kinematics.built_poses(robot, kinematics.Poses.at_rest(POSE, np.eye(3)))
    angles = Rotation.from_matrix(found.rotation[0]).as_euler("XYZ", degrees=True)
    return [
        *checks(["x", "y", "z"], PLACE, 1e3 * found.position[0], 0.006, "mm", absolute=True),
        *checks(["about x", "about y", "about z"], ANGLES, angles, 0.015, "deg", absolute=True),
    ]


@case(
    "Preset machine-hexapod warmed as a whole by 25 K, moved and turned: places grow, nothing turns",
    source="a similarity, exactly: 12e-6 of the place for each kelvin; THK A-715: 5 K over 1 m are 0.06 mm",
    argument="forward kinematics by Newton's method: rounding of a metre",
)
def _warm_hexapod() -> list[Check]:
    hot = np.full(6, 45.0)
    warm = Heat(reference=20.0, base=45.0, platform=45.0, piston=hot, cylinder=hot, screw=hot)
    alpha = MATERIALS["steel"].expansion or 0.0
    robot = machine().replace(heat=warm, geometry=None)
    path = kinematics.poses_from_home(robot, np.array([[0.02, -0.03, 0.04, 0.1, -0.05, 0.15]]))
    found = kinematics.built_poses(robot, path)
    grown = 25 * alpha * path.position[0]
    turned = Rotation.from_matrix(found.rotation[0] @ path.rotation[0].T).magnitude()
    moved = (found.position - path.position)[0]
    return [
        *checks(["growth along x", "along y", "along z"], grown, moved, 1e-13, "m", absolute=True),
        Check("turn", 0.0, float(turned), 1e-13, "rad", absolute=True),
        Check("a metre by 5 K", 0.06, 5e3 * alpha, 0.005, "mm", absolute=True),
    ]


@case(
    "Rms of a noise with the amplitude density 1e-9 / (1 + s / (2 pi 100)) from 1 to 1000 Hz, and of 2e-8; "
    "of a white force and a white floor on one mode",
    source="T. Dehaeze, noise budgeting of the nano-active stabilisation system (12.1 nm, 241.8 nrad); Crandall & "
    "Mark, Random Vibration in Mechanical Systems, sec. 2.2; Miles 1954",
    argument="half a unit of the printed digits; the spectrum in 400 places; what lies outside of its band, 1e-5",
)
def _noise_budget() -> list[Check]:
    f, found = np.geomspace(1.0, 1000.0, 400), []
    far = _one_mode(1e7, 0.5, 1.0)
    for size, printed, unit in ((1e-9, 12.1, "nm"), (2e-8, 241.8, "nrad")):
        density = (size**2 / (1 + (f / 100) ** 2))[:, None]
        source = Source(name="noise", forces=far.inputs["force"], frequency=f, density=density)
        ours = 1e9 * random_vibration(far, [source]).rms[0]
        found.append(Check(f"noise of {size:g}", printed, float(ours), 0.051, unit, absolute=True))
    f0, ratio, k = 20.0, 0.01, 3e6
    near = _one_mode(f0, ratio, k)
    for name, level, exact in (
        ("force", 0.04, np.sqrt(np.pi * f0 * 0.04 / (4 * ratio)) / k),
        ("floor", 1e-6, np.sqrt(1e-6 / (64 * np.pi**3 * f0**3 * ratio))),
    ):
        white = Source(
            name=name, forces=near.inputs[name], frequency=np.array([1e-4, 1e6]), density=np.full((2, 1), level)
        )
        ours = random_vibration(near, [white]).rms[0]
        found.append(Check(f"white {name}", float(exact), float(ours), 1e-5, "m"))
    return found


def _one_mode(f0: float, ratio: float, k: float) -> LinearRobot:
    """A mass on a spring that moves the tool along x; a force on it, and an acceleration of its base."""
    omega, tool = 2 * np.pi * f0, np.zeros((6, 1))
    tool[0] = 1 / np.sqrt(k)
    inputs = {"force": np.array([[1 / np.sqrt(k)]]), "floor": np.array([[-np.sqrt(k) / omega**2]])}
    return LinearRobot(omega=np.array([omega]), damping=np.array([[2 * ratio / omega]]), tool=tool, inputs=inputs)


AXES = ("x", "y", "z")


@case(
    "Error budget of the preset machine-hexapod: its systematic total is where a simulation at rest starts, "
    "and a part made ideal takes its row out of it",
    source="a simulation of the same study; the total of the other study less this one's",
    argument="the same equilibrium: rounding of a metre; rows are of first order, what is of second is below 2 %",
)
def _budget() -> list[Check]:
    warm = machine().replace(heat=model.preset("machine-hexapod").robot.heat)
    still = model.AxisMotion(type="heave", amplitude=0.0, duration=1.0)
    whole = budget(warm)
    total = whole.budget_total.sel(kind="systematic").values
    start = simulate(warm, still, duration=2e-3, step=1e-3).isel(time=0)
    found = checks([f"start, {x}" for x in AXES], start.tool_deviation.values, total[:3], 1e-13, "m", absolute=True)
    names = [f"start, about {x}" for x in AXES]
    found += checks(names, start.rotation_deviation.values, total[3:], 1e-13, "rad", absolute=True)
    drawn = budget(machine())
    for name, rows, before, after in (
        ("platform joints", ["platform_joint"], drawn, machine(platform_joint=Joint())),
        ("screws", ["screw", "twist", "nut", "bearing"], drawn, machine(drive=PrescribedDrive())),
        ("heat", [x for x in whole.part.values if x.startswith("heat_")], whole, machine()),
    ):
        z = {"kind": "systematic", "component": "z"}
        row = before.budget.sel(part=rows, **z).sum("part")
        change = before.budget_total.sel(**z) - budget(after).budget_total.sel(**z)
        found.append(Check(f"{name} made ideal, z", float(row), float(change), 0.02, "m"))
    return found
