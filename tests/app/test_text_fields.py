"""Numbers typed on the page mean what they mean in a study file, are refused in its words, and are never shortened."""

import time
from types import SimpleNamespace

import pytest
import viser

from flexapod import model
from flexapod.app.browser.background import Threads
from flexapod.app.browser.document import Document
from flexapod.app.browser.study_panel import StudyPanel
from flexapod.app.browser.text_fields import LEFT, NumberField, entry_value, in_unit, plain
from flexapod.common.errors import InputError
from flexapod.model import loads

pytestmark = pytest.mark.unit

TEXT = model.preset_text("paper-robot")
THREADS = Threads(lambda error: None)


@pytest.fixture
def client():
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield SimpleNamespace(gui=server.gui)
    server.stop()


@pytest.fixture
def panel(client):
    found = StudyPanel(client, Document(TEXT, None), THREADS, lambda edit: setattr(found, "edit", edit))
    return found


def field(client, label):
    inputs = client.gui._gui_input_handle_from_uuid.values()
    return next(h for h in inputs if getattr(h, "label", None) == label and isinstance(h.value, str))


def type_into(client, handle, text):
    handle._impl.value = text
    for callback in handle._impl.update_cb:
        callback(SimpleNamespace(client=client, client_id=0, target=handle))


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("2e2", "", 200.0),
        ("1.5e2", "", 150.0),
        ("2.1e11", "", 2.1e11),
        ("100", "", 100),
        ("-3", "", -3),
        ("27,5", "", 27.5),
        ("210 GPa", "", "210 GPa"),
        ("27,5 mm", "", "27,5 mm"),
        ("27,5", "mm", "27.5 mm"),
        ("2e2", "mm", "2e2 mm"),
        ("2.1 cm", "mm", "2.1 cm"),
        ("0.12345678901234567", "", 0.12345678901234567),
        ("123456789.0123456789", "mm", "123456789.0123456789 mm"),
        ("1,000", "", "1,000"),
        ("2e", "mm", "2e"),
        ("abc", "mm", "abc"),
    ],
)
def test_a_typed_text_becomes_what_a_file_would_have(text, unit, value):
    found = entry_value(text, unit)
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize("number", [0.1, 1 / 3, 2.1e11, 1e-300, 123456789012345.6, 27.0, 0.30000000000000004])
def test_numbers_are_shown_whole(number):
    assert float(plain(number)) == number
    assert Document("[a]\n", None).with_value("a.b", number).value("a.b") == number


@pytest.mark.parametrize(
    ("text", "mass"),
    [("2e2", 200.0), ("1.5e2", 150.0), ("27,5", 27.5), ("2e2 g", 0.2), ("0.1 t", 100.0), (" 99 ", 99.0)],
)
def test_the_study_is_the_one_that_was_typed(client, panel, text, mass):
    """2e2 once became 22, and 1.5e2 1.52: the wrong study was computed, in green."""
    type_into(client, field(client, "mass [kg]"), text + LEFT)
    assert panel.edit.study.robot.payload.mass == pytest.approx(mass, rel=1e-15)
    assert loads(panel.document.text).robot.payload.mass == panel.edit.study.robot.payload.mass


@pytest.mark.parametrize("text", ["1,000", "1,000.5", "1 000", "2e", "1.2.3", "abc", "0x10", "5 mm", "nan", "1e999"])
def test_what_cannot_be_read_is_refused_in_the_words_of_files(client, panel, text):
    mass = field(client, "mass [kg]")
    type_into(client, mass, text + LEFT)
    assert panel.edit.study is None
    assert panel.edit.error.key == "payload.mass"
    assert mass.value in (text, f"{text} kg") and mass.label == "mass [kg]"  # as it was typed: it is what is refused
    type_into(client, mass, LEFT)  # emptied
    assert panel.edit.study is not None and panel.document.text == TEXT
    assert mass.value == "100"


def test_an_emptied_field_gets_its_value_back(client, panel):
    before = panel.document
    for label, value in (("diameter [mm]", "27"), ("modes", "3"), ("com y [mm]", "373"), ("tolerance", "0.0001")):
        type_into(client, field(client, label), "")
        assert field(client, label).value == ""  # who writes a new one first takes the old one out
        type_into(client, field(client, label), LEFT)
        assert field(client, label).value == value
    assert panel.document is before


