"""Every refusal of a study file that the suite provokes reads as it did; see `tests.golden.refusals`."""

import pytest
from tests.golden.refusals import message, packed, rows, samples, unpacked

from flexapod.mechanics.elements.element import registered

pytestmark = pytest.mark.golden


def test_refusals_read_as_they_did(monkeypatch):
    for name in list(registered):  # tables of elements that other tests made known are allowed, too
        monkeypatch.delitem(registered, name)
    wrong = []
    for row in rows():
        said = message(row["reader"], unpacked(row, samples()))
        if said != row["message"]:
            wrong.append(f"was: {row['message']}\nnow: {said}")
    assert not wrong, f"{len(wrong)} of {len(rows())} messages changed\n" + "\n\n".join(wrong[:20])


def test_the_table_holds_what_the_suite_refuses():
    assert len(rows()) > 500


def test_texts_come_back_letter_for_letter():
    for text in ("", "[robot]\ntype = 1", "a\r\nb\n\nc", "\x0b\x1c[robot]\n"):
        assert unpacked(packed(text, samples()), samples()) == text
