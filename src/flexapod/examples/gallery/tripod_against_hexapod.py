"""
A tripod against a hexapod
==========================

The same pistons, three on hinges or six between ideal joints. Sideways nothing but bending holds a tripod. In closed
form its side stiffness, platform held level, is $k_x = 3/2 (k c^2 + k_b)$ with $k = EA / L$ along a
leg that leans inwards by $c$, and $k_b = 3 EI / s^3$ across it, $s$ its free length.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

hexapod, tripod = fx.preset("paper-robot-radii"), fx.preset("tripod")
stiffness = {
    name: np.diag(fx.stiffness(study, load=np.zeros(6)).stiffness.values)[:3]
    for name, study in (("hexapod", hexapod), ("tripod", tripod))
}
for name, k in stiffness.items():
    print(name, "x {:.2f}, y {:.2f}, z {:.0f} N/um".format(*(1e-6 * k)))

leg, robot = tripod.robot.legs[0], tripod.robot
joint = robot.platform_joints[0] + robot.home.position - robot.base_joints[0]
length = np.linalg.norm(joint)
inwards = np.linalg.norm(joint[:2]) / length
k, kb = leg.piston.EA / leg.piston.length, 3 * leg.piston.EI / (length - leg.cylinder.mouth) ** 3
by_hand = 1.5 * (k * inwards**2 + kb)

# The payload's weight turns a leg's stiffness by its force over its length, 1e-4 of what bending gives.
np.testing.assert_allclose(stiffness["tripod"][0], by_hand, rtol=1e-3)

figure, axes = plt.subplots()
places = np.arange(3)
for i, (name, values) in enumerate(stiffness.items()):
    axes.bar(places + 0.4 * i - 0.2, 1e-6 * values, 0.4, label=name)
axes.set(yscale="log", ylabel="stiffness [N/um]", title="Six pistons, or three on hinges")
axes.set_xticks(places, ["x", "y", "z"])
axes.legend()
