"""Measured responses: universal files as other programs write them, CSV, MATLAB; what is written is read again."""

import numpy as np
import pytest
from scipy.io import savemat
from tests.helpers.texts import UNIVERSAL

import flexapod as fx
import flexapod.control as fc
from flexapod.common.errors import InputError
from flexapod.output.exchange.formats import uff

pytestmark = pytest.mark.unit

HZ = np.array([1.0, 2.5, 7.0, 11.0])


def mode():
    return fc.StateSpace(
        A=[[0, 1], [-900.0, -3.0]], B=[[0], [0.5]], C=[[1, 0], [0, 1]], D=[[0], [0]], inputs=("drive:3",),
        outputs=("tool:z", "geophone:tool:z"), states=("z", "v"),
        units={"drive:3": "N", "tool:z": "m", "geophone:tool:z": "m s-1"},
    )  # fmt: skip


def complex_values(data):
    return data.frequency_response.sel(part="real").values + 1j * data.frequency_response.sel(part="imaginary").values


@pytest.mark.parametrize(("hz", "digits"), [(HZ, 1e-5), (np.arange(1.0, 9.0), 1e-12)])
def test_what_is_written_as_universal_file_is_read_again(tmp_path, hz, digits):
    data = mode().frequency_response(hz)
    (tmp_path / "a.uff").write_text(uff(data), encoding="ascii")
    found = fx.read_frf(tmp_path / "a.uff")
    assert found.output.values.tolist() == list(mode().outputs) and found.input.values.tolist() == ["drive:3"]
    np.testing.assert_allclose(found.frequency, hz, rtol=digits)  # uneven ones have six digits
    np.testing.assert_allclose(complex_values(found), mode().at(hz), rtol=1e-11)
    assert found.output_units.values.tolist() == ["m", "m s-1"] and found.input_units.values.tolist() == ["N"]


#: As written by an analyser: single precision, six numbers in a line, even spacing, beside a dataset of another kind.
ANALYSER = """\
    -1
   151
something else
    -1
    -1
    58
FRF of the plate
NONE
01-Jan-20 12:00:00
NONE
NONE
    4         0    1         0 PLATE             12   3 HAMMER             7  -1
         5         4         1  1.00000E+00  5.00000E-01  0.00000E+00
        18    0    0    0 Frequency            Hz
        12    0    0    0 Acceleration         m/s^2
        13    0    0    0 Force                N
         0    0    0    0 NONE                 NONE
  1.00000E+00  2.00000E+00  3.00000E+00 -4.00000E+00-5.00000E+00  6.00000E+00
  7.00000E+00  8.00000E+00
    -1
"""


def test_a_file_of_an_analyser_is_read(tmp_path):
    (tmp_path / "plate.unv").write_text(ANALYSER)
    found = fx.read_frf(tmp_path / "plate.unv")
    assert found.output.item() == "PLATE 12:z" and found.input.item() == "HAMMER 7:-x"
    np.testing.assert_allclose(found.frequency, [1.0, 1.5, 2.0, 2.5])
    np.testing.assert_allclose(complex_values(found)[0, 0], [1 + 2j, 3 - 4j, -5 + 6j, 7 + 8j])
    assert found.output_units.item() == "m/s^2" and found.input_units.item() == "N"


def test_tables_are_read(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(
        "frequency [Hz],tool:z/drive:1 real,tool:z/drive:1 imag,magnitude [dB],phase [deg]\n1,2,3,20,90\n2,4,5,0,180\n"
    )
    found = fx.read_frf(path)
    assert found.output.values.tolist() == ["tool:z", "response 2"]
    values = complex_values(found)
    np.testing.assert_allclose(values[0, 0], [2 + 3j, 4 + 5j])
    np.testing.assert_allclose(values[1, 1], [10j, -1], atol=1e-14)
    assert np.isnan(values[0, 1]).all()  # not measured


def test_matlab_files_are_read(tmp_path):
    H = np.arange(12.0).reshape(2, 1, 6) * (1 + 2j)
    named = {"outputs": np.array(["a", "b"], dtype=object), "inputs": np.array(["u"], dtype=object)}
    savemat(tmp_path / "a.mat", {"f": np.arange(6.0), "H": H, **named})
    found = fx.read_frf(tmp_path / "a.mat")
    assert found.output.values.tolist() == ["a", "b"]
    np.testing.assert_allclose(complex_values(found), H)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.txt", "", r"Allowed: \.uff, \.unv"),
        ("a.uff", "nothing", "no frequency response"),
        ("a.uff", ANALYSER.replace("    58", "   58b"), "binary dataset 58"),
        ("a.uff", ANALYSER.replace("         5         4", "         5         9"), "has 4 of 9 values"),
        ("a.csv", "f,a,b,c\n1,2,3,4\n", "has 4 columns"),
        ("a.csv", "f,a,b\n1,2,x\n", "is no number"),
    ],
)
def test_other_files_are_refused(tmp_path, name, text, words):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=words):
        fx.read_frf(tmp_path / name)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        fx.read_frf(tmp_path / "none.uff")


