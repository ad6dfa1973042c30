"""Columns of measured responses in CSV: a name, a word, a unit; one response, 2 at 90 deg, in every form of it."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.common.errors import InputError

pytestmark = pytest.mark.unit

NAMES = ["tool:z/drive:1", "acc:1/impact:1", "feedback:1/shaker:1", "radial:1/hammer:1", "phase meter:2/image:1",
         "imag/real", "geophone:tool[2 Hz, 0.7, 28.8]:x/force:(0,0,1):z", "dB/rad", "a b/c d"]  # fmt: skip
#: Two columns and what they make of 0+2j, or of the number that is said, all by hand.
FORMS = [
    ("real", "0", "imag", "2", 2j),
    ("Re", "0", "Im", "2", 2j),
    ("Real Part", "0", "Imaginary Part", "2", 2j),
    ("real [um/N]", "0", "imag [um/N]", "2", 2e-6j),
    ("real (mm/N)", "0", "imag (mm/N)", "2", 2e-3j),
    ("magnitude", "2", "phase", "90", 2j),
    ("magnitude", "2", "phase [deg]", "90", 2j),
    ("mag", "2", "angle [rad]", "1.5707963267948966", 2j),
    ("Magnitude", "2", "Phase (rad)", "1.5707963267948966", 2j),
    ("magnitude", "2", "phase_rad", "1.5707963267948966", 2j),
    ("magnitude", "2", "phase [mrad]", "1570.7963267948966", 2j),
    ("magnitude", "2", "phase [grad]", "100", 2j),
    ("magnitude [mm/N]", "2", "phase [deg]", "90", 2e-3j),
    ("magnitude [dB]", "20", "phase [deg]", "90", 10j),
    ("mag_dB", "20", "phase_deg", "90", 10j),
    ("magnitude dB", "20", "phase deg", "90", 10j),
    ("magnitude [dB re 1 um/N]", "20", "phase [deg]", "90", 1e-5j),
    ("magnitude [dB re um/N]", "20", "phase [deg]", "90", 1e-5j),
    ("magnitude [dB re 1e-6 m/N]", "20", "phase [deg]", "90", 1e-5j),
    ("magnitude [mm/s/kN]", "2", "phase", "90", 2e-6j),
    ("magnitude [(m/s^2)/mV]", "2", "phase", "90", 2e3j),
    ("magnitude [mrad/(N m)]", "2", "phase", "90", 2e-3j),
]  # fmt: skip


def read(folder, text):
    (folder / "a.csv").write_text(text, encoding="utf-8")
    return fx.read_frf(folder / "a.csv")


def value(data):
    H = data.frequency_response
    return (H.sel(part="real", drop=True) + 1j * H.sel(part="imaginary", drop=True)).values


def columns(name, one, other):
    return f'"{name} {one}","{name} {other}"'


@pytest.mark.parametrize("name", NAMES)
def test_names_of_channels_decide_nothing(tmp_path, name):
    """Once looked for in the whole name: impact was an imaginary part, feedback decibels, radial radians."""
    for one, a, other, b, expected in FORMS:
        found = read(tmp_path, f"frequency [Hz],{columns(name, one, other)}\n5,{a},{b}\n")
        np.testing.assert_allclose(value(found)[0, 0], [expected], rtol=1e-15, atol=1e-15 * abs(expected))
        assert f"{found.output.item()}/{found.input.item()}" == name


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("um/N", ("m", "N")),
        ("(m/s^2)/N", ("m/s^2", "N")),
        ("m/s^2/N", ("m/s^2", "N")),
        ("mm/s/V", ("m/s", "V")),
        ("rad/(N m)", ("rad", "N m")),
        ("N/um", ("N", "m")),
        ("-", ("1", "1")),
        ("V", ("V", "1")),
    ],
)
def test_units_of_channels_are_kept(tmp_path, unit, expected):
    found = read(tmp_path, f"f,a/b real [{unit}],a/b imag [{unit}]\n1,1,2\n")
    assert (found.output_units.item(), found.input_units.item()) == expected


@pytest.mark.parametrize(
    ("first", "one", "other", "words"),
    [
        ("f", "a/b real [furlong/N]", "a/b imag [furlong/kg]", "one unit"),
        ("f", "a/b real [m/kg]", "a/b imag [m/kg]", "has a unit that is not known"),
        ("f", "a/b real [g/N]", "a/b imag [g/N]", "has a unit that is not known"),
        ("f", "a/b real [mm/N]", "a/b imag", "one unit"),
        ("f", "a/b magnitude [dB(A)]", "a/b phase", "not known"),
        ("f", "a/b magnitude [dB re 1 kg]", "a/b phase", "not known"),
        ("f", "a/b magnitude", "a/b phase [mm]", "is not an angle"),
        ("f", "a/b magnitude", "a/b phase [rad] extra", "no word"),
        ("f", "a/b magnitude", "a/b imag", "real, imag, or magnitude, phase"),
        ("f", "a/b real", "a/b phase", "real, imag, or magnitude, phase"),
        ("f", "a real", "b imag", "two columns of each response"),
        ("f", "a/impact:1", "a/impact:1 phase", "no word"),
        ("omega", "a/b real", "a/b imag", "is not a frequency"),
        ("time [s]", "a/b real", "a/b imag", "is not a frequency"),
        ("frequency [rad/s]", "a/b real", "a/b imag", "is not a frequency"),
        pytest.param("f", "real " + " " * 100_000 + "x", "a/b imag", "no word", id="long"),
    ],
)
def test_what_cannot_be_read_is_refused(tmp_path, first, one, other, words):
    with pytest.raises(InputError, match=words) as error:
        read(tmp_path, f'{first},"{one}","{other}"\n1,2,90\n')
    assert error.value.file == str(tmp_path / "a.csv")


def test_one_channel_has_one_unit(tmp_path):
    with pytest.raises(InputError, match="output a in m and in m/s"):
        read(tmp_path, "f,a/b real [m/N],a/b imag [m/N],a/c real [m/s/N],a/c imag [m/s/N]\n1,1,2,3,4\n")
    point = read(tmp_path, "f,1:z/1:z real [(m/s^2)/N],1:z/1:z imag [(m/s^2)/N]\n1,1,2\n")
    assert (point.output_units.item(), point.input_units.item()) == ("m/s^2", "N")


@pytest.mark.parametrize("given", [[2, 1], [1, 1], [-1, 1], [1, 2, 2], [3, 2, 1], [0, 1, 0.5]])
def test_frequencies_rise_from_0_on(tmp_path, given):
    from scipy.io import savemat
    from tests.helpers.texts import UNIVERSAL

    (tmp_path / "a.csv").write_text("f,a/b real,a/b imag\n" + "".join(f"{f},1,2\n" for f in given))
    savemat(tmp_path / "a.mat", {"frequency": np.array(given, dtype=float), "frf": np.ones(len(given), dtype=complex)})
    rows = "\n".join(f"{f:13.5E}{1:20.12E}{2:20.12E}" for f in given)
    (tmp_path / "a.uff").write_text(
        UNIVERSAL.format(title="NONE", kind=6, count=len(given), even=0, start=0.0, step=0.0, zero=0.0, top="m",
                         bottom="N", rows=rows)
    )  # fmt: skip
    for name in ("a.csv", "a.mat", "a.uff"):
        with pytest.raises(InputError, match=r"is below 0|is not above the one before it") as error:
            fx.read_frf(tmp_path / name)
        assert error.value.file == str(tmp_path / name) and (error.value.key or "").startswith("frequency ")


def test_a_frequency_of_0_is_one(tmp_path):
    assert read(tmp_path, "f,a/b real,a/b imag\n0,1,2\n1,3,4\n").frequency.values.tolist() == [0, 1]


def test_a_cell_that_is_no_text_names_the_file(tmp_path):
    with pytest.raises(InputError) as error:
        read(tmp_path, "f,a/b real,a/b imag\n1,2," + "9" * 200_000 + "\n")
    assert error.value.file == str(tmp_path / "a.csv")


def test_outputs_by_inputs_have_a_bound(tmp_path):
    """Each response with channels of its own asks for the square of their number, by so many frequencies."""
    n = 2500
    head = ",".join(f"{i}/{i} real,{i}/{i} imag" for i in range(n))
    rows = "".join(f"{k}" + ",1,2" * n + "\n" for k in range(4))
    with pytest.raises(InputError, match="has 2500 outputs by 2500 inputs"):
        read(tmp_path, f"f,{head}\n{rows}")


@pytest.mark.parametrize("unit", ["dB(A)", "dBm * Np", "dB V"])
def test_logarithmic_units_are_unknown_ones(unit):
    """The library of units fails on their products with errors of its own."""
    with pytest.raises(InputError):
        fx.model.loads(fx.model.preset_text("paper-robot").replace('"100 kg"', f'"100 {unit}"'))
