"""The paper's literature and outlook: what is said to be here has a call that runs, what is not yet here has none."""

from pathlib import Path

import pytest

import flexapod as fx
from flexapod.verification.paper.literature import GIVEN, HERE, IN_PART, NOT_YET, TOPICS, literature_markdown

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def names():
    return {"fx": fx} | {name: eval(call, {"fx": fx}) for name, call in GIVEN.items()}


@pytest.mark.parametrize("topic", [t for t in TOPICS if t.status != NOT_YET], ids=lambda topic: topic.paper[:40])
def test_what_is_here_runs(topic, names, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert eval(topic.call, names) is not None


def test_what_is_not_yet_here_has_no_call():
    absent = [topic for topic in TOPICS if topic.status == NOT_YET]
    assert absent and not any(topic.call for topic in absent)
    for topic in TOPICS:
        assert topic.status in (HERE, IN_PART, NOT_YET)
        assert ("not yet" in topic.here) == (topic.status == IN_PART), topic.paper
        assert bool(topic.awaits) == (topic.status == NOT_YET), "which call would do it?"
        assert not topic.awaits or not hasattr(fx, topic.awaits), f"fx.{topic.awaits} is here: say so"


def test_every_item_of_sections_4_3_and_4_4_has_a_row():
    """Words of the paper's text, in its order."""
    asked = (
        "architectures", "friction", "material imperfections", "external disturbances", "active vibration control",
        "real-time feedback", "adaptive damping", "new materials", "thermal, fluidic, electromagnetic", "prototypes",
        "compensates",
    )  # fmt: skip
    told = " ".join(topic.paper for topic in TOPICS if topic.paper.startswith("4."))
    assert not [words for words in asked if words not in told]


def test_the_page_has_the_list():
    assert literature_markdown() in PAGE
    assert all(call in PAGE for call in GIVEN.values())
