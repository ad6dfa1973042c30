"""Every equation label used in src is tagged exactly once in docs/theory."""

import re
from collections import Counter
from pathlib import Path

import pytest

pytestmark = pytest.mark.meta

ROOT = Path(__file__).parents[2]
LABEL = re.compile(r"\((T\d+\.\d+[a-z]?)\)")
TAG = re.compile(r"\\tag\{(T\d+\.\d+[a-z]?)\}")


def used_labels() -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for path in sorted((ROOT / "src").rglob("*.py")):
        for label in LABEL.findall(path.read_text(encoding="utf-8")):
            found.setdefault(label, []).append(str(path.relative_to(ROOT)))
    return found


def tags() -> Counter[str]:
    pages = sorted((ROOT / "docs" / "theory").glob("*.md"))
    return Counter(tag for page in pages for tag in TAG.findall(page.read_text(encoding="utf-8")))


def test_labels_are_used_at_all():
    assert len(used_labels()) > 10, "the equations of src carry no labels"


def test_every_used_label_is_tagged_once():
    tagged = tags()
    wrong = {label: (tagged[label], files) for label, files in used_labels().items() if tagged[label] != 1}
    assert not wrong, f"labels tagged 0 or several times in docs/theory: {wrong}"


def test_no_tag_twice():
    assert not [tag for tag, count in tags().items() if count > 1]


def test_the_patterns_find_what_they_look_for():
    assert LABEL.findall("T = ...  # (T3.4), see (T2.10)") == ["T3.4", "T2.10"]
    assert TAG.findall(r"$$ x = y \tag{T3.4} $$") == ["T3.4"]
