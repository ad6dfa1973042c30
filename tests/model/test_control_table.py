"""The table [control] of a study file."""

import json
import re

import numpy as np
import pytest
import scipy.io

import flexapod as fx
from flexapod.analysis.controller_settings import sampled_controller
from flexapod.common.errors import InputError
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points
from flexapod.mechanics.symbolic.compiler import compiler
from flexapod.model import preset_text
from flexapod.model.study.study import to_toml

pytestmark = pytest.mark.unit

DRIVES = [f"drive:{i}" for i in range(1, 7)]
IFF = """
[control]
law = "iff"
gain = 200
high_pass = "5 Hz"
sample = "0.1 ms"
delay_samples = 1
quantise = "1 mN"
noise = "0.5 mN"
saturate = "2 N"
seed = 4
"""
DVF = '[control]\nlaw = "dvf"\ngain = "30 N s/m"\nlow_pass = "2 kHz"\nsample = "0.1 ms"\n'
PID = """
[control]
law = "pid"
proportional = "0.2 N/um"
integral = "2 kN/(m s)"
derivative = "30 N s/m"
low_pass = "2 kHz"
sample = "0.1 ms"
noise = "1 nm"
"""
TOOL = """
[control]
law = "tool-pid"
proportional = ["0.2 N/um", "0.2 N/um", "0.9 N/um", 500, 500, 200]
derivative = [30, 30, 120, "0.05 N m s/rad", 0.05, 0.02]
sample = "0.1 ms"
noise = [1e-9, 1e-9, 1e-9, "1 urad", 0, 0]
seed = 2
"""
FILE = '[control]\nlaw = "file"\nfile = "law.json"\nsample = "0.1 ms"\nsaturate = "1 N"\n'
# A leak of 30 1/s and a gain of 200 1/s on leg 2 alone, in continuous time
LAW = {"A": [[-30.0]], "B": [[1.0]], "C": [[-200.0]], "D": [[0.0]],
       "inputs": ["force-sensor:drive:2"], "outputs": ["drive:2"], "sample": 0}  # fmt: skip


def study(table, preset="nano-hexapod", folder=None):
    return fx.loads(preset_text(preset) + table, path=None if folder is None else folder / "study.toml")


def own(folder, **changes):
    """A study with a law in a file, whose text no function of ours wrote."""
    (folder / "law.json").write_text(json.dumps(LAW | changes))
    return study(FILE, folder=folder)


@pytest.mark.parametrize("table", [IFF.replace("gain = 200", "gain = 30"), PID, TOOL])
def test_more_tables_are_written_and_read_again(table):
    found = study(table)
    again = fx.loads(to_toml(found.replace(control=found.control.replace(delay_samples=3))))
    assert again.control == found.control.replace(delay_samples=3)


@pytest.mark.parametrize("table", [IFF, DVF])
def test_a_table_is_written_and_read_again(table):
    found = study(table)
    again = fx.loads(to_toml(found.replace(control=found.control.replace(gain=31.0))))
    assert again.control == found.control.replace(gain=31.0)


@pytest.mark.skipif(compiler() is None, reason="there is no C compiler")
@pytest.mark.parametrize(
    ("table", "controller", "settings"),
    [
        (IFF, fx.control.IFF(200.0, high_pass=5.0),
         {"delay_samples": 1, "quantise": 1e-3, "noise": 5e-4, "saturate": 2.0, "seed": 4}),
        (DVF, fx.control.DVF(30.0, low_pass=2e3), {}),
        (PID, fx.control.PID(2e5, 2e3, 30.0, low_pass=2e3), {"noise": 1e-9}),
    ],
)  # fmt: skip
def test_a_table_is_the_controller_of_a_call(table, controller, settings):
    short = {"step": 1e-4, "duration": 0.01}
    given = fx.simulate(fx.preset("nano-hexapod"), controller=controller, sample="10 kHz", **settings, **short)
    found = fx.simulate(study(table), **short)
    np.testing.assert_array_equal(found.control_input.values, given.control_input.values)
    np.testing.assert_array_equal(found.tool_position.values, given.tool_position.values)
    assert found.control_input.values.any()


