"""A study that is changed number by number: text kept, words of the reader, nothing read that was not sent."""

import tomllib

import pytest

from flexapod.app.browser.document import Document, TypedQuantity, edit_choice, edit_values, first_value, quantity, read
from flexapod.app.browser.uploads import LARGEST, read_upload, store_table
from flexapod.common.errors import InputError
from flexapod.model import PRESETS, preset_text
from flexapod.model.file.fields import read_fields

pytestmark = pytest.mark.unit

TEXT = preset_text("paper-robot")


def leaves(data, path=""):
    for name, value in data.items():
        key = f"{path}.{name}" if path else name
        yield from leaves(value, key) if isinstance(value, dict) else [(key, value)]


def field(key, text=TEXT):
    return {f.key: f for f in read_fields(text, None)}[key]


@pytest.mark.parametrize("name", PRESETS)
def test_fields_are_all_values_of_the_file(name):
    text = preset_text(name)
    assert {f.key: f.value for f in read_fields(text, None) if f.value is not None} == dict(leaves(tomllib.loads(text)))


def test_fields_of_unequal_legs_and_points():
    legs = TEXT.split("\n[leg]")[1].split("[motion]")[0]
    many = TEXT.replace("\n[leg]" + legs, "".join(f"\n[[leg]]{legs}" for _ in range(6)))
    keys = {f.key for f in read_fields(many, None)}
    assert {"leg[1].piston.diameter", "leg[6].stroke.max"} <= keys
    assert (
        read(Document(many, None).with_value("leg[3].piston.diameter", "30 mm")).study.robot.legs[2].piston.diameter
        == 0.03
    )
    points = TEXT.split("[motion]")[0] + '[motion]\ntype = "waypoints"\npoints = [{ time = "1 s", roll = "5 deg" }]\n'
    assert "motion.points[1].roll" in {f.key for f in read_fields(points, None)}
    moved = read(Document(points, None).with_value("motion.points[1].roll", "6 deg")).study.motion
    assert moved.points[0].roll == pytest.approx(0.1047197551)


def test_bounds_are_those_of_the_model():
    assert field("leg.piston.diameter").bounds.words == "above 0"
    assert field("simulation.tolerance").bounds.words == "above 0, below 1"
    assert field("leg.axial_modes").bounds.words == "at least 0, at most 4"
    assert field("payload.com").bounds.words == ""


def test_a_change_touches_nothing_else():
    found = edit_values(
        Document(TEXT, None), {"leg.piston.diameter": "30 mm", "payload.com[2]": "0.4 m", "load.wrench": [0] * 6}
    )
    assert found.error is None
    assert found.document.text.startswith(TEXT.replace('= "27 mm"', '= "30 mm"').replace('[0, "373 mm"', '[0, "0.4 m"'))
    assert tomllib.loads(found.document.text)["load"] == {"wrench": [0] * 6}
    assert found.document.without_key("load").text.strip() == found.document.text.split("[load]")[0].strip()


def test_another_choice_takes_out_what_belonged_to_the_one_before():
    servo = edit_values(Document(TEXT, None), {"leg.drive.type": "servo", "leg.drive.stiffness": "50 N/um"})
    assert servo.study.robot.legs[0].drive.stiffness == 5e7
    back = edit_choice(servo.document, field("leg.drive.type", servo.document.text), "prescribed")
    assert back.removed == ("leg.drive.stiffness",)
    assert back.study.robot.legs[0].drive.type == "prescribed"
    missing = edit_choice(Document(TEXT, None), field("leg.drive.type"), "servo")
    assert missing.error.key == "leg.drive.stiffness" and missing.removed == ()


@pytest.mark.parametrize(
    ("written", "number", "unit", "again"),
    [
        ("27 mm", 27.0, "mm", "27 mm"),
        (3, 3.0, "", 3),
        (1e-4, 1e-4, "", 1e-4),
        ("-9.81 m/s^2", -9.81, "m/s^2", "-9.81 m/s^2"),
    ],
)
def test_quantities_are_written_as_they_were_read(written, number, unit, again):
    found = quantity(written)
    assert found == TypedQuantity(number, unit)
    assert found.toml_value() == again and type(found.toml_value()) is type(again)


def test_quantities_in_another_unit():
    assert TypedQuantity(0.0, "").in_unit("mm", "length") == TypedQuantity(0.0, "mm")
    assert TypedQuantity(2.0, "m").in_unit("mm", "length").number == pytest.approx(2000.0, rel=1e-15)
    assert quantity("steel") is None and quantity(True) is None


def test_values_to_start_from_are_valid():
    """Every absent number or choice can be added on its own, but for those that exclude one that is there."""
    excluded = {"simulation.step", "leg.piston.inner_diameter", "leg.u_axis", "robot.plane", "leg.count", "leg.chain"}
    excluded.add("leg.piston.keyed")  # false asks for a leg with C and a screw
    for found in read_fields(TEXT, None):
        if found.value is None and found.key not in excluded:
            assert edit_values(Document(TEXT, None), {found.key: first_value(found)}).error is None, found.key


def test_an_upload_reads_no_file_of_the_server(tmp_path):
    secret = tmp_path / "secret.csv"
    secret.write_text("time [s], roll [deg]\n0, 0\n1, 1\n")
    sent = tmp_path / "sent"
    sent.mkdir()
    head = TEXT.split("[motion]")[0]
    for file in (str(secret), "../secret.csv", "..\\secret.csv", "secret.csv", "", "."):
        with pytest.raises(InputError, match="was not sent"):
            read_upload("a.toml", f"{head}[motion]\ntype = 'csv'\nfile = '{file}'\n".encode(), sent)
    assert store_table("../../path.csv", secret.read_bytes(), sent) == "path.csv"
    document = read_upload("a.toml", f"{head}[motion]\ntype = 'csv'\nfile = 'path.csv'\n".encode(), sent)
    assert read(document).study.motion.end_time == 1.0
    assert [p.name for p in sent.iterdir()] == ["path.csv"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"a = 1" + b" " * LARGEST, "too large"),
        (b"\xff\xfe", "not UTF-8"),
        (b"a =", "not valid TOML"),
        (b"a = 1", "neither"),
    ],
)
def test_bad_uploads(tmp_path, content, words):
    with pytest.raises(InputError, match=words):
        read_upload("a.toml", content, tmp_path)


def test_deeply_nested_uploads_are_refused(tmp_path):
    with pytest.raises(InputError, match="not valid TOML"):
        read_upload("a.toml", b"a = " + b"[" * 100_000 + b"]" * 100_000, tmp_path)
