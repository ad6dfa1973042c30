"""What `repr`, notebooks and tab completion show of the model: short, in units, nothing of pydantic's."""

import copy
import pickle

import numpy as np
import pytest
from pydantic import BaseModel

import flexapod as fx
from flexapod import model

pytestmark = pytest.mark.unit

ROBOT, BEAM = fx.preset("paper-robot"), fx.preset("paper-actuator")
LEG = ROBOT.robot.legs[0]
SHOWN = [
    (ROBOT, ["paper-robot.toml", "6-UPS", "900 mm", "100 kg", "roll 26.6 deg", "in 1 s", "assumed-modes", "0.0001"]),
    (ROBOT.robot, ["6-UPS", "home height: 900 mm", "six alike", "915.2 mm", "prescribed", "100 kg"]),
    (LEG, ["27 mm thick", "750 mm long", "114.5 MN", "315.2 mm", "700 mm to 1.05 m", "prescribed", "0.5 %"]),
    (ROBOT.robot.payload, ["100 kg", "[0, 373, 0] mm", "17.88"]),
    (ROBOT.motion, ["roll 26.6 deg", "in: 1 s", "hold: 1 s", "quintic"]),
    (ROBOT.simulation, ["assumed-modes", "3 a plane", "0.0001", "2 s"]),
    (BEAM, ["paper-actuator.toml", "3.66 m", "1.83 m", "756.65", "0.785", "0.1"]),
    (BEAM.actuator, ["3.66 m", "1.83 m", "756.65 N m^2", "4.02 kg/m"]),
    (model.ServoDrive(stiffness=1e7, damping=2e3), ["ServoDrive", "stiffness: 10000000", "damping: 2000"]),
    (model.CsvMotion(time=np.arange(3.0), pose=np.zeros((3, 6))), ["3 rows", "2 s"]),
]


@pytest.mark.parametrize(("part", "words"), SHOWN, ids=[type(part).__name__ for part, _ in SHOWN])
def test_short_and_in_units(part, words):
    """A study once printed its whole file and every joint six times: 6000 characters."""
    for text in (repr(part), part._repr_html_().replace('</td><td style="text-align: left">', ": ")):
        assert type(part).__name__ in text
        assert len(repr(part)) < 400
        assert "array(" not in text
    for word in words:
        assert word in repr(part)
    assert str(part) == repr(part)
    assert part._repr_html_().count("<tr>") >= 2


def test_names_from_outside_are_no_markup():
    study = ROBOT.replace(path="<b>&.toml")
    assert "&lt;b&gt;&amp;.toml" in study._repr_html_() and "<b>&" not in study._repr_html_()


def test_legs_that_differ_are_told():
    legs = (LEG.replace(damping=0.01), *ROBOT.robot.legs[1:])
    assert "of several kinds" in repr(ROBOT.robot.replace(legs=legs))


@pytest.mark.parametrize("part", [part for part, _ in SHOWN], ids=[type(part).__name__ for part, _ in SHOWN])
def test_completion_offers_what_users_look_for(part):
    hash(part)  # kept in the object
    names = {name for name in dir(part) if not name.startswith("_")}
    assert names >= {"replace", *type(part).model_fields}
    assert not names & {name for name in dir(BaseModel) if not name.startswith("_")}
    assert "hash" not in names and "model_config" not in names


def test_pydantic_goes_on_working():
    study = ROBOT
    assert study.model_dump()["robot"]["home_height"] == 0.9
    assert study.motion.model_dump_json().startswith("{")
    assert study.model_copy() == copy.copy(study) == copy.deepcopy(study) == pickle.loads(pickle.dumps(study)) == study
    assert model.Stroke.model_validate({"min": 0.1, "max": 0.2}).max == 0.2
    assert set(type(study).model_fields) >= {"robot", "motion", "simulation"}
