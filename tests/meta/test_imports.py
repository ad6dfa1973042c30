"""What importing flexapod costs, and that its public names lead somewhere."""

import subprocess
import sys

import pytest

import flexapod

HEAVY = ("casadi", "matplotlib", "netCDF4", "pint", "pydantic", "rich", "scipy", "typer", "xarray")


def python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def test_import_is_light():
    assert python(f"import sys, flexapod; print([m for m in {HEAVY} if m in sys.modules])") == "[]"


def test_reading_numbers_needs_no_pint():
    # The preset has texts with units; a study of plain SI numbers must not pay for pint.
    code = (
        "import sys, flexapod as fx; "
        "fx.loads('[actuator]\\nlength = 2\\nrhoA = 1\\nEI = 1\\nfree_length = 1\\n[simulation]\\nduration = 1'); "
        "print('pint' in sys.modules)"
    )
    assert python(code) == "False"


LAZY = [*flexapod._NAMES, *flexapod._PACKAGES]


@pytest.mark.parametrize("name", sorted({*flexapod.__all__, *LAZY} - {"__version__"}))
def test_public_names_resolve(name):
    assert getattr(flexapod, name) is not None
    assert name in dir(flexapod)


def test_version_is_that_of_the_distribution():
    from importlib.metadata import version

    assert flexapod.__version__ == version("flexapod")


def test_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="simulat_"):
        _ = flexapod.simulat_
