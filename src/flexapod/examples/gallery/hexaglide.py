"""
A hexaglide at rest
===================

Six carriages on upright rails push struts of fixed length. At rest the drives hold up all that moves: carriages, struts
and platform. So their forces add up to its weight, whatever the pose.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

STUDY = """
[robot]
type = "6-PUS"
base = { radius = "350 mm", half_angle = "10 deg" }
platform = { radius = "150 mm", half_angle = "10 deg" }
home_height = "0.95 m"

[payload]
mass = "30 kg"
inertia = [0.5, 0.5, 0.8]
com = [0, 0, "60 mm"]

[leg]
carriage = { slider = [0, 0, 1], mass = "3 kg", stroke = { min = 0, max = "0.6 m" }, side = -1 }
strut = { length = "0.7 m", diameter = "20 mm", inner_diameter = "16 mm", material = "cfrp" }

[motion]
type = "combined"
amplitudes = { sway = "60 mm", heave = "80 mm", yaw = "6 deg" }
duration = "0.6 s"
hold = "0.4 s"
"""

study = fx.loads(STUDY)
data = fx.inverse_dynamics(study)
force = data.drive_force_rigid
piston = study.robot.legs[0].piston
weight = 9.81 * (30 + 6 * 3 + 6 * piston.rhoA * 0.7)
print(f"at rest the drives push with {float(force[-1].sum()):.6f} N, by hand {weight:.6f} N")

np.testing.assert_allclose(force[-1].sum(), weight, rtol=1e-9)

figure, axes = plt.subplots()
axes.plot(data.time, force)
axes.axhline(weight / 6, color="k", lw=0.5)
axes.set(xlabel="time [s]", ylabel="force of a drive [N]", title="A hexaglide: the thin line is a sixth of its weight")
