"""A published Stewart platform: its plant from drive forces to sensors, modes and compliance.

stewart-simscape by T. Dehaeze (MIT), commit 32330b9: numbers of its Simscape model, four digits as printed there.
"""

import numpy as np
import pytest

import flexapod as fx
from flexapod import model

K, C = 2e7, 20.0
HZ = np.array([10.0, 100.0, 500.84, 1e4])


def circle(radius, angles, z):
    angles = np.deg2rad(angles)
    return np.stack([radius * np.cos(angles), radius * np.sin(angles), np.full(6, z)], axis=1)


def stewart() -> model.Study:
    """Struts of two rods of 0.1 kg, 50 mm, radius 5 mm; the lower begins at the base, the upper ends at the platform."""
    base = circle(0.115, [-10, 10, 110, 130, 230, 250], 0.015)
    platform = circle(0.09, [-50, 50, 70, 170, 190, -70], 0.075)
    m, L, r = 0.1, 0.05, 0.005
    across = m * (3 * r**2 + L**2) / 12
    # a piston is a line: its inertia by its thickness, m r^2 / 4 across, turns with the cylinder
    cylinder = model.Cylinder(mass=m, com=L / 2, inertia=across + m * r**2 / 4, axial_inertia=m * r**2 / 2, mouth=0.05)
    piston = model.Piston(length=L, rhoA=m / L, EA=1e9, EI=1e3, axial_inertia=m * r**2 / 2)
    leg = model.Leg(cylinder=cylinder, piston=piston, drive=model.ServoDrive(stiffness=K, damping=C))
    R, h, M = 0.1, 0.01, 1.0
    inertia = np.diag([M * (3 * R**2 + h**2) / 12] * 2 + [M * R**2 / 2])
    payload = model.Payload(mass=M, inertia=inertia, com=[0, 0, 0.085], tool=[0, 0, 0.135])
    robot = model.Robot(
        base_joints=base, platform_joints=platform, legs=(leg,) * 6, payload=payload, gravity=np.zeros(3),
        home=model.Home(position=np.zeros(3)),
    )  # fmt: skip
    still = model.AxisMotion(type="heave", amplitude=0.0, duration=1.0)
    return model.Study(robot=robot, motion=still, simulation=model.Simulation(fidelity="rigid"))


@pytest.fixture(scope="module")
def plant():
    return fx.linearize(stewart(), inputs=["drive", "wrench"], outputs=["drive-force", "stroke", "tool"])


def test_forces_of_the_struts_by_those_of_the_drives(plant):
    # Fm = F - (k + c s) dL. Four digits are printed; their struts may turn about themselves: a unit of the last digit
    # is up to 9e-4, and 5e-4 of the smaller forces is left
    s = 2j * np.pi * HZ
    own = plant.select("drive:1", "drive-force:1").at(HZ)[0, 0]
    assert own == pytest.approx(1 - (K + C * s) * plant.select("drive:1", "stroke:1").at(HZ)[0, 0], rel=1e-9)
    assert np.abs(own) == pytest.approx([1.150e-4, 1.165e-2, 0.433, 1.0097], rel=1e-3)
    others = np.abs(plant.select("drive:1", "drive-force").at([100.0])[1:, 0, 0])
    assert others == pytest.approx([2.578e-3, 1.168e-3, 2.027e-3, 1.168e-3, 1.531e-3], rel=1e-3)
    assert abs(plant.select("drive:1", "stroke:1").at([10.0])[0, 0, 0]) == pytest.approx(5.00e-8, rel=1e-3)


def test_modes_and_damping(plant):
    found = plant.damp()
    published = np.array([780.60, 780.60, 903.89, 1061.43, 1061.43, 1269.66])
    assert found.frequency.values == pytest.approx(published, rel=2e-5)
    # a damper beside each spring: every mode has the ratio c w / 2 k, whatever its shape
    assert found.damping_ratio.values == pytest.approx(C * 2 * np.pi * found.frequency.values / (2 * K), rel=1e-9)


def test_static_compliance():
    data = fx.compliance(stewart(), [0.0])
    assert float(data.compliance_norm[0]) == pytest.approx(7.558e-6, rel=1e-4)


def test_a_floor_that_does_not_accelerate_is_followed():
    # no gravity: 1 at 0 Hz by definition; at 1e-2 Hz it is 1 + (f / f0)^2, 2e-10
    data = fx.transmissibility(stewart(), [0.0, 1e-2])
    T = data.transmissibility.sel(part="real").values
    assert T[..., 0] == pytest.approx(np.eye(6), abs=1e-15)
    assert T[..., 1] == pytest.approx(np.eye(6), abs=1e-9)


def test_a_floor_that_turns_by_moving_each_joint():
    # the platform alone on struts without mass: k of each strut between a base joint and a platform joint that are
    # displaced rigidly. T = (-w^2 m + J^T z J)^-1 J^T z J_base, with J and J_base the rates of the struts by turns and
    # displacements of platform and base about the tool
    study = stewart()
    light = tuple(
        leg.replace(
            cylinder=leg.cylinder.replace(mass=1e-9, inertia=1e-12, axial_inertia=0.0),
            piston=leg.piston.replace(rhoA=1e-9, axial_inertia=0.0),
        )
        for leg in study.robot.legs
    )
    study = study.replace(robot=study.robot.replace(legs=light))
    robot, hz = study.robot, np.array([300.0, 900.0, 2000.0])
    tips, feet, tool = robot.platform_joints, robot.base_joints, robot.tool
    e = (tips - feet) / np.linalg.norm(tips - feet, axis=1)[:, None]
    J = np.concatenate([e, np.cross(tips - tool, e)], axis=1)
    arm = robot.com - tool
    carry = np.eye(6)
    carry[:3, 3:] = np.cross(np.eye(3), arm).T
    mass = np.zeros((6, 6))
    mass[:3, :3], mass[3:, 3:] = robot.payload.mass * np.eye(3), robot.payload.inertia
    M = carry.T @ mass @ carry
    J_base = np.concatenate([e, np.cross(feet - tool, e)], axis=1)
    assert J == pytest.approx(J_base, rel=1e-12, abs=1e-12)  # a rigid motion of both ends stretches nothing
    T = fx.transmissibility(study, hz).transmissibility
    found = (T.sel(part="real") + 1j * T.sel(part="imaginary")).values
    for k, w in enumerate(2 * np.pi * hz):
        z = (K + 1j * w * C) * J.T @ J
        expected = np.linalg.solve(-(w**2) * M + z, z)
        # legs of a microgram: 1e-8 of the platform's mass; at 900 Hz a resonance 4e-3 away multiplies it
        assert found[..., k] == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
