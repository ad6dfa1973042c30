"""The table [control] of a study file."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.errors import InputError
from flexapod.model import preset_text
from flexapod.model.study import to_toml
from flexapod.surveys.sweeps.plan import read_plan
from flexapod.surveys.sweeps.points import Points
from flexapod.symbolic.compiler import compiler

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


def study(table, preset="nano-hexapod"):
    return fx.loads(preset_text(preset) + table)


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


@pytest.mark.parametrize(
    ("table", "preset", "words"),
    [
        (IFF, "paper-robot", "keeps its command whatever the force"),
        (IFF.replace("iff", "lqr"), "nano-hexapod", "Allowed: iff, dvf"),
        (IFF.replace("gain = 200", "gain = -1"), "nano-hexapod", "control.gain"),
        (IFF.replace('sample = "0.1 ms"', ""), "nano-hexapod", "sample"),
        (DVF + "high_pass = 1\n", "nano-hexapod", "high_pass"),
    ],
)
def test_refusals(table, preset, words):
    with pytest.raises(InputError, match=words):
        study(table, preset)


def test_keys_of_the_table_are_those_of_sweeps():
    sweep = read_plan({"vary": [{"key": "control.gain", "values": [100.0, 300.0]}]})
    found = Points(study(IFF), sweep)
    assert [found.study(k).control.gain for k in (0, 1)] == [100.0, 300.0]
