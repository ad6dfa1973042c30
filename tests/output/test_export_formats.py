"""The table of formats: what a study can be written as, and how wrong formats, options and places are refused."""

import pytest

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.output.exchange import formats
from flexapod.output.exchange.formats import FORMATS
from flexapod.output.exchange.pose_deck import abaqus_deck

pytestmark = pytest.mark.unit

ROBOT = fx.preset("paper-robot")


def test_a_deck_is_written_as_it_was_and_says_what_it_leaves_out(tmp_path):
    found = fx.export(ROBOT, "abaqus", tmp_path / "new" / "deck.inp", elements=2, modes=3, title="A deck")
    text = (tmp_path / "new" / "deck.inp").read_text(encoding="ascii")
    assert text == abaqus_deck(ROBOT, elements=2, modes=3, title="A deck")
    assert found.files == (tmp_path / "new" / "deck.inp",) and found.left_out == ("damping",)
    with open(found, encoding="ascii") as file:  # it stands for its path
        assert file.readline() == "*HEADING\n"


def test_a_robot_and_a_file_will_do(tmp_path):
    (tmp_path / "study.toml").write_text(fx.model.preset_text("paper-robot"), encoding="utf-8")
    for subject, name in ((ROBOT.robot, "a.inp"), (tmp_path / "study.toml", "b.inp")):
        fx.export(subject, "abaqus", tmp_path / name, elements=2)
    assert (tmp_path / "a.inp").read_text() == (tmp_path / "b.inp").read_text()


@pytest.mark.parametrize(
    ("format", "name", "options", "words"),
    [
        ("abacus", "a.inp", {}, ("'abacus'", "abaqus, a deck", "Did you mean 'abaqus'?")),
        ("abaqus", "a.txt", {}, ("is not named as a deck", "FILE.inp")),
        ("abaqus", "", {}, ("is a folder", "name of a file")),
        ("abaqus", "a.inp", {"step": 1e-3}, ("step = 0.001", "is not an option of abaqus", "elements")),
        ("abaqus", "a.inp", {"elements": 1}, ("elements = 1", "from 2 to 500")),
    ],
)
def test_what_does_not_fit_is_refused_and_nothing_written(tmp_path, format, name, options, words):
    with pytest.raises(InputError) as refused:
        fx.export(ROBOT, format, tmp_path / name, **options)
    assert all(word in str(refused.value) for word in words), refused.value
    assert not list(tmp_path.iterdir())


def test_single_actuators_are_refused(tmp_path):
    with pytest.raises(InputError, match="neither a robot nor the study of one"):
        fx.export(fx.preset("paper-actuator"), "abaqus", tmp_path / "a.inp")


def test_each_format_says_how_its_file_is_named():
    for kind in FORMATS.values():
        assert all(ending in kind.named for ending in kind.endings)


def test_what_names_other_files_is_written_last(tmp_path, monkeypatch):
    """Stopped in the middle, a time series for ParaView once named files that were not there."""
    order, replacing = [], formats.replace_file
    monkeypatch.setattr(formats, "replace_file", lambda path: order.append(path.name) or replacing(path))
    study = fx.preset("small-hexapod")
    data = fx.simulate(study, fidelity="rigid", duration=0.002, output_step=0.001)
    made = fx.export(study, "vtk", tmp_path / "a.pvd", data=data)
    assert len(order) == 4 and order[-1] == made.path.name == "a.pvd"
