"""The study that results carry: handed on in memory while it is known, read from the text of files."""

import pytest

import flexapod as fx
from flexapod import model
from flexapod.analysis.results.attributes import KEPT, attributes, result_study, robot_of

pytestmark = pytest.mark.unit


@pytest.fixture
def study():
    return fx.preset("paper-robot")


class _Data:
    def __init__(self, attrs):
        self.attrs = attrs


def test_the_study_is_handed_on_without_reading_its_text(study, monkeypatch):
    data = _Data(attributes(study))
    monkeypatch.setattr(model, "loads", None)
    monkeypatch.setattr(model, "loads_robot", None)
    assert result_study(data) is study
    assert robot_of(data) is study.robot


def test_a_result_whose_text_is_another_is_read(study):
    data = _Data(attributes(study))
    other = _Data(data.attrs | {"study": study.source_text.replace('mass = "100 kg"', 'mass = "90 kg"')})
    assert result_study(other).robot.payload.mass == 90
    assert robot_of(other).payload.mass == 90


def test_only_the_last_studies_are_kept(study):
    first = _Data(attributes(study))
    for k in range(KEPT):
        attributes(model.override(study, duration=1.0 + k))
    again = result_study(first)
    assert again is not study
    assert again == study
