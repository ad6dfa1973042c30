"""Bounds that spare checks and remarks a closer look never hide what that would find."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.analysis.checks import checks, plausibility
from flexapod.analysis.results import bodies
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.model import AxisMotion

pytestmark = pytest.mark.unit

SHORT = {"fidelity": "lumped", "duration": 0.02}


def test_legs_that_few_instants_tell_apart_are_apart_at_all(monkeypatch):
    """Cylinders ever thicker, up to where legs run into each other: told apart while there is room, no longer."""
    told, gaps, path = [], [], RigidPath(fx.preset("paper-robot"))
    tips, _ = path.poses.place(path.robot.platform_joints), bodies.pairs_of_legs(path.robot)
    for wide in np.linspace(1.0, 6.0, 21):
        monkeypatch.setattr(bodies, "CYLINDER", wide)
        gaps.append(bodies.clearance(path.robot, tips, path.axes, path.legs.length).gap.min())
        told.append(checks._legs_clear(path))
    assert all(gap > 0 for gap, apart in zip(gaps, told, strict=True) if apart)
    assert told[0]
    assert min(gaps) < 0


@pytest.mark.parametrize("load", [0.0, 3e3, 1e5, 1e6])
@pytest.mark.parametrize("preset", ["paper-robot", "machine-hexapod", "tripod"])
def test_remarks_are_those_of_a_look_at_all_instants(preset, load, monkeypatch):
    study = fx.preset(preset)
    motion = AxisMotion(type="heave", amplitude=1e-3, duration=0.02, profile="quintic")
    study = study.replace(motion=motion)

    def said():
        return fx.simulate(study, load=[load, 0, -load, 0, 0, 0], **SHORT).warnings

    spared = said()
    monkeypatch.setattr(plausibility, "_in_doubt", lambda *_: plausibility.KINDS)
    assert said() == spared


def test_a_strong_robot_is_not_looked_at_closer(monkeypatch):
    """Else the comparison above proves nothing."""
    monkeypatch.setattr(plausibility, "leg_values", None)
    assert fx.simulate(paper_robot(), **SHORT).sizes["time"] > 1