def test_a_universal_file_that_is_cut_off_or_tells_a_wrong_count_is_refused(tmp_path):
    """The last number was read as far as it went; room for a billion values was asked for."""
    whole = uff(mode().frequency_response(np.arange(1.0, 9.0)))
    for text in (whole[:-10], whole[:-30], "\n".join(whole.split("\n")[:5])):
        (tmp_path / "a.uff").write_text(text)
        with pytest.raises(InputError, match="ends within a dataset 58"):
            fx.read_frf(tmp_path / "a.uff")
    for count in (0, -1, 9, 999_999_999):
        (tmp_path / "a.uff").write_text(whole.replace(f"{8:10d}", f"{count:10d}"))
        with pytest.raises(InputError, match=f"has . of {count} values"):
            fx.read_frf(tmp_path / "a.uff")


def test_ends_of_lines_of_all_systems_are_read(tmp_path):
    data = mode().frequency_response(np.arange(1.0, 9.0))
    for end in ("\r\n", "\r"):
        (tmp_path / "a.uff").write_bytes(uff(data).replace("\n", end).encode())
        np.testing.assert_allclose(complex_values(fx.read_frf(tmp_path / "a.uff")), complex_values(data), rtol=1e-11)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"f;a/b real;a/b imag\n1,5;1;2\n", "semicolons"),
        (b"f\ta/b real\ta/b imag\n1\t1\t2\n", "tabs"),
        (b"f,a/b real,a/b imag\n1,1,2\n2,1\n", "line 3: has 2 cells"),
        (b"f,a/b real,c/d imag\n1,1,2\n", "two columns of each response"),
        (b"f,a/b mag,a/b time\n1,1,2\n", "real, imag, or magnitude"),
        (b"f,a/b real,a/b imag\n1,inf,2\n", "infinite"),
        (b"omega [rad/s],a/b real,a/b imag\n1,1,2\n", "is not a frequency"),
        ("f,Größe/b real,Größe/b imag\n1,1,2\n".encode("latin-1"), "UTF-8"),
    ],
)
def test_tables_of_other_kinds_are_refused(tmp_path, content, words):
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(InputError, match=words) as error:
        fx.read_frf(tmp_path / "a.csv")
    assert error.value.file == str(tmp_path / "a.csv")


def test_units_of_frequencies_and_names_with_commas_count(tmp_path):
    head = 'f [kHz],"tool:z/force:(0,0,1):z real","tool:z/force:(0,0,1):z imag"'
    (tmp_path / "Ä b.csv").write_text(f"{head}\n2,1,-3\n", encoding="utf-8")
    found = fx.read_frf(tmp_path / "Ä b.csv")
    assert found.frequency.values.tolist() == [2000.0] and found.input.values.tolist() == ["force:(0,0,1):z"]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"frequency": [1.0, 2.0], "frf": np.ones((2, 1, 2)), "outputs": np.array(["a"], dtype=object)}, "has 1 names"),
        ({"frequency": "text", "frf": [1.0, 2.0]}, "no array of numbers"),
        ({"frequency": [], "frf": []}, "has no frequency"),
    ],
)
def test_matrices_that_do_not_fit_are_refused(tmp_path, given, words):
    savemat(tmp_path / "a.mat", given)
    with pytest.raises(InputError, match=words):
        fx.read_frf(tmp_path / "a.mat")


def test_another_version_of_matlab_is_told(tmp_path):
    head = b"MATLAB 7.3 MAT-file".ljust(116) + b"\0" * 8 + b"\x00\x02IM"
    (tmp_path / "a.mat").write_bytes(head + b"\x89HDF" + b"\0" * 500)
    with pytest.raises(InputError, match=r"MATLAB 7\.3") as error:
        fx.read_frf(tmp_path / "a.mat")
    assert "-v7" in (error.value.next_step or "")


