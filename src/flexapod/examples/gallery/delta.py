r"""
A linear delta
==============

Three carriages on upright rails, struts between two universal joints with parallel axes: the platform moves along x, y
and z, and does not turn. Where the carriages are is Pythagoras: $z_i = z + \sqrt{L^2 - d_i^2}$.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

STUDY = """
[robot]
type = "3-PUU"
base = { radius = "250 mm", angles = [0, "120 deg", "240 deg"] }
platform = { radius = "50 mm", angles = [0, "120 deg", "240 deg"] }
home_height = "0.15 m"

[payload]
mass = "0.8 kg"
inertia = [6e-4, 6e-4, 1e-3]
com = [0, 0, "-10 mm"]
tool = [0, 0, 0]

[leg]
carriage = { slider = "vertical", mass = "0.8 kg", stroke = { min = "0.3 m", max = "0.75 m" }, side = 1 }
base_joint = { axis = "tangential" }
strut = { length = "0.4 m", diameter = "10 mm", inner_diameter = "8 mm", material = "cfrp" }

[motion]
type = "combined"
amplitudes = { surge = "60 mm", heave = "40 mm" }
independent = ["surge", "sway", "heave"]
duration = "0.2 s"
"""

study = fx.loads(STUDY)
data = fx.inverse_kinematics(study)
angles = np.radians([0, 120, 240])
spread = 0.05 - 0.25  # joints of platform less those of the carriages
x, y, z = data.tool_position_rigid.values.T[:, :, None]
across = (x + spread * np.cos(angles)) ** 2 + (y + spread * np.sin(angles)) ** 2
by_hand = z + np.sqrt(0.4**2 - across)
print("carriages end at", (1e3 * data.drive_command.values[-1]).round(3), "mm, by hand", (1e3 * by_hand[-1]).round(3))

np.testing.assert_allclose(data.drive_command, by_hand, atol=1e-12)

figure, axes = plt.subplots()
for i in range(3):
    axes.plot(data.time, 1e3 * data.drive_command[:, i], ["-", "-", "--"][i], label=f"carriage {i + 1}")
axes.set(xlabel="time [s]", ylabel="place of the carriage [mm]", title="A linear delta: 60 mm across, 40 mm up")
axes.legend()
