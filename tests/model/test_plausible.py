"""Numbers of a study file without a unit that are far beyond the robot's own size."""

import re

import pytest

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.model import PRESETS, preset_text, to_toml

pytestmark = pytest.mark.unit

MACHINE = preset_text("machine-hexapod")


def loaded(folder, *changes):
    text = MACHINE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return fx.load(path)


@pytest.mark.parametrize(
    ("old", "new", "key", "meant"),
    [
        (
            'stroke = { min = "0.79 m", max = "0.99 m" }',
            "stroke = { min = 790, max = 990 }",
            "leg.stroke.min",
            "790 mm",
        ),
        ('home_height = "0.8 m"', "home_height = 800", "robot.home_height", "800 mm"),
        ('radius = "600 mm"', "radius = 600", "robot.base.radius", "600 mm"),
        ('length = "600 mm"', "length = 600", "leg.piston.length", "600 mm"),
        ('diameter = "60 mm", inner', "diameter = 60, inner", "leg.piston.diameter", "60 mm"),
        ('lead = "10 mm"', "lead = 10", "leg.drive.lead", "10 mm"),
        ('home_height = "0.8 m"', "home_height = 800e3", "robot.home_height", "800000 um"),
    ],
)
def test_millimetres_without_a_unit_are_refused_under_their_own_key(tmp_path, old, new, key, meant):
    """Once 800 m of stroke were blamed on the motion, and 900 m of height on the stroke."""
    with pytest.raises(InputError) as error:
        loaded(tmp_path, (old, new))
    assert error.value.key == key
    assert "numbers are SI" in error.value.what and f'"{meant}"?' in error.value.what


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('max = "0.99 m"', "max = 990", 'leg.stroke.max is 990 m; numbers are SI: "990 mm"?'),
        ('duration = "0.6 s"', "duration = 600", 'motion.duration is 600 s; numbers are SI: "600 ms"?'),
        ('mass = "250 kg"', "mass = 250_000", '"250000 g"?'),
        ('tool = [0, 0, "250 mm"]', "tool = [0, 0, 250]", "payload.tool[3] is 250 m"),
    ],
)
def test_what_may_be_meant_is_remarked_on(tmp_path, old, new, words):
    """A stroke without an end, a motion of ten minutes, a payload of steel: files that were valid stay so."""
    assert any(words in line for line in loaded(tmp_path, (old, new)).warnings)


def test_a_text_with_its_unit_is_meant(tmp_path):
    found = loaded(tmp_path, ('max = "0.99 m"', 'max = "990 m"'), ('mass = "250 kg"', 'mass = "250 t"'))
    assert not any("SI" in line for line in found.warnings)


@pytest.mark.parametrize("factor", [1e-3, 1.0, 50.0, 1e3])
def test_a_giant_robot_is_a_giant_robot(tmp_path, factor):
    """All lengths alike, without units: its own size is what counts."""
    lengths = re.compile(r'"([\d.]+) (mm|m)"')
    text = "\n".join(
        lengths.sub(lambda m: repr(factor * float(m[1]) * {"mm": 1e-3, "m": 1.0}[m[2]]), line)
        if re.match(
            r"base  |platform  |home_height|cylinder|piston|stroke|tool|com|lead|root|length|bearing|pivot", line
        )
        else line
        for line in MACHINE.splitlines()
    )
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    try:
        found = fx.load(path).warnings
    except InputError as error:  # of other reasons: inertias and masses stay those of a metre
        assert "numbers are SI" not in error.what
    else:
        assert not any("m; numbers are SI" in line for line in found)


@pytest.mark.parametrize("name", PRESETS)
def test_presets_are_as_large_as_they_are_with_and_without_units(tmp_path, name):
    path = tmp_path / "study.toml"
    path.write_text(to_toml(fx.preset(name)), encoding="utf-8")
    assert fx.load(path).warnings == fx.preset(name).warnings


@pytest.mark.parametrize("value", ["[]", '"wide"', "true", "[[1, 2], 3]", "nan", "{ min = [] }", "9e999"])
def test_what_cannot_be_read_is_left_to_its_reader(tmp_path, value):
    with pytest.raises(InputError) as error:
        loaded(tmp_path, ('home_height = "0.8 m"', f"home_height = {value}"))
    assert "numbers are SI" not in error.value.what
