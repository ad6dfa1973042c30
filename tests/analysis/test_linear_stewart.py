"""A published Stewart platform: its plant from drive forces to sensors, modes and compliance.

stewart-simscape by T. Dehaeze (MIT), commit 32330b9: numbers of its Simscape model, four digits as printed there.
"""

import numpy as np
import pytest

import flexapod as fx
from flexapod.verification.cases.linear import DAMPER as C
from flexapod.verification.cases.linear import SPRING as K
from flexapod.verification.cases.linear import stewart

pytestmark = pytest.mark.analytic

HZ = np.array([10.0, 100.0, 500.84, 1e4])


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
    study = stewart(light=True)
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
