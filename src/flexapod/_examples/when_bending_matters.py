r"""
When bending matters
====================

Between ideal joints a piston that bends becomes shorter by $1/2 \int w'^2$, an effect of second order: with half
of the weight there is a quarter of it. What stretch does is of first order, and halves.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

text = fx.preset("paper-robot").source_text
weights = np.array([0.05, 0.1, 0.2, 0.4])
found = {"axial-strain": [], "bending": []}
for weight in weights:
    study = fx.loads(text.replace("gravity = [0, 0, -9.81]", f"gravity = [0, 0, {-9.81 * weight}]"))
    data = fx.simulate(study, duration=1e-3, step=1e-3).isel(time=0)  # at rest
    for cause, values in found.items():
        values.append(float(abs(data.deviation_by_cause.sel(cause=cause, axis="z").sum("leg"))))
order = {cause: np.polyfit(np.log(weights), np.log(values), 1)[0] for cause, values in found.items()}
print({cause: f"order {value:.3f}" for cause, value in order.items()})

# Thrust softens a piston in bending by its share in the Euler load, up to 1 % here: the order is off by as much.
np.testing.assert_allclose([order["axial-strain"], order["bending"]], [1, 2], atol=0.02)

figure, axes = plt.subplots()
for cause, values in found.items():
    axes.loglog(weights, 1e9 * np.array(values), "o-", label=f"{cause}, order {order[cause]:.2f}")
axes.set(xlabel="gravity over 9.81 m/s^2", ylabel="payload lower by [nm]", title="Stretch and bending at rest")
axes.legend()
