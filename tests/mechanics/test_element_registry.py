"""Kinds of elements that legs may have, each once."""

from types import SimpleNamespace

import pytest

from flexapod.mechanics.elements import registry

pytestmark = pytest.mark.unit


def test_a_built_in_element_with_a_table_of_its_own_is_one_kind(monkeypatch):
    """It stood among the built-in ones and among those in the legs: a budget counted it twice."""

    class Foot:
        at = "foot"

    monkeypatch.setattr(registry, "OURS", (*registry.OURS, Foot))
    kinds = registry.kinds_of([SimpleNamespace(elements=(Foot(),)), SimpleNamespace(elements=())])
    assert kinds.count(Foot) == 1 and len(kinds) == len(registry.OURS)