@pytest.mark.skipif(compiler() is None, reason="there is no C compiler")
def test_settings_of_a_call_stand_in_place_of_those_of_the_table():
    short = {"step": 1e-4, "duration": 0.01}
    limited = fx.simulate(study(IFF), saturate=1e-3, **short)
    assert np.abs(limited.control_input.values).max() == 1e-3


def test_keys_of_the_table_are_those_of_sweeps():
    sweep = read_plan({"vary": [{"key": "control.gain", "values": [100.0, 300.0]}]})
    found = Points(study(IFF), sweep)
    assert [found.study(k).control.gain for k in (0, 1)] == [100.0, 300.0]


def test_feedback_of_the_tool_is_for_six_drives():
    tripod = fx.preset("tripod")
    legs = [leg.replace(drive=fx.model.ServoDrive(stiffness=1e7)) for leg in tripod.robot.legs]
    tripod = tripod.replace(robot=tripod.robot.replace(legs=tuple(legs)))
    with pytest.raises(InputError, match=r"control.law = 'tool-pid'.* six drives or more"):
        tripod.replace(control=study(TOOL).control)


def test_feedback_of_the_tool_asks_for_forces_that_make_its_wrench():
    """Virtual work with slopes of distances between joints, by differences over 1 um and 1 urad: their second order is
    1e-5 of legs of 95 mm, of the largest entry of a row."""
    robot, step = fx.preset("nano-hexapod").robot, 1e-6

    def lengths(motion):
        arm = robot.platform_joints - robot.tool
        heads = robot.platform_joints + np.array([0, 0, robot.home_height]) + motion[:3] + np.cross(motion[3:], arm)
        return np.linalg.norm(heads - robot.base_joints, axis=1)

    jacobian = np.stack([(lengths(step * axis) - lengths(-step * axis)) / (2 * step) for axis in np.eye(6)], axis=1)
    law = sampled_controller(study(TOOL))
    rates = [30, 30, 120, 0.05, 0.05, 0.02]
    wanted = -np.diag(np.array([0.2e6, 0.2e6, 0.9e6, 500, 500, 200]) + np.array(rates) / 1e-4)
    size = np.sqrt(np.abs(np.diag(wanted)))
    np.testing.assert_allclose(jacobian.T @ law.D / np.outer(size, size), -np.eye(6), atol=1e-5)
    assert law.readings == tuple(f"tool:{name}" for name in ("x", "y", "z", "rx", "ry", "rz"))
    np.testing.assert_array_equal(law.sigma, [1e-9, 1e-9, 1e-9, 1e-6, 0, 0])


@pytest.mark.parametrize("ending", ["json", "npz", "mat"])
def test_a_law_in_a_file_of_any_kind_is_the_same(tmp_path, ending):
    """Held between samples exactly: a = exp(-30 T), b = (1 - a) / 30."""
    found = own(tmp_path)
    if ending == "npz":
        np.savez(tmp_path / "law.npz", **LAW)
    if ending == "mat":  # as MATLAB writes cells of names
        cells = {name: np.array(LAW[name], dtype=object) for name in ("inputs", "outputs")}
        scipy.io.savemat(tmp_path / "law.mat", LAW | cells)
    found = study(FILE.replace("json", ending), folder=tmp_path)
    law, a = sampled_controller(found), np.exp(-30e-4)
    np.testing.assert_allclose([law.A.item(), law.B.item()], [a, (1 - a) / 30], rtol=1e-12)
    assert (law.C.item(), law.readings, law.outputs) == (-200.0, ("force-sensor:drive:2",), ("drive:2",))
    assert law.most.tolist() == [1.0]


