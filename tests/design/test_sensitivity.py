"""Sensitivities against Richardson's limit of differences of public calls, in a loop of its own."""

from itertools import pairwise

import numpy as np
import pytest

import flexapod as fx
from flexapod.design.sensitivity import check_outputs, sensitivity
from flexapod.solve.modal.structural_damping import hold_loss_frequency

pytestmark = pytest.mark.consistency

CASES = {
    "paper-robot": ["payload.mass", "leg.piston.diameter", "leg.piston.length", "leg.stroke.max", "leg.cylinder.mass"],
    "machine-hexapod": [
        "payload.mass", "leg.piston.diameter", "leg.drive.nut.rigidity", "tolerances.base_joints", "heat.screw",
    ],
    "tripod": ["payload.mass", "leg[1].piston.diameter", "leg[2].piston.diameter", "payload.com[3]"],
    "flight-simulator": ["payload.mass", "leg.piston.length", "leg.cylinder.mass", "leg.cylinder.com"],
    "small-hexapod": ["payload.mass", "leg.drive.lead", "heat.piston", "tolerances.base_joints"],
}  # fmt: skip


def scaled(study, key, factor):
    """The study with a multiple of its own value; temperatures count from 20 degrees."""
    value = number_at(study, key)
    origin = 20.0 if key.startswith("heat.") else 0.0
    return study.with_values({key: origin + factor * (value - origin)})


def number_at(study, key):
    """The number of a key as the model holds it."""
    robot = study.robot
    names = key.replace("[", ".").replace("]", "").split(".")
    found = {"payload": robot.payload, "leg": robot.legs, "heat": robot.heat, "tolerances": robot.tolerances}[names[0]]
    if names[0] == "leg":
        first = names[1].isdigit()
        found, names = found[int(names[1]) - 1 if first else 0], names[first:]
    for name in names[1:]:
        found = found[int(name) - 1] if name.isdigit() else getattr(found, name)
    return float(np.ravel(getattr(found, "sigma", found))[0])


def outputs(study):
    """First frequency, least stiffness, sag and accuracy by the public calls."""
    found = fx.stiffness(study).stiffness.values
    give = np.linalg.inv(found)[:3, :3]
    budget = fx.budget(study)
    accuracy = np.linalg.norm(budget.pose_accuracy.sel(component=["x", "y", "z"]).values, axis=1)
    return np.array([fx.modes(study).frequency.values[0], 1 / np.linalg.eigvalsh(give)[-1], *accuracy])


def richardson(study, key):
    """Derivative by three steps, twice extrapolated, per cent per cent."""
    slopes = []
    for step in (4e-3, 2e-3, 1e-3):
        up, down = (outputs(scaled(study, key, 1 + sign * step)) for sign in (1, -1))
        slopes.append((up - down) / (2 * step))
    once = [fine + (fine - coarse) / 3 for coarse, fine in pairwise(slopes)]
    twice = once[1] + (once[1] - once[0]) / 15
    size = np.abs(outputs(study))
    return twice / size, np.abs(twice - once[1]) / size


NAMES = ["first_frequency", "stiffness_least", "pose_accuracy", "pose_accuracy_calibrated"]


@pytest.mark.parametrize("name", CASES)
def test_richardson(name):
    study = fx.preset(name)
    keys = [key for key in CASES[name] if _there(study, key)]
    assert len(keys) >= 3
    data = sensitivity(study, keys, NAMES)
    compared = 0
    with hold_loss_frequency(study.robot, study.simulation):
        for key in keys:
            limit, doubt = richardson(study, key)
            one = data.sel(key=key)
            for j, output in enumerate(NAMES):
                found, sure = float(one.sensitivity[j]), float(one.uncertainty[j])
                if np.isfinite(found):
                    compared += 1
                    assert abs(found - limit[j]) < 3 * sure + 3 * doubt[j], (key, output, found, limit[j], sure)
                    assert j > 1 or sure < 1e-6  # equilibria have more rounding, of sags that are next to nothing
    assert compared >= 2 * len(keys)


def _there(study, key):
    try:
        return bool(number_at(study, key))
    except AttributeError:
        return False


def test_heated_pistons_cancel_the_sag():
    """Halves are whole calls, and an error of which half is worse is said."""
    study = fx.preset("machine-hexapod")
    data = fx.sensitivity(study, ["heat.base", "leg.drive.nut.rigidity"], "pose_accuracy_calibrated")
    half = fx.budget(study.with_values({"heat.base": 20.5})).pose_accuracy.sel(state="calibrated").values[:3]
    whole = fx.budget(study).pose_accuracy.sel(state="calibrated").values[:3]
    expected = 100 * (np.linalg.norm(half) / np.linalg.norm(whole) - 1)
    assert float(data.factor_effect[0, 0]) == pytest.approx(expected, rel=1e-6)
    assert expected > 0
    assert data.factor.values.tolist() == [0.5, 2.0]


def test_equal_frequencies_part_by_one_leg():
    data = fx.sensitivity(fx.preset("machine-hexapod"), "leg[2].piston.diameter", ["first_frequency", "leg_mass"])
    assert "equal frequencies part" in data.note.values[0, 0]
    assert np.isnan(data.sensitivity.values[0, 0])
    assert data.sensitivity.values[0, 1] > 0


def test_masses_in_closed_form():
    """Mass of tubes: 2 D^2 / (D^2 - d^2) per cent for a per cent of the outer diameter."""
    study = fx.preset("machine-hexapod")
    data = fx.sensitivity(study, ["leg.piston.diameter", "leg.piston.length"], "piston_mass")
    assert data.sensitivity.values[:, 0] == pytest.approx([2 * 60**2 / (60**2 - 40**2), 1.0], rel=1e-9)


def test_a_length_out_of_reach_is_a_gap():
    study = fx.preset("machine-hexapod")
    lengths = study.robot.home_lengths
    tight = study.with_values({"leg.stroke.max": float(lengths.max()) * 1.0005})
    data = fx.sensitivity(tight, "leg.stroke.max", "first_frequency")
    assert data.note.values[0, 0].startswith("a gap: ")
    assert np.isnan(data.sensitivity.values[0, 0])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"outputs": "tool_deviation_peak"}, "Take tool_deviation_rms"),
        ({"outputs": "steps"}, "a count"),
        ({"outputs": "first_frequenc"}, "first_frequency"),
        ({"keys": "simulation.modes"}, "is a count or a choice"),
        ({"keys": "leg.drive.type"}, "is a count or a choice"),
        ({"keys": "leg.piston.diametr"}, "Did you mean"),
    ],
)
def test_refused(arguments, words):
    with pytest.raises(fx.InputError, match=words):
        fx.sensitivity(fx.preset("machine-hexapod"), **arguments)


def test_usual_outputs_have_derivatives():
    assert len(check_outputs(None)) == 5
