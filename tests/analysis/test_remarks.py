"""Words of remarks: each kind of the table is used, with the numbers that its words take."""

import ast
from pathlib import Path
from string import Formatter

import pytest

import flexapod
from flexapod.analysis.results.remarks import REMARKS, Doubt, remark, worst_remarks
from flexapod.common.quantities import fill_template

pytestmark = pytest.mark.unit

SOURCES = Path(flexapod.__file__).parent


def fields(template):
    return {name for _, name, _, _ in Formatter().parse(template) if name}


def uses():
    """Calls of `remark` that name a kind: it, and the numbers that they give, None of those that are unpacked."""
    for file in SOURCES.rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        if "remark(" not in text:
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "remark":
                if node.args and isinstance(node.args[0], ast.Constant):
                    names = {given.arg for given in node.keywords}
                    yield node.args[0].value, None if None in names else names


def test_calls_give_the_numbers_of_their_words():
    found = list(uses())
    assert len(found) >= 12
    for kind, names in found:
        assert kind in REMARKS
        assert names is None or names == fields(REMARKS[kind]), kind


@pytest.mark.parametrize("kind", REMARKS)
def test_each_kind_is_named_in_the_sources(kind):
    texts = (file.read_text(encoding="utf-8") for file in SOURCES.rglob("*.py") if file.name != "remarks.py")
    assert any(f'"{kind}"' in text for text in texts)


def test_numbers_stand_in_the_unit_in_which_they_read_well():
    words = "{x:~3 m}, {y:~4 N m}, {z:~2}, {share:.0%} in leg {leg}"
    said = fill_template(words, x=2e-5, y=1234.56, z=1e7, share=0.5, leg=3)
    assert said == "20 µm, 1.235 kN m, 10000000, 50% in leg 3"


def test_the_worst_leg_is_told_with_the_others():
    doubts = [
        Doubt(leg=leg, kind="critical speed", severity=share, numbers={"share": share})
        for leg, share in ((0, 1.5), (2, 3.0), (4, 2.0))
    ]
    (said,) = worst_remarks(doubts)
    assert said.startswith("leg 3: the screw turns 3 times as fast as its shaft may") and "(also legs 1, 5). A" in said
    assert worst_remarks([]) == []
    assert remark("large results", size="1 GB", times=3).startswith("the results take 1 GB, and 3 times")
