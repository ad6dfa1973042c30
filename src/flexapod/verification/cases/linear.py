"""Linear models of robots: published plants, closed forms of drives, floors and torques, and MJCF in MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.kinematics import inverse_dynamics
from flexapod.analysis.linear import LinearModel, linearize
from flexapod.analysis.static import stiffness
from flexapod.analysis.tool_responses import compliance, transmissibility
from flexapod.output.exchange.mjcf import mjcf
from flexapod.verification.case import Check, case, checks
from flexapod.verification.engines import mujoco_forces
from flexapod.verification.engines.engine import MUJOCO
from flexapod.verification.engines.mujoco_rest import MujocoStatics
from flexapod.verification.robots import LOWER, ring

SIMSCAPE = "T. Dehaeze, stewart-simscape (MIT), commit 32330b9"
SPRING, DAMPER = 2e7, 20.0  # N/m, N s/m, of a strut
STILL = model.AxisMotion(type="heave", amplitude=0.0, duration=1.0)
FIRST, SECOND = 2.365020372431352, 5.497803919000836  # of tan a + tanh a = 0


def stewart(*, light: bool = False) -> model.Study:
    """A platform of 1 kg on struts of two rods of 0.1 kg, 50 mm, radius 5 mm; ``light``: without these masses."""
    m, L, r, M, R, h = (1e-9 if light else 0.1), 0.05, 0.005, 1.0, 0.1, 0.01
    base = ring(0.115, LOWER) + np.array([0.0, 0.0, 0.015])
    platform = ring(0.09, [-50, 50, 70, 170, 190, -70]) + np.array([0.0, 0.0, 0.075])
    # a piston is a line: what its thickness adds across, m r^2 / 4, turns with the cylinder
    across = m * (3 * r**2 + L**2) / 12 + m * r**2 / 4
    cylinder = model.Cylinder(mass=m, com=L / 2, inertia=across, axial_inertia=m * r**2 / 2, mouth=0.05)
    piston = model.Piston(length=L, rhoA=m / L, EA=1e9, EI=1e3, axial_inertia=m * r**2 / 2)
    leg = model.Leg(cylinder=cylinder, piston=piston, drive=model.ServoDrive(stiffness=SPRING, damping=DAMPER))
    inertia = np.diag([M * (3 * R**2 + h**2) / 12] * 2 + [M * R**2 / 2])
    payload = model.Payload(mass=M, inertia=inertia, com=[0, 0, 0.085], tool=[0, 0, 0.135])
    robot = model.Robot(
        base_joints=base, platform_joints=platform, legs=(leg,) * 6, payload=payload, gravity=np.zeros(3),
        home=model.Home(position=np.zeros(3)),
    )  # fmt: skip
    return model.Study(robot=robot, motion=STILL, simulation=model.Simulation(fidelity="rigid"))


def gravimeter() -> model.Study:
    """A plate of 400 kg on three struts in a plane, one along x 0.85 m below, two along y 0.5 m beside its centre."""
    top = np.array([[0.0, -0.85, 0], [-0.5, -0.85, 0], [0.5, -0.85, 0]])
    base = top - np.array([[1.0, 0, 0], [0, 1, 0], [0, 1, 0]])
    leg = model.Leg(
        chain="RPR", cylinder=model.Cylinder(mass=0.0, com=0.0, inertia=0.0, mouth=0.5),
        piston=model.Piston(length=0.9, rhoA=0.0, EA=1e9, EI=1e3), drive=model.ServoDrive(stiffness=15e3, damping=20.0),
    )  # fmt: skip
    payload = model.Payload(mass=400.0, inertia=115.0 * np.eye(3), com=np.zeros(3))
    robot = model.Robot(
        type="3-RPR", plane="xy", base_joints=base, platform_joints=top, home=model.Home(position=np.zeros(3)),
        legs=(leg,) * 3, payload=payload, gravity=np.zeros(3),
    )  # fmt: skip
    still = STILL.replace(type="surge")
    return model.Study(robot=robot, motion=still, simulation=model.Simulation(fidelity="rigid"))


def hinged_beam(hub: float) -> model.ActuatorStudy:
    """A beam of 2 m, 1.2 kg/m, 200 N m^2 that turns with a hub without radius."""
    actuator = model.Actuator(
        rhoA=1.2, EI=200.0, length=2.0, free_length=2.0, hub_radius=0.0, hub_inertia=hub, gravity=0.0, damping=0.0
    )
    return model.ActuatorStudy(actuator=actuator, simulation=model.Simulation(modes=6, basis="tip-load", duration=1.0))


def _plant() -> LinearModel:
    return linearize(stewart(), inputs=["drive", "wrench"], outputs=["drive-force", "stroke", "tool"])


@case(
    "A Stewart platform on springs: force sensors of its struts over the force of one drive",
    source=SIMSCAPE + ": Fm = F - (k + c s) dL at 10, 100, 500.84 and 10,000 Hz",
    argument="four digits are printed, a unit of the last one is up to 9e-4; its struts may turn about themselves",
)
def _force_sensors() -> list[Check]:
    H = np.abs(_plant().select("drive:1", ["drive-force", "stroke:1"]).at([10.0, 100.0, 500.84, 1e4]))[:, 0]
    names = [f"strut 1 at {hz:g} Hz" for hz in (10, 100, 500.84, 1e4)]
    found = checks(names, [1.150e-4, 1.165e-2, 0.433, 1.0097], H[0], 1e-3)
    names = [f"strut {k} at 100 Hz" for k in range(2, 7)]
    found += checks(names, [2.578e-3, 1.168e-3, 2.027e-3, 1.168e-3, 1.531e-3], H[1:6, 1], 1e-3)
    return [*found, Check("way of strut 1 at 10 Hz", 5.00e-8, float(H[6, 0]), 1e-3, "m/N")]


@case(
    "Modes, damping and compliance of the same platform",
    source=SIMSCAPE + "; a damper beside each spring: ratios c w / 2 k",
    argument="frequencies and the norm are printed with two and four digits behind the point; ratios to rounding",
)
def _stewart_modes() -> list[Check]:
    data, norm = _plant().damp(), float(compliance(stewart(), [0.0]).compliance_norm[0])
    f, ratio = data.frequency.values, data.damping_ratio.values
    names = [f"mode {k}" for k in range(1, 7)]
    found = checks(names, [780.60, 780.60, 903.89, 1061.43, 1061.43, 1269.66], f, 2e-5, "Hz")
    found += checks([f"ratio {k}" for k in range(1, 7)], DAMPER * 2 * np.pi * f / (2 * SPRING), ratio, 1e-9)
    return [*found, Check("static compliance, Frobenius norm", 7.558e-6, norm, 1e-4)]


@case(
    "A plate on three struts in a plane: its poles",
    source="T. Dehaeze, svd-control (MIT), the gravimeter",
    argument="five digits are printed: half of the last one is 4e-5",
)
def _gravimeter() -> list[Check]:
    found = linearize(gravimeter(), inputs="drive", outputs="tool").poles()
    upper = sorted(found[found.imag > 0], key=lambda s: -s.imag)
    known = [-0.12243 + 13.551j, -0.05 + 8.6601j, -0.0088785 + 3.6493j]
    names = [f"{part} of pole {k}" for part in ("real part", "imaginary part") for k in (1, 2, 3)]
    return checks(
        names, np.append(np.real(known), np.imag(known)), np.append(np.real(upper), np.imag(upper)), 5e-5, "1/s"
    )


@case(
    "Platform over floor on struts without mass, in all six directions at the tool",
    source="closed form: (J^T z J - w^2 M)^-1 J^T z J with z = k + i w c and the rates J of the struts",
    argument="struts of a microgram: 1e-8 of the platform's mass, a resonance 4e-3 away multiplies it",
)
def _floor_to_platform() -> list[Check]:
    study, hz = stewart(light=True), [300.0, 900.0, 2000.0]
    robot = study.robot
    tips, e = robot.platform_joints, robot.platform_joints - robot.base_joints
    e = e / np.linalg.norm(e, axis=1)[:, None]
    J = np.concatenate([e, np.cross(tips - robot.tool, e)], axis=1)
    carry, mass = np.eye(6), np.zeros((6, 6))
    carry[:3, 3:] = np.cross(np.eye(3), robot.com - robot.tool).T
    mass[:3, :3], mass[3:, 3:] = robot.payload.mass * np.eye(3), robot.payload.inertia  # type: ignore[union-attr]
    data = transmissibility(study, [0.0, *hz])
    T = data.transmissibility.sel(part="real").values + 1j * data.transmissibility.sel(part="imaginary").values
    found = [Check("largest difference from 1 at 0 Hz", 0.0, float(np.abs(T[..., 0] - np.eye(6)).max()), 1e-9,
                   absolute=True)]  # fmt: skip
    for k, f in enumerate(hz):
        w = 2 * np.pi * f
        z = (SPRING + 1j * w * DAMPER) * J.T @ J
        expected = np.linalg.solve(z - w**2 * carry.T @ mass @ carry, z)
        apart = float(np.abs(T[..., k + 1] - expected).max() / np.abs(expected).max())
        found.append(Check(f"largest difference at {f:g} Hz, of the largest", 0.0, apart, 1e-5, absolute=True))
    return found


@case(
    "Zeros from the torque on a hub to the tip of the beam in it, whatever the hub weighs",
    source="closed form of a hinged beam seen at its tip: tan a + tanh a = 0, s = +-2 a^2 sqrt(EI / (m L^4))",
    argument="six shapes have the first to 1e-5, the second to 1e-3",
)
def _tip_zeros() -> list[Check]:
    found, scale = [], float(np.sqrt(200.0 / (1.2 * 2.0**4)))
    for hub in (0.05, 20.0):
        lin = linearize(hinged_beam(hub), inputs="drive:rotation", outputs="tip:rotation", drives="force")
        zeros = lin.zeros()
        real = np.sort(zeros.real[(np.abs(zeros.imag) < 1e-6 * np.abs(zeros)) & (zeros.real > 0)])
        for a, tolerance, ours, name in ((FIRST, 1e-5, real[0], "first"), (SECOND, 1e-3, real[1], "second")):
            found.append(Check(f"{name} zero, hub of {hub:g} kg m^2", 2 * a**2 * scale, float(ours), tolerance, "1/s"))
    return found


@case(
    "A hub that is told to turn faster: how far its beam stays behind, and the torque that it takes",
    source="a cantilever under a load rho A x: 11 rho A L^5 / 120 EI at its tip; inertia of hub and beam",
    argument="slow, 1e-3 Hz beside 3 Hz: 1e-7; the shapes hold the answer to 1e-5",
)
def _told_rotation() -> list[Check]:
    names = ["tip:rotation", "drive-force:rotation", "stroke:rotation"]
    lin = linearize(hinged_beam(0.5), inputs="command:rotation", outputs=names)
    H = lin.at([1e-3])[:, 0, 0]
    return [
        Check(
            "lag of the tip by 1 rad/s^2", 11 * 1.2 * 2.0**5 / (120 * 200.0), float((2.0 * H[2] - H[0]).real), 1e-5, "m"
        ),
        Check("torque by 1 rad/s^2", 0.5 + 1.2 * 2.0**3 / 3, float(H[1].real), 1e-5, "N m"),
    ]


ROBOTS = ("paper-robot", "machine-hexapod", "tripod", "flight-simulator", "nano-hexapod")
AMPLITUDES = {"heave": 0.02, "roll": 0.1, "pitch": -0.08}


def _study(name: str) -> model.Study:
    return model.preset(name)  # type: ignore[return-value]


@case(
    "Stiffness at the tool of robots written as MJCF, with legs that stretch and bend: largest difference of an entry "
    "over the mean of its diagonal ones",
    source="MuJoCo, differences of its equilibria, loops held by its soft constraints",
    argument="loops are two steps fast and 1e-4 of a force is lost in them: parts in 1e5 of a leg; springs stand at "
    "home, micrometres from the equilibrium",
    engine=MUJOCO,
)
def _export_mjcf_stiffness() -> Iterator[Check]:
    for name in ROBOTS:
        study = _study(name)
        ours = stiffness(study, load=np.zeros(6)).stiffness.values
        theirs = np.linalg.inv(MujocoStatics(str(mjcf(study).files[""])).compliance(np.diag(np.linalg.inv(ours))))
        scale = np.sqrt(np.diag(ours))
        gap = float(np.abs((theirs - ours) / np.outer(scale, scale)).max())
        yield Check(f"{name}", 0.0, gap, 1e-3, absolute=True)


@case(
    "Drive forces of rigid robots written as MJCF, in motion: largest difference over the largest force",
    source="MuJoCo, inverse dynamics of the trees in the file",
    argument="exact but for what turns between pistons and platform without mass, which is given a millionth of the "
    "payload's inertia",
    engine=MUJOCO,
)
def _export_mjcf_forces() -> Iterator[Check]:
    motion = model.CombinedMotion(amplitudes=AMPLITUDES, duration=0.4)  # type: ignore[arg-type]
    for name in ("paper-robot", "tripod", "flight-simulator"):
        study = _study(name)
        ours = inverse_dynamics(study.robot, motion, output_step=0.02)
        path = kinematics.poses(study.robot, motion, ours.time.values)
        text = str(mjcf(study, fidelity="rigid").files[""])
        theirs = mujoco_forces.inverse_dynamics(study.robot, path, text=text).actuator_force
        largest = float(np.abs(theirs).max())
        gap = float(np.abs(ours.drive_force_rigid.values - theirs).max()) / largest
        yield Check(f"{name}", 0.0, gap, 1e-6, absolute=True)
