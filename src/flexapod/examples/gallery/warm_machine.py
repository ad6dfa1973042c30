r"""
A warm machine
==============

A machine of one material that is warm all over keeps its shape and grows: the tool rises by
$\alpha h \Delta T$. Warm in its pistons alone it rises by more than their part of that, as legs lean.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

study = fx.preset("paper-robot")
warmer = np.array([1, 2, 5, 10])  # K
uniform, pistons = [], []
for dT in warmer:
    heat = {"reference": 20, "piston": 20 + dT}
    pistons.append(float(fx.accuracy(study.with_values({"heat": heat})).pose_error.sel(component="z")))
    heat |= dict.fromkeys(("base", "platform", "cylinder"), 20 + dT)
    uniform.append(float(fx.accuracy(study.with_values({"heat": heat})).pose_error.sel(component="z")))
alpha, height = 11.8e-6, 0.9  # of steel, 1/K; joints of the platform above those of the base
by_hand = alpha * height * warmer
print(f"10 K all over: {1e6 * uniform[-1]:.1f} um, by hand {1e6 * by_hand[-1]:.1f} um; pistons {1e6 * pistons[-1]:.1f}")

# The tool is in the plane of the joints, so that plate and payload do not matter. Exact: similar triangles.
np.testing.assert_allclose(uniform, by_hand, rtol=1e-6)

figure, axes = plt.subplots()
axes.plot(warmer, 1e6 * by_hand, label=r"$\alpha h \Delta T$")
axes.plot(warmer, 1e6 * np.array(uniform), "o", label="warm all over")
axes.plot(warmer, 1e6 * np.array(pistons), "s--", label="warm pistons")
axes.set(xlabel="warmer by [K]", ylabel="tool higher by [um]", title="A warm machine")
axes.legend()
