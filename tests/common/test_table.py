"""A table of its own, of no study file: read, refused, kept, changed and written by its class alone."""

import copy
import pickle
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest

from flexapod.common.errors import InputError, Malformed
from flexapod.common.tables.base import Key, Quantity, Series, Vec3
from flexapod.common.tables.columns import columns_of
from flexapod.common.tables.field_help import Notes
from flexapod.common.tables.section import Section
from flexapod.common.tables.table import Table, to_plain_data
from flexapod.common.tables.toml import parse_toml, toml_text

pytestmark = pytest.mark.unit


class Pad(Table):
    """A rubber pad."""

    area: Annotated[float, Quantity("number", above=0, most=10, why="in square metres")]
    loss: Annotated[float | None, Quantity("number", least=0, why="of the rubber", usual="that of the frame")] = None


class Foot(Table):
    """A foot with pads; its height by a number, or by a word."""

    also = ("word",)
    spells = {"word": ("height",)}  # noqa: RUF012

    height: Annotated[float, Quantity("length", above=0, why="of the foot")]
    kind: Annotated[Literal["round", "square"], Key("outline")] = "round"
    at: Annotated[Vec3, Quantity("length")] = np.zeros(3)
    holes: Annotated[Series | None, Quantity("length", why="diameters")] = None
    pad: Annotated[Pad | None, Key("table: what it stands on")] = None
    count: int = 1

    @classmethod
    def fields_from_section(cls, section):
        """The height."""
        words = {"low": 0.01, "high": 0.1}
        return {"height": words[section.text("word", tuple(words))]} if "word" in section else {}


TEXT = """
[foot]
pad = { loss = 0.10, area = "0.5" }
kind = "square"
holes = ["8 mm", 9e-3]
height = "27.50 mm"
count = 3
"""


def read(text=TEXT, notes=None):
    return Section(parse_toml(text, "feet.toml")["foot"], "foot", "feet.toml", Path(), notes).read(Foot)


def test_it_is_read_by_its_fields():
    foot = read()
    assert (foot.height, foot.kind, foot.count, foot.pad.area) == (0.0275, "square", 3, 0.5)
    assert foot.holes.tolist() == [0.008, 0.009] and foot.at.tolist() == [0, 0, 0]
    assert type(foot.height) is float and type(foot.pad.loss) is float


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "kind",
            "kin",
            "foot.kin: unknown key. Allowed: height, kind, at, holes, pad, count, word. Did you mean",
        ),
        ('"square"', '"oval"', "foot.kind = 'oval': is not known. Allowed: round, square."),
        ('"27.50 mm"', '"27.50 kg"', "foot.height = '27.50 kg': is not a length: kg does not measure one."),
        ('"27.50 mm"', "-1", "foot.height = -1: is out of range. Allowed: above 0."),
        ('"27.50 mm"', '"1e-20 m"', "foot.height = '1e-20 m': is out of range. Allowed: 1e-09 to 1e+06 m."),
        ('height = "27.50 mm"', "", "foot.height: is missing. Add foot.height."),
        ('"0.5"', "11", "foot.pad.area = 11: is out of range. Allowed: at most 10."),
        ("0.10", "true", "foot.pad.loss = True: is not a number."),
        ("count = 3", "count = 3.0", "foot.count = 3.0: is not a whole number."),
    ],
)
def test_it_refuses_with_file_key_value_and_what_is_allowed(old, new, message):
    with pytest.raises(InputError) as caught:
        read(TEXT.replace(old, new))
    assert str(caught.value).startswith(f"feet.toml: {message}")


def test_a_key_that_nobody_knows_is_told_before_a_value_and_a_value_before_a_limit():
    with pytest.raises(Malformed, match="unknown key"):
        read(TEXT.replace("kind", "kin").replace('"27.50 mm"', '"no"'))
    with pytest.raises(Malformed, match="count"):
        read(TEXT.replace('"27.50 mm"', "-1").replace("count = 3", "count = 3.5"))


def test_it_is_written_as_it_was_letter_for_letter():
    assert toml_text({"foot": to_plain_data(read())}) == TEXT


def test_a_changed_field_is_written_anew_in_its_place_and_the_others_stay():
    foot = read()
    assert toml_text({"foot": to_plain_data(foot.replace(kind="round"))}) == TEXT.replace("square", "round")
    inner = foot.replace(pad=foot.pad.replace(area=2.0))
    assert toml_text({"foot": to_plain_data(inner)}) == TEXT.replace('"0.5"', "2.0")
    assert toml_text({"foot": to_plain_data(foot.replace(height=0.0275))}) == TEXT
    assert to_plain_data(inner.replace(pad=foot.pad)) == to_plain_data(foot)


def test_a_word_stands_for_a_field_until_that_is_another():
    foot = read('[foot]\nword = "low"\n')
    assert foot.height == 0.01 and to_plain_data(foot) == {"word": "low"}
    assert to_plain_data(foot.replace(height=0.02)) == {"height": 0.02}


def test_what_python_makes_is_written_in_si_without_what_is_none():
    made = Foot(height=0.0275, pad=Pad(area=0.5))
    assert to_plain_data(made) == {
        "height": 0.0275, "kind": "round", "at": [0.0, 0.0, 0.0], "pad": {"area": 0.5}, "count": 1,
    }  # fmt: skip
    assert made == read('[foot]\nheight = "27.5 mm"\npad = { area = 0.5 }\n')


def test_what_was_written_changes_neither_equality_nor_what_is_shown():
    foot, made = read(), Foot(height=0.0275, kind="square", holes=[0.008, 0.009], count=3, pad=Pad(area=0.5, loss=0.1))
    assert foot == made and hash(foot) == hash(made) and repr(foot) == repr(made)
    assert foot.model_dump_json() == made.model_dump_json()
    assert not {"written", "source_table"} & {*dir(foot)} and "height" in dir(foot)
    for again in (pickle.loads(pickle.dumps(foot)), copy.deepcopy(foot)):
        assert again == foot and to_plain_data(again) == to_plain_data(foot)
    assert copy.copy(foot).source_table is None  # pydantic's copies change fields behind its back


def test_numbers_from_python_are_refused_as_those_of_a_file():
    with pytest.raises(InputError, match=r"^height = -1.*above 0"):
        Foot(height=-1.0)
    with pytest.raises(InputError, match="height"):
        Foot(height="27 ms")  # a unit is read, and has to be one of the quantity
    assert Foot(height="27 mm").height == 0.027
    with pytest.raises(InputError, match=r"^pad\.area|^area"):
        Foot(height=1.0, pad={"area": 20.0})


def test_its_columns_say_all_that_a_reference_needs():
    columns = columns_of(Foot) | columns_of(Pad)
    assert columns["height"].dimensions == ("length",) and columns["height"].bounds.words == "above 0"
    assert columns["kind"].choices == ("round", "square") and columns["kind"].why == "outline"
    assert columns["loss"].usual == "that of the frame" and columns["area"].bounds.words == "above 0, at most 10"
    assert columns["pad"].models == (Pad,) and columns["holes"].size == 0 and columns["at"].size == 3


def test_who_listens_hears_every_key_with_its_dimension():
    notes = Notes()
    read(notes=notes)
    asked = {key: (field.kind, field.dimensions) for key, field in notes.fields.items()}
    assert asked["foot.height"] == ("number", ("length",)) and asked["foot.pad.area"] == ("number", ("number",))
    assert asked["foot.holes"] == ("vector", ("length",) * 2) and asked["foot.count"][0] == "whole"
    assert notes.columns["foot.pad"]["area"].why == "in square metres"
