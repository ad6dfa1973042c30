"""The table [requirement]: what it reads, keeps in its text, and refuses before anything is computed."""

import numpy as np
import pytest

import flexapod as fx

pytestmark = pytest.mark.unit
TEXT = fx.model.preset_text("machine-hexapod")


def read(table: str) -> fx.model.Requirement:
    return fx.loads(f"{TEXT}\n[requirement]\n{table}\n").requirement


def test_ranges_of_one_number_of_two_and_by_axis():
    found = read('travel = "15 mm"\nrotation = { each = ["-1 deg", "2 deg"], yaw = "3 deg" }')
    assert found.ends("surge").tolist() == [-0.015, 0.015]
    assert np.rad2deg(found.ends("pitch")) == pytest.approx([-1, 2])
    assert np.rad2deg(found.ends("yaw")) == pytest.approx([-3, 3])
    only = read('travel = { heave = ["-1 mm", 0.002] }')
    assert only.ends("heave").tolist() == [-0.001, 0.002]
    assert only.ends("surge") is None
    assert only.ends("roll") is None


@pytest.mark.parametrize(
    "table",
    [
        'travel = "15 mm"\nrotation = ["-3 deg", "2 deg"]\npayload = "25 kg"\npivot = [0, 0, "10 mm"]',
        'travel = { each = "1 mm", heave = ["-1 mm", "2 mm"] }\nalone = true\nstiffness = "50 N/um"',
        'stiffness = { heave = "50 N/um", yaw = "1 kN m/rad" }\npayload = ["5 kg", "25 kg"]\nlife = "20000 h"',
        'settling_time = "0.5 s"\nsettling_band = "2 um"\npayload_com = [0, 0, "1 mm"]\nsingularity = 0.1',
    ],
)
def test_a_changed_table_is_written_and_read_again(table):
    study = fx.loads(f"{TEXT}\n[requirement]\n{table}\n")
    changed = study.replace(requirement=study.requirement.replace(pose_accuracy=2e-6))
    assert fx.loads(changed.source_text).requirement == changed.requirement
    assert changed.with_values({"requirement.pose_accuracy": "3 um"}).requirement.pose_accuracy == 3e-6


def test_python_takes_texts_and_numbers():
    found = fx.model.Requirement(travel="15 mm", payload=["5 kg", 25], pose_accuracy_calibrated="1 um")
    assert found.names == ("travel", "pose_accuracy_calibrated")
    assert found.payload.tolist() == [5, 25]
    study = fx.loads(TEXT).replace(requirement=found)
    assert fx.loads(study.source_text).requirement == found


@pytest.mark.parametrize(
    ("table", "key", "words"),
    [
        ('travel = ["5 mm", "-5 mm"]', "requirement.travel", "begins where it should end"),
        ('travel = ["1 mm", "5 mm"]', "requirement.travel", "does not hold home"),
        ('travel = { heave = ["-5 mm", "-1 mm"] }', "requirement.travel.heave", "does not hold home"),
        ('travel = "-5 mm"', "requirement.travel", "below 0"),
        ('travel = "5 deg"', "requirement.travel", "not a length"),
        ('rotation = { pitch = "95 deg" }', "requirement.rotation.pitch", "too far"),
        ('travel = { roll = "1 deg" }', "requirement.travel.roll", "unknown key"),
        ('payload = "-5 kg"\nlife = "1 h"', "requirement.payload", "out of range"),
        ('payload = ["5 kg", "2 kg"]\nlife = "1 h"', "requirement.payload", "begins where it should end"),
        ('payload = "5 kg"', "requirement.pose_accuracy_calibrated", "requires nothing"),
        ('alone = true\nlife = "1 h"', "requirement.alone", "no effect"),
        ('pivot = "platform"\ntravel = "1 mm"', "requirement.pivot", "no effect"),
        ('settling_band = "2 um"\nlife = "1 h"', "requirement.settling_band", "no effect"),
        ('pose_accuracy = "1 kg"', "requirement.pose_accuracy", "not a length"),
        ("singularity = 2", "requirement.singularity", "out of range"),
        ("velocty = 1", "requirement.velocty", "unknown key"),
    ],
)
def test_refused_with_its_key(table, key, words):
    with pytest.raises(fx.InputError) as raised:
        read(table)
    assert raised.value.key == key
    assert words in raised.value.what
