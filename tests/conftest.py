"""Folder = marker: a test carries the name of its folder as its marker."""

import os
from pathlib import Path

import pytest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices: threads of BLAS only cost
HERE = Path(__file__).parent
KINDS = (
    "analytic", "cli", "consistency", "contract", "conservation", "convergence",
    "golden", "literature", "meta", "property", "unit", "web",
)  # fmt: skip


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        kind = item.path.relative_to(HERE).parts[0]
        if kind not in KINDS:
            raise pytest.UsageError(f"{item.path}: tests live in tests/<kind>/, kind one of {', '.join(KINDS)}")
        item.add_marker(kind)
