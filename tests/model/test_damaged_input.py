"""Damaged files by the thousand: refused in words, or computed in finite numbers.

More of them by hand: ``.venv/bin/python -m tools.damaged 100000``.
"""

import pytest
from tools.damaged import MARCHED, WHOLE, Damaged, damaged, outcome

pytestmark = pytest.mark.property

COUNT, BLOCK = 2000, 100


@pytest.mark.parametrize("name", WHOLE)
def test_whole_files_are_accepted(name, tmp_path):
    files = {file: text.encode() for file, text in WHOLE[name].items()}
    assert outcome(Damaged(name, files, ()), tmp_path, march=True) == "accepted"


@pytest.mark.parametrize("first", range(0, COUNT, BLOCK))
def test_damaged_files(first, tmp_path):
    outcomes = []
    for seed in range(first, first + BLOCK):
        case, folder = damaged(seed), tmp_path / str(seed)
        folder.mkdir()
        try:
            outcomes.append(outcome(case, folder, march=seed % MARCHED == 0))
        except Exception as error:
            raise AssertionError(f"seed {seed}: {case.name}, {', '.join(case.how)}") from error
    # Both happen in every block: neither is a test that tests nothing.
    assert 5 < outcomes.count("accepted") < 60
    assert outcomes.count("refused") > 40


def test_a_seed_is_a_file():
    assert damaged(5) == damaged(5)
    assert damaged(5) != damaged(6)
