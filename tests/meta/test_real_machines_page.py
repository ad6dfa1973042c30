"""The tables of docs/real-machines.md: recomputed from the preset, to the digits that they print."""

import re
from pathlib import Path

import numpy as np
import pytest

import flexapod as fx
from flexapod.model import Joint, PrescribedDrive, preset

pytestmark = pytest.mark.consistency

PAGE = (Path(__file__).parents[2] / "docs" / "real-machines.md").read_text(encoding="utf-8")
STUDY = preset("machine-hexapod")
IDEAL = {"base_joint": Joint(), "platform_joint": Joint(), "springs": (), "drive": PrescribedDrive()}
KEPT = {
    "ideal": (),
    "joints added": ("base_joint", "platform_joint"),
    "screws added": ("drive",),
    "joints, screws, plates": tuple(IDEAL),
    "with heat": tuple(IDEAL),
}


def row(words):
    """The numbers of a row of the page's table, a column each."""
    line = next(line for line in PAGE.splitlines() if line.startswith(f"| {words}"))
    return dict(zip(KEPT, (float(cell) for cell in re.findall(r"\| +([\d.]+) +(?=\|)", line)), strict=True))


def without_friction(leg):
    ends = {end: getattr(leg, end).replace(friction=None) for end in ("base_joint", "platform_joint")}
    return leg.replace(**ends, drive=leg.drive.replace(friction=None))


def variant(name):
    ideal = {key: part for key, part in IDEAL.items() if key not in KEPT[name]}
    legs = tuple(without_friction(leg).replace(**ideal) for leg in STUDY.robot.legs)
    return STUDY.robot.replace(legs=legs, heat=STUDY.robot.heat if name == "with heat" else None, tolerances=None)


@pytest.mark.parametrize("name", KEPT)
def test_what_parts_change(name):
    # Half a unit of the last digit, and as much again.
    robot = variant(name)
    drawn = robot.replace(heat=None)
    found, give = fx.modes(drawn), np.linalg.inv(fx.stiffness(drawn).stiffness.values)[:3, :3]
    ours = {
        "stiffness along a leg": float(fx.parts(drawn).leg_stiffness[0]) / 1e6,
        "least stiffness at the tool": 1e-6 / np.linalg.eigvalsh(give)[-1],
        "sag of the centre of mass at home": -1e6 * float(found.com_sag[2]),
        "first frequency": float(found.frequency[0]),
        "its damping": 100 * float(found.damping_ratio[0]),
    }
    for words, value in ours.items():
        printed = row(words)[name]
        assert value == pytest.approx(printed, abs=1.0 if printed >= 20 else 0.1), words
    data = fx.simulate(robot, STUDY.motion, tolerance=1e-4)
    largest = 1e6 * float(np.linalg.norm(data.tool_deviation.values, axis=1).max())
    assert largest == pytest.approx(row("tool beside its path, largest")[name], abs=0.1)
