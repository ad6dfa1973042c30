"""Columns of numbers in the terminal: one unit, as many decimals for all."""

import re

import pytest

from flexapod.common.quantities import column, text

pytestmark = pytest.mark.unit


@pytest.mark.parametrize(
    ("values", "unit", "shown"),
    [
        ([4.33e-6, 1.929e-5], "m", ("µm", ["4.33", "19.29"])),
        ([0.0, 0.03948, 0.167], "m", ("mm", ["0.0", "39.5", "167.0"])),
        ([-725.89, 1158.1, 35.58], "N", ("kN", ["-0.726", "1.158", "0.036"])),
        ([5.6e5, 9.4e6], "N m/rad", ("MN m/rad", ["0.560", "9.400"])),
        ([0.0, 0.0], "m", ("m", ["0", "0"])),
        ([float("nan"), 2.0], "", ("", ["n/a", "2.000"])),
        ([12345.6, 1.0], "Hz", ("Hz", ["12346", "1"])),
        ([-1e-9, 1.0], "kg", ("kg", ["0.000", "1.000"])),
        ([float("nan")], "m", ("m", ["n/a"])),
        ([], "m", ("m", [])),
    ],
)
def test_one_unit_and_as_many_decimals(values, unit, shown):
    found = column(values, unit)
    assert (found[0], [word.replace("-0.000", "0.000") for word in found[1]]) == shown


def test_large_forces_and_stiffnesses_read_well():
    assert text(1.16e8, "N") == "116 MN"
    assert text(9.34e6, "N m/rad") == "9.34 MN m/rad"


def decimals(words):
    return {len(word.partition(".")[2]) for word in words if re.fullmatch(r"-?\d+(\.\d+)?", word)}


def test_tables_of_a_run_and_of_modes(capsys):
    """Peaks of 4.33 µm, 12 mm and 900 nm once stood in one column, each with a unit of its own."""
    from types import SimpleNamespace

    from flexapod.output.text.answers import axes_table
    from flexapod.output.text.terminal import print_items

    axes = [
        SimpleNamespace(axis=a, peak=peak, time=1.0, rms=peak / 3, excursion=0.1, per_cent=None)
        for a, peak in zip("xyz", (4.33e-6, 1.2e-5, 9e-7), strict=True)
    ]
    print_items([axes_table(SimpleNamespace(shown_axes=axes, point="tool"))])
    head, *lines = capsys.readouterr().out.splitlines()
    assert "peak [µm]" in head and "rms [µm]" in head and "rigid travel [mm]" in head
    rows = [line.split() for line in lines if line.strip()]
    for k in (1, 3, 4):
        assert len(decimals([row[k] for row in rows])) == 1
    assert [row[1] for row in rows] == ["4.33", "12.00", "0.90"]
