"""
Sag of a hexapod, by hand
=========================

Six equal legs that lean alike hold a weight on their axis with $K_z = 6 k (h / l)^2$, where $k = EA / L$
is the stiffness of a piston, $h$ the height and $l$ the length of a leg.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

STUDY = """
[robot]
type = "6-UPS"
base = { radius = "250 mm", half_angle = "10 deg" }
platform = { radius = "150 mm", half_angle = "10 deg" }
home_height = "0.9 m"

[payload]
mass = "60 kg"
inertia = [1.5, 1.5, 2.4]
com = [0, 0, "80 mm"]

[leg]
cylinder = { mass = "3 kg", com = "157.5 mm", inertia = 0.0248, mouth = "315 mm" }
piston = { diameter = "27 mm", length = "750 mm", E = "200 GPa", density = "7800 kg/m^3" }
stroke = { min = "760 mm", max = "1.02 m" }

[motion]
type = "heave"
amplitude = "20 mm"
duration = "1 s"
"""

H, L_PISTON, E = 0.9, 0.75, 200e9
angle = np.radians(60 - 2 * 10)  # between a joint of the base and the nearest one of the platform, seen from above
across = np.sqrt(0.25**2 + 0.15**2 - 2 * 0.25 * 0.15 * np.cos(angle))
length = np.hypot(across, H)

diameters = np.array([15, 20, 27, 35, 45])  # mm
found = []
for diameter in diameters:
    study = fx.loads(STUDY).with_values({"leg.piston.diameter": f"{diameter} mm"})
    found.append(float(fx.stiffness(study, fidelity="lumped").stiffness.sel(wrench="Fz", component="z")))
by_hand = 6 * E * np.pi / 4 * (1e-3 * diameters) ** 2 / L_PISTON * (H / length) ** 2
print(f"27 mm: {60 * 9.81 / found[2] * 1e6:.3f} um of sag, by hand {60 * 9.81 / by_hand[2] * 1e6:.3f} um")

# Left out: force over length, at most 200 N / 0.9 m beside 5e7 N/m, and sag over height, 2 um / 0.9 m, both times the
# lean of the legs, 1 - (h / l)^2 = 0.03: below 1e-6.
np.testing.assert_allclose(found, by_hand, rtol=1e-6)

figure, axes = plt.subplots()
axes.loglog(diameters, 60 * 9.81 / by_hand * 1e6, label="by hand")
axes.loglog(diameters, 60 * 9.81 / np.array(found) * 1e6, "o", label="flexapod")
axes.set(xlabel="diameter of the pistons [mm]", ylabel="sag [um]", title="Sag of 60 kg on six pistons")
axes.set_xticks(diameters, diameters)
axes.set_yticks([0.3, 0.5, 1, 2], ["0.3", "0.5", "1", "2"])
axes.minorticks_off()
axes.legend()
