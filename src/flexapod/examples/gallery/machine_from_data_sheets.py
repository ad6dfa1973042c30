r"""
A machine from data sheets
==========================

A leg is a chain: plate, joint, bearing, screw, nut, piston, joint, plate. Catalogues give a stiffness for each, and
they stand in series: $1 / k = \sum 1 / k_i$. The piston is one of the stiffest.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

data = fx.parts(fx.preset("machine-hexapod"))
found = float(data.leg_stiffness.sel(leg=1))

area, ways = np.pi / 4 * (0.06**2 - 0.04**2), 0.2581  # of the piston; of the screw between bearing and nut at home
sheet = {  # N/m
    "joints": 200e6 / 2,  # INA, one at either end
    "plates": 1000e6 / 2,
    "piston": 200e9 * area / 0.6,
    "screw": 210e9 * np.pi / 4 * 0.028744**2 / ways,  # HIWIN, root diameter
    "bearing": 830e6,  # IBC
    "nut": 0.8 * 1130e6 * (1540 / (0.1 * 30.8e3)) ** (1 / 3),  # HIWIN, THK: by preload
}
by_hand = 1 / sum(1 / k for k in sheet.values())
print(f"a leg: {found / 1e6:.1f} N/um, by hand {by_hand / 1e6:.1f} N/um; its piston alone {sheet['piston'] / 1e6:.0f}")

# By hand a screw does not wind up; that is 1 % of the compliance.
np.testing.assert_allclose(found, by_hand, rtol=0.015)

figure, axes = plt.subplots()
share = 1e2 / data.part_stiffness.sel(leg=1) / (1 / found)
axes.barh([str(part) for part in data.part.values], share)
axes.set(xlabel="share in the compliance of a leg [%]", title="What gives way")
axes.invert_yaxis()
figure.tight_layout()
