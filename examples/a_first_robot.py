"""How far does the payload of the paper's robot miss its path, and which part is to blame?"""

import numpy as np

import flexapod as fx

study = fx.preset("paper-robot")
data = fx.simulate(study.robot, study.motion, modes=3, step=5e-4, duration=1.5)

peak = np.abs(data.com_deviation).max("time") * 1e6
print(f"largest deviation of the centre of mass: x {peak[0]:.1f}, y {peak[1]:.1f}, z {peak[2]:.1f} um")

cause = np.abs(data.deviation_by_cause.sum("leg")).max("time").sel(axis="z") * 1e6
for name, value in zip(cause.cause.values, cause.values, strict=True):
    print(f"   {name:13s} {value:8.3f} um of z")

modes = fx.modes(study.robot)
print("lowest frequencies of the locked robot:", np.round(modes.frequency.values[:4], 1), "Hz")
