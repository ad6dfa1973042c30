"""The robot as a unit in another program: FMPy runs it beside a controller of its own, as any master would."""

from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
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
beside = np.abs(np.asarray(found["tool_position"]) - ours.tool_position.values)
moved = np.abs(np.diff(ours.tool_deviation.values, axis=0)).max()  # in a step: what a master gives acts from a step on
lifted = 1e6 * np.ptp(ours.tool_deviation.values[:, 2])
print(f"{len(beside)} instants in FMPy; the push lifts the tool by {lifted:.1f} um")
print(f"up to the push within 1e-11 m of fx.simulate: {beside[np.asarray(found['time']) < 0.02].max() < 1e-11}")
print(f"after it within what the push moves in a step: {beside.max() < moved}")