UNEVEN, REAL = np.array([2.0, 3.5, 7.0]), np.array([-1.25, 2.5, -3.75])


def form(kind, even):
    """Its text: E13.5 of single numbers and of abscissas, E20.12 of double ones, as many in a line as it has."""
    wide = "{:20.12E}" if kind in (4, 6) else "{:13.5E}"
    numbers = []
    for f, x in zip(UNEVEN, REAL, strict=True):
        parts = [] if even else [f"{f:13.5E}"]
        numbers.append("".join([*parts, wide.format(x), *([wide.format(2 * x)] if kind in (5, 6) else [])]))
    per_line = {(2, True): 6, (2, False): 3, (4, True): 4, (4, False): 2, (5, True): 3, (5, False): 2, (6, True): 2,
                (6, False): 1}[kind, even]  # fmt: skip
    rows = ["".join(numbers[k : k + per_line]) for k in range(0, 3, per_line)]
    return UNIVERSAL.format(title="NONE", kind=kind, count=3, even=int(even), start=2.0 if even else 0.0,
                       step=0.25 if even else 0.0, zero=0.0, top="m", bottom="N", rows="\n".join(rows))  # fmt: skip


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("kind", [2, 4, 5, 6])
def test_numbers_of_all_forms_are_read(tmp_path, kind, even):
    (tmp_path / "a.58").write_text(form(kind, even))
    found = fx.read_frf(tmp_path / "a.58")
    assert found.output.item() == "node 4:-y" and found.input.item() == "node 1"
    np.testing.assert_allclose(found.frequency, [2.0, 2.25, 2.5] if even else UNEVEN)
    np.testing.assert_allclose(complex_values(found)[0, 0], REAL * (1 + 2j if kind in (5, 6) else 1))
    assert found.output_units.item() == "m" and found.input_units.item() == "N"


def test_phases_in_radians_and_matrices_of_one_input(tmp_path):
    from scipy.io import savemat

    (tmp_path / "a.csv").write_text(f"f,a/u magnitude,a/u phase [rad]\n1,2,{np.pi / 2!r}\n2,3,{np.pi!r}\n")
    np.testing.assert_allclose(complex_values(fx.read_frf(tmp_path / "a.csv"))[0, 0], [2j, -3], atol=1e-14)
    H = np.arange(12.0).reshape(3, 4) * (1 - 1j)
    units = {"output_units": np.array(["m", "rad", "V"], dtype=object), "input_units": np.array(["N"], dtype=object)}
    savemat(tmp_path / "a.mat", {"frequency": np.arange(4.0), "frf": H, **units})
    found = fx.read_frf(tmp_path / "a.mat")
    np.testing.assert_allclose(complex_values(found)[:, 0], H)
    assert found.output_units.values.tolist() == ["m", "rad", "V"] and found.input_units.item() == "N"


def test_axes_say_what_is_measured(tmp_path):
    """Data types of the format: 8 displacement, 11 velocity, 12 acceleration, 9 reaction, 13 excitation force."""
    units = {
        "tool:z": "m",
        "geophone:tool:z": "m/s",
        "accelerometer:tool:z": "m/s^2",
        "drive-force:1": "N",
        "tool:rx": "rad",
    }
    kinds = {"m": 8, "m/s": 11, "m/s^2": 12, "N": 9, "rad": 1}
    one = fc.StateSpace(
        A=[[-1.0]], B=[[1.0, 0.0]], C=np.ones((5, 1)), D=np.zeros((5, 2)), inputs=("force:tool:z", "floor:z"),
        outputs=tuple(units), states=("x",), units=units | {"force:tool:z": "N", "floor:z": "m/s^2"},
    )  # fmt: skip
    lines = uff(one.frequency_response([1.0, 2.0])).splitlines()
    starts = [k + 1 for k, line in enumerate(lines) if line == "    58"]
    assert len(starts) == 10
    for at in starts:
        output, into = lines[at].split(" / ")
        top, bottom = lines[at + 8], lines[at + 9]
        assert (int(top[:10]), top[47:67].strip()) == (kinds[units[output]], units[output])
        assert int(bottom[:10]) == (13 if into.startswith("force") else 12)
    (tmp_path / "a.uff").write_text("\n".join(lines), encoding="ascii")
    found = fx.read_frf(tmp_path / "a.uff")  # labels of twenty characters stand before units
    assert found.output_units.values.tolist() == list(units.values())[:5]
