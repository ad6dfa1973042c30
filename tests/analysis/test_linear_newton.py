"""Newton's law of the payload between channels of a linear model, away from home, on a floor that shakes and tilts."""

import numpy as np
import pytest
from tests.helpers.samples import sample_study

import flexapod as fx

pytestmark = pytest.mark.analytic

HZ = np.array([0.3, 7.0, 60.0, 400.0])
PLACE, TURN, WRENCH = ("x", "y", "z"), ("rx", "ry", "rz"), ("fx", "fy", "fz", "mx", "my", "mz")


def cross(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


@pytest.mark.parametrize("drives", ["given", "force"])
@pytest.mark.parametrize("name", ["tripod", "delta", "tricept", "hexaglide"])
def test_forces_of_joints_and_accelerometers_obey_newton(name, drives):
    study = sample_study(name)
    outputs = ["tool", "com", "joint-force", "accelerometer:com", "geophone:com[4.5 Hz, 0.6, 28.8]"]
    lin = fx.linearize(study, {"heave": 0.004}, inputs=["floor", "wrench"], outputs=outputs, drives=drives)
    H, s, g, mass = lin.at(HZ), 2j * np.pi * HZ, study.robot.gravity, study.robot.payload.mass
    at = {output: i for i, output in enumerate(lin.outputs)}
    given = np.array([[float(i == j) for j in lin.inputs] for i in [*(f"floor:{a}" for a in (*PLACE, *TURN)),
                                                                   *(f"wrench:{a}" for a in WRENCH)]])  # fmt: skip
    floor, wrench = given[:6, :, None], given[6:, :, None]
    turned = floor[3:] / s**2  # what the floor has turned by; forces and places are seen from it
    carried = floor[:3] - np.einsum("ij,jmf->imf", cross(lin.position - lin.about), floor[3:])
    place = s**2 * np.array([H[at[f"com:{a}"]] for a in PLACE]) + carried
    joints = sum(np.array([H[at[f"joint-force:{i + 1}:{a}"]] for a in PLACE]) for i in range(len(study.robot.legs)))
    weight = -np.einsum("ij,jmf->imf", -cross(g), turned) * mass  # gravity turns in axes of the floor: -turn x g
    # rounding times the squared ratio of fast modes (1e4 Hz) to the frequency, of what is put in: accelerations of 1,
    # tilts that weigh g / w^2, forces over the mass, moments over some 0.1 m of it
    size = np.abs(floor).max(0) * (1 + 10 / np.abs(s) ** 2) + np.abs(wrench[:3]).max(0) / mass
    size = size + np.abs(wrench[3:]).max(0) / (0.1 * mass) + np.abs(place).max(0)
    assert (np.abs(mass * place - joints - wrench[:3] - weight).max(0) / (mass * size)).max() < 1e-5

    lean = np.array([H[at[f"tool:{a}"]] for a in TURN]) + turned
    felt = place - np.einsum("ij,jmf->imf", cross(g), lean)  # less gravity, in axes that turn: the x of it -g ry
    seen = np.array([H[at[f"accelerometer:com:{a}"]] for a in PLACE])
    assert (np.abs(seen - felt).max(0) / size).max() < 1e-5
    w = 2 * np.pi * 4.5
    heard = np.array([H[at[f"geophone:com:{a}"]] for a in PLACE])
    expected = 28.8 * felt * s / (s**2 + 2 * 0.6 * w * s + w**2)
    assert (np.abs(heard - expected).max(0) / (28.8 / w * size)).max() < 1e-5
