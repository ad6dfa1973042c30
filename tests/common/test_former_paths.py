"""Modules under the paths that they had one release ago: the same modules, with a remark."""

import importlib
import subprocess
import sys
import warnings

import pytest

from flexapod.common import former_paths
from flexapod.mechanics.elements.element import Element

pytestmark = pytest.mark.unit


@pytest.mark.parametrize(
    ("former", "now"),
    [
        ("elements", "mechanics.elements"),
        ("elements.element", "mechanics.elements.element"),
        ("elements.known", "mechanics.elements.registry"),
        ("schema.base", "common.tables.base"),
        ("model.piston", "model.leg.piston"),
        ("solve.saddle", "solve.saddle_point"),
        ("errors", "common.errors"),
        ("surveys.sweeps.kept", "design.sweeps.outputs"),
        ("plot.style", "output.figures.style"),
    ],
)
def test_a_former_path_is_the_module_with_a_remark(former, now):
    sys.modules.pop(f"flexapod.{former}", None)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        module = importlib.import_module(f"flexapod.{former}")
    assert f"flexapod.{former} is flexapod.{now} now" in [str(x.message) for x in told if x.category is FutureWarning]
    assert module is importlib.import_module(f"flexapod.{now}")
    assert module.__name__ == module.__spec__.name == f"flexapod.{now}"


def test_every_former_path_leads_to_a_module():
    for name in former_paths._PATHS:
        now = former_paths.new_path(f"flexapod.{name}")
        assert importlib.util.find_spec(now) is not None, name


def test_a_class_from_a_former_path_is_the_same_class():
    sys.modules.pop("flexapod.elements", None)
    sys.modules.pop("flexapod.elements.element", None)
    with pytest.warns(FutureWarning):
        again = importlib.import_module("flexapod.elements.element").Element
    assert again is Element


@pytest.mark.parametrize("name", ["plot", "study", "control", "kinematics", "model"])
def test_packages_that_the_root_shows_are_imported_without_a_remark(name):
    code = f"import flexapod as fx, flexapod.{name} as shown; assert fx.{name} is shown; from flexapod import {name}"
    subprocess.run([sys.executable, "-W", "error::FutureWarning", "-c", code], check=True)


def test_what_never_was_is_not_found():
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("flexapod.nothing")
