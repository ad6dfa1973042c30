"""Numbers as they were, to rounding. `python -m tests.golden [cases]` writes them anew."""

import numpy as np
import pytest
from tests.golden.cases import CASES, computed
from tests.golden.kept import FOLDER, bound, read, sampled

pytestmark = pytest.mark.golden


@pytest.mark.parametrize("case", CASES)
def test_numbers_are_as_they_were(case):
    found, kept = computed(case), read(case)
    missing = kept.keys() - found.keys()
    assert not missing
    wrong = []
    for name, entry in kept.items():
        old, new, allowed = np.array(entry["values"]), found[name], bound(case, name, kept)
        if new.size != entry["size"]:
            wrong.append(f"{name}: {entry['size']} values became {new.size}")
            continue
        now = sampled(new)
        same = np.isclose(now, old, rtol=0, atol=allowed, equal_nan=True)
        if not same.all():
            far = np.nanmax(np.abs(now - old))
            wrong.append(
                f"{name}: differs by {far:.2e}, {far / allowed:.1f} of what is allowed; peak {entry['peak']:.3e}"
            )
    assert not wrong, "\n".join(wrong)


def test_every_file_has_its_case():
    assert {path.stem for path in FOLDER.glob("*.json")} == set(CASES)
