"""
A better joint: the budget before and after
===========================================

Joints make more than half of a leg's compliance. What does twice their stiffness bring? Springs in series: the
compliance falls by half of their share, and the sag with it.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

before = fx.preset("machine-hexapod")
stiffer = {"axial": "400 N/um", "radial": "300 N/um"}
ends = ("leg.base_joint.stiffness", "leg.platform_joint.stiffness")
after = before.with_values({f"{end}.{name}": value for end in ends for name, value in stiffer.items()})

budgets = [fx.budget(study) for study in (before, after)]
give = [b.budget.sel(kind="systematic", component="z", part=["base_joint", "platform_joint"]) for b in budgets]
for words, budget in zip(("before:", "after:"), budgets, strict=True):
    print(words, budget.attrs["summary"].splitlines()[0])
ratio = float(give[1].sum() / give[0].sum())

# The force in a leg is the same: twice the stiffness gives half, but for second order, 1e-4 of it.
np.testing.assert_allclose(ratio, 0.5, rtol=2e-3)

figure, axes = plt.subplots()
parts = ["base_joint", "platform_joint", "axial-strain", "screw", "nut", "bearing", "base_plate", "top_plate"]
for i, (words, budget) in enumerate(zip(("before", "after"), budgets, strict=True)):
    values = -1e6 * budget.budget.sel(kind="systematic", component="z", part=parts)
    axes.barh(np.arange(len(parts)) + 0.4 * i - 0.2, values, 0.4, label=words)
axes.set_yticks(range(len(parts)), parts)
axes.set(xlabel="sag [um]", title="Joints of twice the stiffness")
axes.legend()
figure.tight_layout()
