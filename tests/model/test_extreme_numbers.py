"""Numbers of any size in a study: refused, or computed with."""

import copy
import tomllib

import numpy as np
import pytest

import flexapod as fx
from flexapod import model
from flexapod.common.errors import ComputationError, FlexapodError, InputError
from flexapod.common.tables.section import Section
from flexapod.mechanics.shapes.beam_functions import eigh
from flexapod.model import preset_text
from flexapod.model.file.files import read_study
from flexapod.solve.saddle_point import saddle_solve

pytestmark = pytest.mark.unit

EXTREMES = (1e-300, 1e160)


def numbers(data, path=()):
    """Paths of all numbers, and of texts that hold one."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        if isinstance(value, dict | list):
            yield from numbers(value, (*path, key))
        elif isinstance(value, float) or (isinstance(value, str) and value[:1].isdigit() and value[:1] != "6"):
            yield (*path, key)


def tables(name):
    data = tomllib.loads(preset_text(name))
    data["simulation"] = {"step": 1e-3, "duration": 3e-3, "modes": 2}
    if name == "paper-robot":
        data["leg"] |= {"drive": {"type": "servo", "stiffness": 1e8, "damping": 1e4}, "u_axis": [1.0, 0.1, 0.0]}
    return data


@pytest.mark.parametrize("name", ["paper-robot", "paper-actuator"])
def test_every_number_of_a_study_may_be_extreme(name, tmp_path):
    """Overflows, divisions by zero and warnings of NumPy once, in fifteen of them; warnings are errors here."""
    found = {"refused": 0, "computed": 0}
    for path in numbers(tables(name)):
        for value in EXTREMES:
            data = copy.deepcopy(tables(name))
            inner = data
            for key in path[:-1]:
                inner = inner[key]
            inner[path[-1]] = value
            try:
                study = read_study(Section(data, "", None, tmp_path), "text = 1")
                result = fx.run(study)
            except FlexapodError:
                found["refused"] += 1
            else:
                found["computed"] += 1
                deviation = result.com_deviation if name == "paper-robot" else result.tip_deflection
                assert np.isfinite(deviation).all(), path
    assert min(found.values()) > 0


def test_platform_joints_at_one_point():
    """Six legs at one ball: once told as a path that is singular, or not at all."""
    robot = model.preset("paper-robot").robot
    with pytest.raises(InputError, match=r"all platform joints lie at one point.*Give robot.platform a radius"):
        robot.replace(platform_joints=np.tile([0.1, 0.0, 0.0], (6, 1)))
    with pytest.raises(InputError, match=r"all base joints lie at one point.*Give robot.base a radius"):
        robot.replace(base_joints=np.full((6, 3), 0.2))


def test_places_may_be_as_small_as_rounding_leaves_them():
    robot = model.preset("paper-robot").robot
    assert robot.replace(payload=robot.payload.replace(com=[1e-300, -6e-17, 0.3])).payload.com[1] == -6e-17


def test_what_is_not_finite_does_not_reach_lapack():
    one, bad = np.eye(2), np.full((2, 2), np.nan)
    for solve in (lambda: eigh(bad, one), lambda: eigh(one, bad)):
        with pytest.raises(ComputationError, match="not finite"):
            solve()
    with pytest.raises(ComputationError, match="not finite"):
        saddle_solve(bad, np.ones((1, 2)), np.ones(2), np.zeros(1))
