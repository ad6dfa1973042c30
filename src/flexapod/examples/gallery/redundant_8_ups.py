"""
Eight legs
==========

Eight legs hold six motions: with all drives in position two combinations of forces strain the robot and move nothing.
Six motions, eight drives: two self-stresses.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

RADII = {"base": 0.42, "platform": 0.25}
turn = np.radians([0, 90, 180, 270])
rows = {}
for name, radius in RADII.items():
    angles = np.concatenate([turn + s * np.radians(12 if name == "base" else 33) for s in (-1, 1)])
    rows[name] = [[round(radius * float(f(a)), 6) for f in (np.cos, np.sin)] + [0] for a in angles]
STUDY = f"""
[robot]
type = "8-UPS"
base = {{ joints = {rows["base"]} }}
platform = {{ joints = {rows["platform"]} }}
home_height = "0.9 m"

[payload]
mass = "120 kg"
inertia = [6, 6, 9]
com = [0, 0, "80 mm"]

[leg]
cylinder = {{ mass = "3 kg", com = "157.5 mm", inertia = 0.0248, mouth = "315 mm" }}
piston = {{ diameter = "27 mm", length = "750 mm", material = "steel" }}

[motion]
type = "heave"
amplitude = "40 mm"
duration = "0.8 s"
"""

data = fx.mobility(fx.loads(STUDY))
counts = {name: int(data[name]) for name in ("mobility", "locked", "self_stress")}
print(counts, [str(name) for name in data.motions.values])

# A platform has six motions; eight independent drives less six are two.
np.testing.assert_array_equal(list(counts.values()), [6, 0, 2])

figure, axes = plt.subplots()
for begin, end in zip(rows["base"], rows["platform"], strict=True):
    axes.plot([begin[0], end[0]], [begin[1], end[1]], "o-")
axes.set(xlabel="x [m]", ylabel="y [m]", title="Eight legs from above: two forces too many", aspect="equal")
