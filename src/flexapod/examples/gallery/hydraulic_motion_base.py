"""
A hydraulic motion base
=======================

Nine tons on six cylinders. With valves closed a cylinder is a spring of oil on either side of its piston:
$k = B (A_1^2 / V_1 + A_2^2 / V_2)$, and softer than all steel around it.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

study = fx.preset("motion-base")
heave = np.linspace(-0.3, 0.3, 13)
found = [float(fx.parts(study, {"heave": h}).part_stiffness.sel(leg=1, part="oil")) for h in heave]

robot = study.robot
B, bore, rod, whole, bottom = 1.4e9, 0.1, 0.07, 1.25, 0.5
dead = 0.5e-3, 0.9e-3
A1, A2 = np.pi / 4 * bore**2, np.pi / 4 * (bore**2 - rod**2)
foot = robot.platform_joints[0] - robot.base_joints[0]
length = np.sqrt(foot[0] ** 2 + foot[1] ** 2 + (robot.home.position[2] + heave) ** 2)
way = length - study.robot.legs[0].piston.length - bottom
by_hand = B * (A1**2 / (A1 * way + dead[0]) + A2**2 / (A2 * (whole - way) + dead[1]))
print(f"at home {1e-6 * found[6]:.2f} N/um, by hand {1e-6 * by_hand[6]:.2f} N/um")

np.testing.assert_allclose(found, by_hand, rtol=1e-6)

figure, axes = plt.subplots()
axes.plot(1e3 * heave, 1e-6 * by_hand, label=r"$B (A_1^2 / V_1 + A_2^2 / V_2)$")
axes.plot(1e3 * heave, 1e-6 * np.array(found), "o", label="flexapod")
axes.set(xlabel="heave [mm]", ylabel="stiffness of the oil in a leg [N/um]", title="A cylinder with closed valves")
axes.legend()
