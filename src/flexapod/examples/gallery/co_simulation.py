"""
The robot as a unit in another program
======================================

FMPy (`pip install fmpy`) runs the exported robot, as any other master of FMI would, and pushes it on the way. Up to the
push the path is that of `fx.simulate`; after it both differ by no more than the push moves in a step.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

STEP, UNTIL = 2.5e-4, 0.1  # s
PUSH = (0.0, 0.0, 200.0, 0.0, 0.0, 0.0)  # N, from 20 ms on
study = fx.preset("paper-robot")

with TemporaryDirectory() as folder:
    unit = fx.export(study, "fmu", Path(folder) / "robot.fmu", commands="motion", step=STEP).path
    names = [("time", float), ("wrench", float, 6), ("control_input", float, 6)]
    none = (0.0,) * 6
    rows = [(0.0, none, none), (0.02, none, none), (0.02, PUSH, none), (UNTIL, PUSH, none)]
    pushes = np.array(rows, dtype=names)
    found = fmpy.simulate_fmu(
        str(unit), stop_time=UNTIL, step_size=STEP, output_interval=STEP, input=pushes, output=["tool_position"]
    )

load = fx.model.Load(wrench=fx.model.StepWrench(amplitude=np.array(PUSH), time=0.02))
ours = fx.simulate(study, load=load, step=STEP, output_step=STEP, duration=UNTIL)
place, before = np.asarray(found["tool_position"]), np.asarray(found["time"]) < 0.02
moved = np.abs(np.diff(ours.tool_deviation.values, axis=0)).max()
lifted = 1e6 * np.ptp(ours.tool_deviation.values[:, 2])
print(f"{len(place)} instants in FMPy; the push lifts the tool by {lifted:.1f} um")

# The same steps in vectors that are not as wide: rounding. What a master gives acts from a step on, so that after the
# push one program is ahead of the other by what it moves in a step.
np.testing.assert_allclose(place[before], ours.tool_position.values[before], rtol=0, atol=1e-11)
np.testing.assert_allclose(place, ours.tool_position.values, rtol=0, atol=moved)

figure, axes = plt.subplots()
axes.plot(1e3 * ours.time, 1e6 * (ours.tool_position[:, 2] - ours.tool_position_rigid[:, 2]), label="fx.simulate")
axes.plot(1e3 * found["time"], 1e6 * (place[:, 2] - ours.tool_position_rigid[:, 2]), "--", label="FMPy")
axes.set(xlabel="time [ms]", ylabel="tool beside its path, up [um]", title="Pushed by 200 N after 20 ms")
axes.legend()
