"""The page of the study file says all of it: keys, units, defaults, bounds, choices; and every example loads."""

import tomllib
from pathlib import Path

import pytest
from tests.helpers.tables import classes

from flexapod.common.tables.key_rows import list_entries
from flexapod.common.tables.reference import example_line, plain_path, reference
from flexapod.common.tables.toml import toml_value
from flexapod.mechanics.elements.element import registered
from flexapod.model import AXES, FIDELITIES, PROFILES, loads, preset_text
from flexapod.model.file.fields import read_notes
from flexapod.model.file.key_trials import study_data, tried_entries, words_of
from flexapod.model.file.page import study_file_page

pytestmark = pytest.mark.unit

PAGE = Path(__file__).parents[2] / "docs" / "study-file.md"
ENTRIES = reference().entries
KEYS = "src/flexapod/common/tables/keys.toml"
# Classes and fields that no study file fills by itself: whole studies, and what follows from the other keys.
DERIVED = {
    "Study", "ActuatorStudy", "Robot", "Load", "ActuatorMotion", "ActuatorLoad",
    ("Material", "name"), ("Actuator", "material"), ("Simulation", "step"),
    *((part, name) for part in ("Piston", "Strut") for name in ("E", "density")),
    ("Cylinder", "diameter"), ("Cylinder", "inner_diameter"),
    *((law, "law") for law in ("RateLaw", "SpinUpLaw", "CsvLaw", "ConstantLaw", "SineLaw", "StepLaw")),
    *((law, "law") for law in ("ConstantWrench", "SineWrench", "StepWrench", "CsvWrench")),
    *((kind, "type") for kind in ("CombinedMotion", "WaypointMotion", "CsvMotion", "PrescribedDrive", "ServoDrive",
                                  "ForceDrive")),
    ("CsvMotion", "profile"),
    *((motion, "independent") for motion in ("AxisMotion", "WaypointMotion", "CsvMotion")),
    ("Strut", "keyed"),
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tables")
    for file, text in reference().files.items():
        (folder / file).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def heard(folder):
    """What the readers asked of every example."""
    return [(entry, *read_notes(study_data(entry), folder)) for entry in ENTRIES]


def test_stored_rows_are_those_of_the_trials():
    assert list_entries() == tried_entries(), "write them: python -m flexapod.model.file.key_trials"


def test_the_page_is_what_the_readers_and_the_model_say():
    assert PAGE.read_text(encoding="utf-8") == study_file_page(), (
        "write it: flexapod keys --markdown docs/study-file.md"
    )


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: f"{entry.study} {entry.table} {entry.title}")
def test_every_example_loads(entry, folder):
    tables = study_data(entry)
    text = "".join(f"{name} = {toml_value(table)}\n" for name, table in tables.items())
    study = loads(text, path=folder / "study.toml")
    assert hasattr(study, entry.study)
    assert entry.example.strip() in PAGE.read_text(encoding="utf-8")


def test_every_key_that_is_read_has_words(heard):
    allowed = {
        (plain_path(table), key) for _, notes, _ in heard for table, keys in notes.allowed.items() for key in keys
    } - {("leg", name) for name in registered}  # of users
    tables = {entry.table for entry in ENTRIES}
    said = {(table, key) for _, notes, _ in heard for table in tables for key in words_of(notes, table)}
    missing = {f"{table}.{key}" for table, key in allowed - said if table}
    assert not missing, f"add words to these fields, and an [[entry]] with an example to {KEYS}: {sorted(missing)}"
    assert {table for table, _ in allowed if table} <= tables, f"add an [[entry]] to {KEYS} for these tables"


def test_no_words_for_what_is_not_read(heard):
    asked = {plain_path(key) for _, notes, _ in heard for key in notes.fields}
    asked |= {
        f"{plain_path(table)}.{key}" for _, notes, _ in heard for table, keys in notes.allowed.items() for key in keys
    }
    words = {f"{table}.{key}" for table, keys in reference().words.items() for key in keys}
    assert words <= asked, f"nothing reads these, take them out of {KEYS}: {sorted(words - asked)}"
    assert {plain_path(key) for key in reference().defaults} <= asked


def allowed_in(notes, table):
    return {key for path, keys in notes.allowed.items() if plain_path(path) == table for key in keys}


def test_every_key_has_an_example_and_a_row(heard):
    rows = {f"{item.entry.table}.{row.key}" for item in list_entries() for row in item.rows}
    for table in {entry.table for entry in ENTRIES}:
        keys = {key for entry, notes, _ in heard if entry.table == table for key in words_of(notes, table)}
        for key in keys & {key for _, notes, _ in heard for key in allowed_in(notes, table)}:
            assert example_line(table, key), f"{table}.{key}: add it to an example of {table} in {KEYS}"
            assert f"{table}.{key}" in rows


def test_every_kind_has_an_example(heard):
    for name in ("type", "law", "fidelity", "basis", "profile", "material", "start"):
        choices = {c for _, notes, _ in heard for f in notes.fields.values() if f.name == name for c in f.choices or ()}
        shown = {c for c in choices if any(f'{name} = "{c}"' in entry.example for entry in ENTRIES)}
        explained = set(reference().choices.get(name, {})) | (set(PROFILES) if name == "law" else set())
        known = {"material": choices, "start": choices, "type": {*AXES, "6-UPS"}}.get(name, set())
        assert choices <= shown | explained | known, f"{name}: add an example to {KEYS}: {choices - shown - explained}"


def test_choices_are_explained_as_they_are():
    choices = reference().choices
    assert set(choices["profile"]) == set(PROFILES)
    assert set(choices["fidelity"]) == set(FIDELITIES)
    assert set(choices["basis"]) == {"tip-load", "clamped-free", "tip-mass"}


def test_the_examples_fill_every_field_of_the_model(heard):
    given = {pair for _, notes, _ in heard for pair in notes.given}
    fields = {(cls.__name__, name) for cls in classes() for name in cls.model_fields}
    missing = sorted(
        f"{cls}.{name}" for cls, name in fields - given if not {cls, (cls, name)} & DERIVED and not cls.startswith("_")
    )
    assert not missing, f"no example of {KEYS} sets these fields of the model: add an [[entry]] with words: {missing}"


@pytest.mark.parametrize("key", ["robot.type", "robot.gravity"])
def test_a_default_in_words_is_what_the_reader_takes(key):
    text = preset_text("paper-robot")
    table, name = key.split(".")
    line = next(line for line in text.splitlines() if line.startswith(f"{name} = "))
    value = tomllib.loads(line)[name]
    assert toml_value(value).strip('"') == reference().defaults[key]
    assert loads(text.replace(line, "")).robot == loads(text).robot
    assert table == "robot"
