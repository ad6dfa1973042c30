"""TOML that is not a study, or is made to keep the reader busy: refused in words, and soon."""

import time
import tomllib

import pytest

from flexapod import model
from flexapod.common.errors import InputError
from flexapod.common.tables.toml import DEEPEST, parse_toml

pytestmark = pytest.mark.unit

TEXT = model.preset_text("paper-robot")
LONG = {
    "a dotted key": ("a" + ".b" * 30_000 + " = 1", "too many parts in line 1"),
    "a dotted key of 1 MB": ("a" + ".b" * 500_000 + " = 1", "too many parts in line 1"),
    "quoted parts": ('\n"a"' + " . 'b'" * 100 + " = 1", "too many parts in line 2"),
    "a heading": ("[" + ".".join("a" * 1000) + "]", "too many parts in line 1"),
    "a key in braces": ("a = {" + ".".join("b" * 1000) + " = 1}", "too many parts in line 1"),
    "a key after texts": ("a = '''\n'''''\nb = \"\"\"\\\"\"\"\"\"\nc" + ".d" * 40 + " = 1", "too many parts in line 4"),
    "digits": ("modes = " + "9" * 5000, "too many digits"),
    "digits to base 16": ("modes = 0x" + "f" * 5000, "modes: has too many digits"),
    "digits in a list": ("a = [1, { b = 0b1" + "0" * 5000 + " }]", r"a\[2\].b: has too many digits"),
    "lists": ("a = " + "[" * 100_000, "too deep"),
    "lists that end": ("a = " + "[" * 60 + "]" * 60, "lies too deep"),
    "tables": ("a = " + "{b.c.d.e.f.g.h.i.j.k.l.m = [" * 90 + "]}" * 90, "lies too deep"),
    "a text without an end": ('a = "' + "\\\\" * 400_000, "not valid TOML"),
    "ends of texts": ('a = """' + '\\"""' * 200_000 + "\\", "not valid TOML"),
}


@pytest.mark.parametrize("what", LONG)
def test_what_would_keep_the_reader_busy_is_refused(what):
    """A dotted key of 60 kB took 22 s, one of 1 MB an hour, then came a RecursionError; now it is looked at first.

    2 s: what is refused takes 0.3 s at most, the square of the length would be minutes.
    """
    text, words = LONG[what]
    begun = time.process_time()
    with pytest.raises(InputError, match=words) as refused:
        model.loads(text, path="study.toml")
    assert time.process_time() - begun < 2.0
    assert refused.value.file == "study.toml"
    assert len(str(refused.value)) < 1000


def test_the_same_words_from_a_file(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(TEXT.replace("modes = 3", "modes = " + "9" * 5000))
    with pytest.raises(InputError, match="too many digits"):
        model.load(path)


@pytest.mark.parametrize(
    "line",
    [
        "# 1.2.3." + "4." * 100,
        "note = '" + "a." * 100 + "'",
        'note = "' + 'a\\"." ' + "# " + "b." * 100,
        'note = """\n' + "a.b" * 100 + '\n"""""',
        "note = [" + "0.5, " * 100 + "]",
        "note = [" + "0.5,\n" * 100 + "]",
        ".".join("a" * DEEPEST) + " = 1",
    ],
)
def test_dots_that_are_no_key_are_left_alone(line):
    assert parse_toml(f"{line}\n[leg]\nb = 1.5\n", "study.toml")["leg"] == {"b": 1.5}


@pytest.mark.parametrize("name", model.PRESETS)
def test_presets_are_read_as_they_stand(name):
    assert parse_toml(model.preset_text(name), name) == tomllib.loads(model.preset_text(name))
