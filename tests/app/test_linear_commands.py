"""`frf` and `damp` as a user types them: words, files, JSON, refusals."""

import json

import numpy as np
import pytest
from scipy.io import loadmat
from tests.helpers.samples import MECHANISMS
from tests.helpers.short_runs import BRIEF

import flexapod as fx

pytestmark = pytest.mark.cli


def test_responses_are_said_written_and_read_again(flexapod, study, folder):
    path = study(*BRIEF)
    arguments = ("frf", path, "--input", "wrench:fz,floor:z", "--output", "tool:z", "--from", "5Hz", "--to", "500Hz")
    said = flexapod(*arguments, "--points", "50", "--out", "found", "--uff", "a.uff", "--mat", "a.mat")
    assert said.exit_code == 0, said.stderr
    assert "About the static equilibrium at home" in said.stdout and "5 to 500 Hz, 50 frequencies" in said.stdout
    assert {file.name for file in (folder / "found").iterdir()} == {"frf.nc", "frf.png"}
    model = fx.linearize(fx.load(path), inputs=["wrench:fz", "floor:z"], outputs="tool:z")
    hz = np.geomspace(5, 500, 50)
    exact = model.at(hz)
    told = json.loads(flexapod(*arguments, "--points", "50", "--json").stdout)
    assert [one["input"] for one in told["responses"]] == ["wrench:fz", "floor:z"]
    np.testing.assert_allclose(told["responses"][1]["real"], exact[0, 1].real, rtol=1e-9)
    measured = fx.read_frf(folder / "a.uff").frequency_response
    assert measured.sel(part="real").values == pytest.approx(exact.real, rel=1e-9)
    np.testing.assert_array_equal(loadmat(folder / "a.mat")["A"], model.A)
    again = flexapod(*arguments, "--mat", "a.mat")
    assert again.exit_code == 2 and "--force" in again.stderr


def test_poles_are_listed_as_modes_are(flexapod, study):
    path = study(*BRIEF)
    poles = json.loads(flexapod("damp", path, "--json").stdout)["poles"]
    modes = json.loads(flexapod("modes", path, "--json").stdout)["modes"]
    lowest = [mode["frequency"] for mode in modes[:6]]
    found = [pole["frequency"] for pole in poles if pole["imaginary"] > 0][:6]
    np.testing.assert_allclose(found, lowest, rtol=1e-3)  # size of a damped pole: 1e-9 but for coupled damping
    said = flexapod("damp", path, "--count", "3")
    assert said.exit_code == 0, said.stderr
    assert "damping [%]" in said.stdout and "The slowest 3 of" in said.stdout


def test_poles_that_grow_are_warned_of(flexapod, study):
    said = flexapod("damp", study(*BRIEF), "--drives", "force")
    assert said.exit_code == 0, said.stderr
    assert "drives released" in said.stdout and "poles grow: at" in said.stdout.replace("\n", " ")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("frf", "--input", "wrenc"), "Did you mean 'wrench'?"),
        (("frf", "--from", "10Hz", "--to", "1Hz"), "0 < --from < --to"),
        (("frf", "--mat", "a.txt"), "FILE.mat"),
        (("frf", "--to", "1e300 Hz"), "beyond every machine"),
        (("frf", "--from", "1e-300 Hz"), "beyond every machine"),
        (("damp", "--drives", "held"), '"given", "force"'),
        (("damp", "--friction", "none"), "sliding, stuck"),
    ],
)
def test_wrong_arguments_are_refused(flexapod, study, arguments, words):
    said = flexapod(arguments[0], study(*BRIEF), *arguments[1:])
    assert said.exit_code == 2
    assert words in said.stderr.replace("\n", " ")


def test_check_says_what_a_controller_leaves_of_static_stiffness(flexapod, folder):
    file = folder / "nano.toml"
    text = fx.model.preset_text("nano-hexapod")
    file.write_text(text + '[control]\nlaw = "iff"\ngain = 200\nsample = "0.1 ms"\nhigh_pass = 5\n')
    found = flexapod("check", file)
    assert found.exit_code == 0, found.stderr
    assert "Controller" in found.stdout and "without the controller" in found.stdout
    assert len(json.loads(flexapod("check", file, "--json").stdout)["control"]) == 1
    file.write_text(text)
    assert "control" not in json.loads(flexapod("check", file, "--json").stdout)


def test_check_says_that_a_loop_is_not_stable(flexapod, folder):
    """Its static stiffness is not said, as nothing comes to rest; the march leaves its model after 54 ms."""
    file = folder / "nano.toml"
    gains = 'proportional = "0.2 N/um"\nintegral = "5e6 N/(m s)"\nderivative = "200 N s/m"'
    file.write_text(fx.model.preset_text("nano-hexapod") + f'[control]\nlaw = "pid"\n{gains}\nsample = "0.1 ms"\n')
    found = flexapod("check", file)
    assert found.exit_code == 0, found.stderr
    assert "The loop is not stable: 16 of its poles grow" in " ".join(found.stdout.split())
    assert "static stiffness of the tool" not in found.stdout


def test_a_robot_whose_platform_is_fixed_has_poles_too(flexapod):
    """It once was told that --input, which the command has not, has no meaning."""
    said = flexapod("damp", MECHANISMS / "strut.toml", "--count", "2")
    assert said.exit_code == 0, said.stderr
    assert "The slowest 2 of" in said.stdout
