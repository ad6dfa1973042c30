"""Defaults and catalogue values against their table with sources, ``docs/defaults.md``, row by row."""

import math
import re
from functools import cache
from pathlib import Path

import pytest

import flexapod as fx
from flexapod.common.tables.key_rows import list_entries
from flexapod.design.first_robot.catalogue import SCREWS
from flexapod.model import MATERIALS
from flexapod.model.leg import rolling
from flexapod.model.study.tolerances import CLASSES

pytestmark = pytest.mark.contract

PAGE = Path(__file__).parents[2] / "docs" / "defaults.md"
FRICTION = {"0.01": " of a screw", "1e-05": " of a stroke"}  # one key, two drives


@cache
def table(title):
    """Rows of the page's table under a title, without its head."""
    text = PAGE.read_text(encoding="utf-8").split(f"## {title}")[1].split("\n## ")[0]
    rows = [re.split(r"(?<!\\)\|", line)[1:-1] for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in rows[2:]]


def number(text):
    """A cell's number, with a factor that stands before it."""
    return math.prod(float(x) for x in text.split("*"))


def test_every_row_has_a_source():
    for title in ("Defaults", "Accuracy classes of screws", "Materials", "Screws that `flexapod new --from`"):
        assert table(title)
        assert all(len(row[-1]) > 5 for row in table(title))


def test_defaults_of_study_files():
    told = {name.replace("`", ""): value for name, value, _ in table("Defaults")}
    found = {}
    for entry in list_entries():
        for row in entry.rows:
            if row.default[:1] in set("[123456789") or row.default.startswith("0."):
                key = f"{entry.entry.table.replace('[]', '')}.{row.key}"
                drive = FRICTION.get(row.default, "") if key == "leg.drive.friction.presliding" else ""
                found[key + drive] = row.default
    # A kind, a count of legs, the origin and what is zero are no numbers from anywhere.
    nothing = re.compile(r"[A-Za-z]{2}|^\[0(, 0)*\]$")
    assert {key: value for key, value in found.items() if not nothing.search(value)} == told


def test_accuracy_classes():
    rows = table("Accuracy classes of screws")
    assert {name: float(error) / float(over) for name, error, over, _ in rows} == CLASSES
    study = fx.loads(fx.model.preset_text("machine-hexapod"))
    for name, error, over, _ in rows:
        assert study.robot.tolerances.replace(lead={"box": float(error) / float(over)}).lead.box == CLASSES[name]


def test_materials():
    names = ("E", "density", "yield_stress", "poisson", "expansion")
    scale = (1e9, 1.0, 1e6, 1.0, 1e-6)
    assert {row[0] for row in table("Materials")} == set(MATERIALS)
    for name, *values, _ in table("Materials"):
        for field, factor, value in zip(names, scale, values, strict=True):
            assert getattr(MATERIALS[name], field) == pytest.approx(factor * float(value), rel=1e-12), (name, field)


def test_rolling_bearings():
    rows = table("Rolling bearings in joints")
    assert {name: float(k) for name, k, a in rows if k} == rolling._FIXED
    assert {name: float(a) for name, k, a in rows if a} == rolling._BY_WIDTH
    assert rolling.EXPONENT == 0.84


def test_screws_of_first_robots():
    rows = table("Screws that `flexapod new --from`")
    assert [row[0] for row in rows] == [screw.name for screw in SCREWS]
    for screw, (_, *values, _) in zip(SCREWS, rows, strict=True):
        ours = (1e3 * screw.root, 1e-6 * screw.rigidity, 1e-3 * screw.dynamic_load, 1e-6 * screw.bearing,
                1e-3 * screw.bears, 1e3 * screw.bore)  # fmt: skip
        assert ours == pytest.approx([number(x) for x in values], rel=1e-12), screw.name