@pytest.mark.parametrize("ending", ["json", "npz", "mat"])
def test_a_law_that_was_saved_is_read(tmp_path, ending):
    law = fx.control.IFF(200.0, high_pass=5.0).on([f"force-sensor:drive:{i}" for i in range(1, 7)], DRIVES)
    law.sampled(1e-4).save(tmp_path / f"law.{ending}")
    found = sampled_controller(study(FILE.replace("json", ending), folder=tmp_path))
    for name in "ABCD":
        np.testing.assert_array_equal(getattr(found, name), getattr(law.sampled(1e-4), name))
    assert found.readings == law.inputs and found.outputs == law.outputs


def test_a_law_without_states_is_read(tmp_path):
    found = own(tmp_path, A=[], B=[], C=[[]], D=[[-3.0]])
    assert sampled_controller(found).D.tolist() == [[-3.0]]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"B": [[1.0, 2.0]]}, r"law.json: B: has the shape \(1, 2\). Allowed: \(1, 1\)"),
        ({"A": [[1.0, 2.0]]}, r"law.json: A: has the shape \(1, 2\)"),
        ({"C": [["a"]]}, "C: is no matrix of finite numbers"),
        ({"D": [[float("nan")]]}, "D: is no matrix of finite numbers"),
        ({"inputs": []}, "inputs = '': are none"),
        ({"sample": 2e-4}, "control.sample.* is not the time between samples of the law.* Allowed: 0.0002 s"),
        ({"sample": -1}, "law.json: sample: is not a time"),
    ],
)
def test_refusals_of_laws_in_files(tmp_path, changes, words):
    with pytest.raises(InputError, match=words):
        own(tmp_path, **changes)


def test_the_limit_of_drives_is_for_laws_that_move_drives(tmp_path):
    with pytest.raises(InputError, match=r"control.saturate = 1.0: .* the law in the file moves none.*: command:2"):
        sampled_controller(own(tmp_path, outputs=["command:2"]))


def test_a_period_off_the_fixed_steps_is_refused_where_it_is_given(tmp_path):
    """In the table by its file and key; of a call by its argument."""
    fixed = DVF.replace("0.1 ms", "0.13 ms")
    file = tmp_path / "study.toml"
    text = re.sub(r"(?m)^tolerance = .*$", 'step = "0.1 ms"', preset_text("nano-hexapod")) + fixed
    file.write_text(text)
    with pytest.raises(InputError, match=r"study.toml: control.sample = '0.00013 s': is no multiple of the fixed step"):
        fx.simulate(file)
    with pytest.raises(InputError, match=r"sample = '0.00017 s': is no multiple") as error:
        fx.simulate(file, sample=1.7e-4)
    assert error.value.key == "sample"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"inputs": ["force-sensr:drive:2"]},
            "law.json: inputs = 'force-sensr:drive:2'.*Did you mean 'force-sensor:drive'",
        ),
        ({"outputs": ["drive:7"]}, "law.json: outputs = 'drive:7'.* drive:1 to drive:6"),
    ],
)
def test_channels_that_the_robot_has_not_are_refused_before_anything_is_computed(tmp_path, changes, words):
    with pytest.raises(InputError, match=words):
        fx.simulate(own(tmp_path, **changes))


def test_a_damaged_file_is_refused(tmp_path):
    for ending in ("json", "npz", "mat"):
        (tmp_path / f"law.{ending}").write_bytes(b"\x00 no law")
        with pytest.raises(InputError, match=r"control.file.*cannot be read"):
            study(FILE.replace("json", ending), folder=tmp_path)


def test_gains_of_each_axis_are_keys_of_sweeps(tmp_path):
    found = Points(study(TOOL), read_plan({"vary": [{"key": "control.proportional[3]", "values": [1e5, 3e5]}]}))
    assert [found.study(k).control.proportional[2] for k in (0, 1)] == [1e5, 3e5]
    other = tmp_path / "other.json"
    other.write_text(json.dumps(LAW | {"C": [[-100.0]]}))
    files = Points(own(tmp_path), read_plan({"vary": [{"key": "control.file", "values": ["law.json", "other.json"]}]}))
    assert [files.study(k).control.C.item() for k in (0, 1)] == [-200.0, -100.0]
