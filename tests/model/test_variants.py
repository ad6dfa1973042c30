"""Values of a study by the keys of its file: text, comments, refusals, and what follows from them."""

import re
import tomllib

import numpy as np
import pytest

import flexapod as fx
from flexapod.analysis.store import save
from flexapod.common.tables.key_paths import key_text
from flexapod.model import PRESETS
from flexapod.model.file.key_paths import put
from flexapod.model.file.variants import text_with_values

pytestmark = pytest.mark.unit

STUDY = fx.preset("machine-hexapod")


def all_keys(data, steps=()):
    """Steps and value of every key of a study file; of lists of tables those of each."""
    for name, value in data.items():
        if isinstance(value, dict):
            yield from all_keys(value, (*steps, name))
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for number, table in enumerate(value, start=1):
                yield from all_keys(table, (*steps, name, number))
        else:
            yield (*steps, name), value


@pytest.mark.parametrize("name", PRESETS)
def test_the_text_says_what_the_tables_say_and_keeps_every_comment(name):
    text = fx.preset(name).source_text
    keys = list(all_keys(tomllib.loads(text)))
    if isinstance(tomllib.loads(text).get("leg"), dict):
        keys += [(("leg", 3, *steps[1:]), value) for steps, value in keys if steps[0] == "leg"]
    for steps, value in keys:
        new = 1.05 * value if isinstance(value, float) else value
        data = tomllib.loads(text)
        put(data, steps, new)
        found = text_with_values(text, {steps: new}, data)
        assert tomllib.loads(found) == data, key_text(steps)
        assert found.count("#") == text.count("#"), key_text(steps)


def test_only_the_line_of_the_key_changes():
    before, after = STUDY.source_text, STUDY.with_values({"payload.mass": "123 kg"}).source_text
    assert len([1 for a, b in zip(before.splitlines(), after.splitlines(), strict=True) if a != b]) == 1


def test_whole_tables_and_arrays_are_values():
    wrench = np.array([0.0, 0.0, -10.0, 0.0, 0.0, 0.0])
    motion = {"type": "heave", "amplitude": "5 mm", "duration": "1 s"}
    found = STUDY.with_values({"motion": motion, "load": {"wrench": wrench}})
    assert found.motion.amplitude == 5e-3
    assert np.array_equal(found.load.wrench.value, wrench)
    assert fx.loads(found.source_text).motion == found.motion


def test_one_leg_alone():
    found = STUDY.with_values({"leg[3].piston.diameter": "70 mm"}).robot.legs
    assert [leg.piston.diameter == 0.07 for leg in found] == [False, False, True, False, False, False]


def test_a_modulus_in_place_of_a_material_leaves_what_else_it_says():
    piston = STUDY.robot.legs[0].piston
    found = STUDY.with_values({"leg.piston.E": "190 GPa"}).robot.legs[0].piston
    assert found.E == 190e9
    assert found.expansion == piston.expansion is not None
    assert found.yield_stress == piston.yield_stress


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"leg.pistn.diameter": "70 mm"}, "Did you mean 'leg.piston.diameter'?"),
        ({"piston.diameter": "70 mm"}, "Did you mean 'leg.piston.diameter'?"),
        ({"payload.mass": "5 mm"}, "mm does not measure one"),
        ({"leg[9].piston.diameter": "70 mm"}, "has no such item"),
        ({"payload": {"mass": 1.0}, "payload.mass": 2.0}, "give the same value"),
        ({"leg.piston.diameter": "70 mm", "leg[2].piston.diameter": "7 mm"}, "give the same value"),
        ({"payload.mass": None}, "Leave the key out"),
        ({4: 5}, "is not a key path"),
        ("payload.mass=5", "values by key"),
    ],
)
def test_what_is_refused(values, words):
    with pytest.raises(fx.InputError, match=re.escape(words)) as error:
        STUDY.with_values(values)
    assert error.value.file is None


def test_results_carry_a_study_that_has_variants(tmp_path):
    study = fx.preset("paper-robot").with_values({"simulation.duration": "5 ms"})
    path = save(fx.simulate(study), tmp_path / "results.nc")
    assert fx.load(path).with_values({"payload.mass": 7.0}).robot.payload.mass == 7.0
