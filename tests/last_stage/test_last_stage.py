"""What users of the stage before have runs as it did: thirty scripts, studies and commands, against what they found.

`README.md` says how the numbers were made. Names that the package had before may answer with a remark, here alone.
"""

import math
import tomllib

import pytest
from tests.last_stage.runner import HERE, differences, expected, items, run

pytestmark = pytest.mark.last_stage

TABLE = tomllib.loads((HERE / "differences.toml").read_text(encoding="utf-8"))
MEANT = TABLE["difference"]
NEAR = 1e-9  # of a peak: what other processors round in another way, a thousand operations and a condition of 1e4
LEAST = 1e-13  # in SI units: what is zero but for rounding, as sags of symmetrical robots along x
REMARK = "FutureWarning: flexapod"


def size(value):
    """Of the largest of some numbers."""
    return max(map(size, value), default=0.0) if isinstance(value, list) else abs(value)


def the_same(item, key, far, old):
    rounded = [x["by"] for x in TABLE["rounding"] if x["item"] == item and key.endswith(x["end"])]
    return far < max(rounded, default=NEAR) or (far < math.inf and far * size(old) < LEAST)


@pytest.mark.filterwarnings("always")
@pytest.mark.parametrize("item", items())
def test_runs_as_before(item, tmp_path):
    today, before = run(item, tmp_path), expected(item)
    meant, seen, wrong = [one for one in MEANT if one["item"] == item], set(), []
    for key, far, new, old in differences(today["found"], before["found"]):
        if the_same(item, key, far, old):
            continue
        one = next((one for one in meant if key.startswith(one["key"])), None)
        if one is not None and (far < one["by"] if "by" in one else new == one["now"]):
            seen.add(one["key"])
        else:
            wrong.append(f"{key}: {new} in place of {old}")
    assert not wrong, "\n".join(wrong)
    assert seen == {one["key"] for one in meant}
    told = [text for text in today["warnings"] if not text.startswith(REMARK)]
    assert len(told) == len(before["warnings"]), told


def test_there_are_thirty():
    assert len(items()) == 30
    assert sum(path.stat().st_size for path in HERE.rglob("*") if path.is_file()) < 1.5e6
