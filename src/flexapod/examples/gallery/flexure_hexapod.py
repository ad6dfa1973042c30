"""
A hexapod on flexures
=====================

No joint slides: each is a body of steel that bends, for motions of micrometres. Along the axis legs and drives in
series hold the platform, $K_z = 6 k (h / l)^2$, and what the flexures add by bending is small.
"""

import numpy as np

import flexapod as fx

STUDY = """
[robot]
type = "6-FPF"
base = { radius = "120 mm", half_angle = "20 deg" }
platform = { radius = "110 mm", half_angle = "20 deg" }
home_height = "100 mm"

[payload]
mass = "10 kg"
inertia = [0.06, 0.06, 0.1]
com = [0, 0, "30 mm"]

[leg]
base_joint = { bending = "15 N m/rad", torsion = "20 N m/rad" }
platform_joint = { bending = "15 N m/rad", torsion = "20 N m/rad" }
cylinder = { mass = "0.2 kg", com = "25 mm", inertia = 5e-5, mouth = "50 mm" }
piston = { diameter = "6 mm", length = "70 mm", E = "200 GPa", density = "7800 kg/m^3" }
stroke = { min = "108 mm", max = "109 mm" }
damping = 0.01
drive = { type = "servo", stiffness = "2 N/um", damping = "400 N s/m" }   # of the piezo stack that moves the piston

[motion]
type = "combined"
amplitudes = { surge = "20 um", heave = "30 um" }
duration = "50 ms"
hold = "50 ms"

[simulation]
output_step = "0.1 ms"
"""

study = fx.loads(STUDY)
found = float(fx.stiffness(study, load=np.zeros(6)).stiffness.sel(wrench="Fz", component="z"))
robot = study.robot
leg = robot.platform_joints[0] + robot.home.position - robot.base_joints[0]
length = np.linalg.norm(leg)
k = 1 / (1 / 2e6 + 0.07 / (200e9 * np.pi / 4 * 0.006**2))
by_hand = 6 * k * (leg[2] / length) ** 2
print(f"K_z {1e-6 * found:.3f} N/um, by hand without what the flexures hold {1e-6 * by_hand:.3f} N/um")

# Two flexures of 15 N m/rad turn as the leg tilts by sin / l: 6 * 30 / l^2 * sin^2 = 2.4 kN/m, 2.4e-4 of K_z.
np.testing.assert_allclose(found, by_hand, rtol=5e-4)

figure = fx.plot.com_path(fx.simulate(study), axes=("x", "z"))
