"""Measured responses as tables, universal files and from MATLAB, beside the computed one."""

import json
from pathlib import Path

import numpy as np
import scipy.io

import flexapod as fx

Path("measured.csv").write_text("""frequency,tool:z/wrench:fz magnitude,tool:z/wrench:fz phase [deg]
20,4.1e-9,-0.6
40,4.3e-9,-1.0
60,4.8e-9,-2.1
80,5.4e-9,-5
""")
Path("parts.csv").write_text("""frequency [Hz],acc/hammer real,acc/hammer imag
10,1.0,-0.5
20,0.8,-0.7
""")
Path("decibel.csv").write_text("""f [Hz],tool:x/wrench:fx magnitude [dB],tool:x/wrench:fx phase [rad]
10,-160,-0.1
20,-162,-0.2
""")
scipy.io.savemat("measured.mat", {
    "frequency": np.array([20.0, 40.0]), "frf": np.array([[[4e-9 - 1e-11j, 4.2e-9 - 2e-11j]]]),
    "outputs": np.array(["tool:z"], dtype=object), "inputs": np.array(["wrench:fz"], dtype=object),
})  # fmt: skip
read = {name: fx.read_frf(name) for name in ("measured.csv", "parts.csv", "measured.mat", "stored/response.uff")}
try:
    read["decibel.csv"] = fx.read_frf("decibel.csv")
except fx.InputError:
    read["decibel.csv"] = None
measured = read["measured.csv"]
plant = fx.linearize("robot.toml", inputs="wrench:fz", outputs="tool:z")
computed = plant.frequency_response(measured.frequency)
figure = fx.plot.bode({"measured": measured, "computed": computed}, "wrench:fz", "tool:z")
refused = []
for text in ("frequency,tool:z/wrench:fz magnitude\n10,1\n", "frequency;a/b real;a/b imag\n1;2;3\n", ""):
    Path("bad.csv").write_text(text)
    try:
        fx.read_frf("bad.csv")
    except fx.InputError as error:
        refused.append(type(error).__name__)


def told(data):
    """Names, sizes and values."""
    if data is None:
        return None
    response = next(iter(data.data_vars.values()))
    return [list(data.data_vars), list(response.dims), response.output.values, response.input.values, response.values]


found = {
    "read": {name: told(data) for name, data in read.items()},
    "units": [str(measured.output_units.values[0]), str(measured.input_units.values[0])],
    "computed": told(computed)[-1],
    "legend": len(figure.axes[0].lines),
    "refused": refused,
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
