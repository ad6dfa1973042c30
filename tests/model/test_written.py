"""What was written is kept: text -> study -> text is exact, key by key and letter by letter; a change changes a key."""

import json
import pickle
import random
import tomllib
from pathlib import Path

import pytest
from tests.helpers.tables import plain, respelled
from tools.damaged import WHOLE

from flexapod import model
from flexapod.common.errors import InputError
from flexapod.common.tables.base import Frozen
from flexapod.common.tables.reference import reference
from flexapod.model import PRESETS, loads, preset_text, to_toml
from flexapod.model.file.key_trials import study_data

pytestmark = pytest.mark.property

EXAMPLES = Path(__file__).parents[2] / "examples"
COUNT = 2000


def letters(text):
    """Tables of a text, numbers as they are written; in JSON, so that the order of keys counts."""
    return json.dumps(tomllib.loads(text, parse_float=lambda number: f"float {number}"))


@pytest.fixture(scope="module")
def texts(tmp_path_factory):
    """Whole studies at hand: text and path, by name."""
    folder = tmp_path_factory.mktemp("tables")
    for name, text in reference().files.items():
        (folder / name).write_text(text, encoding="utf-8")
    found = {name: (preset_text(name), None) for name in PRESETS}
    found |= {path.stem: (path.read_text(encoding="utf-8"), path) for path in sorted(EXAMPLES.glob("*.toml"))}
    for entry in reference().entries:
        found[f"{entry.study} {entry.table} {entry.title}"] = plain(study_data(entry)), folder / "study.toml"
    for name, parts in WHOLE.items():
        if "study.toml" in parts:
            (folder / name).mkdir()
            for file, text in parts.items():
                (folder / name / file).write_text(text, encoding="utf-8")
            found[f"damaged {name}"] = parts["study.toml"], folder / name / "study.toml"
    return found


def spelled(r):
    return lambda value: r.choice((f"{value!r}", f"{value:.17e}", f"{value:.20f}", f"+{value!r}".replace("+-", "-")))


def content(study):
    return study.replace(source_text="x", path=None, notes=())


def same(study, text, path):
    again = to_toml(study)
    assert letters(again) == letters(text)
    read = loads(again, path=path)
    assert content(read) == content(study)
    assert to_toml(read) == again == to_toml(pickle.loads(pickle.dumps(study)))


def test_presets_examples_and_the_examples_of_the_reference(texts):
    for text, path in texts.values():
        same(loads(text, path=path), text, path)


def test_studies_in_other_words(texts):
    taken = 0
    for seed in range(COUNT * 4):
        r = random.Random(seed)
        text, path = texts[r.choice(list(texts))]
        text = plain(respelled(r, tomllib.loads(text)), spelled(r))
        try:
            study = loads(text, path=path)
        except InputError:
            continue
        same(study, text, path)
        taken += 1
        if taken == COUNT:
            return
    pytest.fail(f"only {taken} studies could be read")


def parts(owner, path=()):
    """Every object of the model in a study, by the way there."""
    yield path, owner
    for name in type(owner).model_fields:
        value = getattr(owner, name)
        for at, item in enumerate(value) if isinstance(value, tuple) else [(None, value)]:
            if isinstance(item, Frozen):
                yield from parts(item, (*path, (name, at)))


def own_numbers(way, part):
    """Numbers that a file can have by themselves.

    Of a beam that is not any more that of its section, sections and material a file has EA, EI and rhoA alone, and a
    material with another number has lost its name.
    """
    names = {name for name, _ in way}
    numbers = [name for name in type(part).model_fields if isinstance(getattr(part, name), float)]
    if {"material", "sections", "section"} & names:
        return []
    if {"piston", "strut"} & names:
        return [name for name in numbers if name == "bow"]
    return [name for name in numbers if "actuator" not in names or name not in ("EI", "rhoA")]


def put(owner, path, change):
    """The study with one object changed."""
    if not path:
        return change(owner)
    (name, at), *rest = path
    value = getattr(owner, name)
    inner = put(value if at is None else value[at], rest, change)
    return owner.replace(**{name: inner if at is None else (*value[:at], inner, *value[at + 1 :])})


def test_a_change_from_python_is_written_and_the_rest_stays(texts):
    tried = 0
    for seed in range(1500):
        r = random.Random(seed)
        text, path = texts[r.choice(list(texts))]
        study = loads(text, path=path)
        way, part = r.choice(list(parts(study)))
        if not (numbers := own_numbers(way, part)):
            continue
        name = r.choice(numbers)
        value = getattr(part, name) * r.choice((0.99, 1.01)) or 1e-6
        try:
            changed = put(study, way, lambda part, name=name, value=value: part.replace(**{name: value}))
        except InputError:
            continue
        try:
            again = loads(to_toml(changed), path=path)
        except InputError as error:
            raise AssertionError(f"{seed}: {way} {name}\n{to_toml(changed)}") from error
        assert content(again) == content(changed), f"{seed}: {way} {name}\n{to_toml(changed)}"
        assert again.source_text == to_toml(changed)
        tried += 1
    assert tried > 600


def test_a_changed_number_stands_in_its_place():
    study = model.preset("paper-robot")
    longer = [leg.replace(stroke=leg.stroke.replace(max=1.06)) for leg in study.robot.legs]
    changed = study.replace(robot=study.robot.replace(legs=tuple(longer)))
    assert to_toml(changed) == to_toml(study).replace('max = "1.05 m"', "max = 1.06")
    assert changed.source_text == to_toml(changed) and study.source_text == preset_text("paper-robot")


def test_what_a_text_says_of_a_place_is_not_carried_to_another():
    study = model.preset("motion-base")
    robot = study.robot
    assert 'axis = "' in to_toml(study) or "radius" in to_toml(study)
    turned = robot.replace(base_joints=robot.base_joints[::-1], platform_joints=robot.platform_joints[::-1])
    assert loads(to_toml(study.replace(robot=turned))).robot == turned


@pytest.mark.parametrize("name", ["a\nb.csv", 'a"b\\c.csv', "\x7f\u00e4.csv"])
def test_names_of_files_are_written_with_whatever_letters_they_have(name):
    motion = model.CsvMotion(file=name, time=[0.0, 1.0], pose=[[0] * 6, [0, 0, 0, 0.1, 0, 0]])
    text = to_toml(model.preset("paper-robot").replace(motion=motion))
    assert tomllib.loads(text)["motion"]["file"] == name


def test_a_spring_of_any_name_is_written_so_that_it_is_read():
    text = preset_text("paper-robot") + '\n[leg.springs]\n"Flansch\u00e4" = "50 N/um"\n'
    study = loads(text)
    changed = study.replace(robot=study.robot.replace(gravity=[0.0, 0.0, -1.6]))
    assert [spring.name for spring in loads(to_toml(changed)).robot.legs[0].springs] == ["Flansch\u00e4"]
