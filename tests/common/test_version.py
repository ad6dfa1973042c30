"""Hash of the sources that numbers come from."""

import importlib.util
import shutil
from pathlib import Path

import pytest

import flexapod

pytestmark = pytest.mark.unit

PACKAGE = Path(flexapod.__file__).parent


def sources(package):
    """Hash that a copy of the package finds of itself."""
    spec = importlib.util.spec_from_file_location("copied_version", package / "common" / "version.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.sources()


@pytest.mark.parametrize(
    ("file", "counts"),
    [
        ("solve/time/march.py", True),
        ("solve/time/native/march.c", True),
        ("mechanics/elements/torsion.py", True),
        ("common/tables/base.py", True),
        ("model/presets/tripod.toml", True),
        ("analysis/simulation.py", True),
        ("app/cli/cli.py", False),
        ("verification/pack.py", False),
        ("output/figures/style.py", False),
        ("output/report/page.py", False),
        ("output/exchange/fmu.py", False),
    ],
)
def test_a_byte_more_changes_the_hash_where_numbers_come_from(tmp_path, file, counts):
    package = tmp_path / "flexapod"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    before = sources(package)
    with (package / file).open("ab") as there:
        there.write(b"\n")
    assert (sources(package) != before) is counts