def test_a_unit_may_be_typed_and_is_shown(client, panel):
    diameter = field(client, "diameter [mm]")
    type_into(client, diameter, "2.1 cm" + LEFT)
    assert 'diameter = "2.1 cm"' in panel.document.text
    assert (diameter.label, diameter.value) == ("diameter [cm]", "2.1")
    type_into(client, diameter, "3" + LEFT)
    assert 'diameter = "3 cm"' in panel.document.text
    com = field(client, "com x [mm]")
    type_into(client, com, "0.1 m" + LEFT)
    assert '"0.1 m", "373 mm"' in panel.document.text
    assert [field(client, f"com {axis} [m]").value for axis in "xyz"] == ["0.1", "0.373", "0"]
    type_into(client, com, "0" + LEFT)
    assert 'com = [0, "373 mm", 0]' in panel.document.text


def test_a_text_is_left_alone_while_somebody_types(client, panel):
    """5 m on the way to 5 mm: neither the field nor what a plain number in it means may change under the writer."""
    diameter = field(client, "diameter [mm]")
    type_into(client, diameter, "2 m")
    panel._typed("leg.piston.diameter", "2 m", True)  # the writer has paused
    assert panel.edit.study is None or panel.edit.study.robot.legs[0].piston.diameter == 2.0
    assert (diameter.label, diameter.value) == ("diameter [mm]", "2 m")
    type_into(client, diameter, "28" + LEFT)
    assert 'diameter = "28 mm"' in panel.document.text


def test_a_pause_is_enough(client, panel):
    type_into(client, field(client, "mass [kg]"), "2e2")
    end = time.monotonic() + 300
    while not hasattr(panel, "edit") and time.monotonic() < end:
        time.sleep(0.02)
    assert panel.edit.study.robot.payload.mass == 200.0


def test_the_number_that_is_turned_can_be_typed(client, panel):
    panel._knob._choice.value = "payload.mass"
    value = field(client, "value [kg]")
    type_into(client, value, "1.5e2" + LEFT)
    assert panel.edit.study.robot.payload.mass == 150.0
    assert value.value == "150" and panel._knob._slider.value == 150.0
    type_into(client, value, "1,000" + LEFT)
    assert panel.edit.error.key == "payload.mass"
    type_into(client, value, LEFT)
    assert panel.edit.study.robot.payload.mass == 150.0 and value.value == "150"


@pytest.mark.parametrize(
    ("text", "value", "words"),
    [
        ("5e-2", 0.05, ""),
        ("50 ms", 0.05, ""),
        ("0,05", 0.05, ""),
        ("1e-1 s", 0.1, ""),
        ("3", 0.0, "is beyond the slider"),
        ("-1", 0.0, "is beyond the slider"),
        ("5 mm", 0.0, "is not a time"),
        ("1,000", 0.0, "set thousands apart"),
        ("2e", 0.0, "is not a time"),
    ],
)
def test_a_slider_takes_typed_numbers(client, text, value, words):
    moves = []
    dial = NumberField(
        client.gui, THREADS, "time", "s", (0.0, 2.0), 0.001, 0.0, lambda: moves.append(dial.value), dimension="time"
    )
    box = field(client, "time [s]")
    type_into(client, box, text + LEFT)
    assert dial.value == pytest.approx(value, rel=1e-15) and moves == ([] if words else [dial.value])
    assert words in dial._words.content and bool(words) == bool(dial._words.content)
    assert box.value == f"{dial.value:.12g}"
    dial.value = 1.0
    assert box.value == "1" and not dial._words.content


def test_whole_numbers_stay_whole(client):
    dial = NumberField(client.gui, THREADS, "shapes", "", (1, 12), 1, 3, lambda: None)
    shapes = field(client, "shapes")
    type_into(client, shapes, "2.5" + LEFT)
    assert dial.value == 3 and "is not a whole number" in dial._words.content
    type_into(client, shapes, "1e1" + LEFT)
    assert dial.value == 10 and isinstance(dial.value, int)


def test_a_number_in_another_unit_is_read_in_the_one_that_is_shown():
    assert in_unit("2", "mm", "length", "heave") == 2.0
    assert in_unit("2 cm", "mm", "length", "heave") == pytest.approx(20.0, rel=1e-15)
    assert in_unit("0.1", "%", "number", "amplitude") == 0.1
    with pytest.raises(InputError, match="heave"):
        in_unit("2 kg", "mm", "length", "heave")
