r"""
When bending matters
====================

Between ideal joints a piston that bends becomes shorter by $1/2 \int w'^2$, an effect of second order: with half
of the weight there is a quarter of it. What stretch does is of first order, and halves. Thrust, too, softens a piston
in bending, by its share in the Euler load, which falls with the weight: so the order is that at no weight.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

robot = fx.preset("paper-robot")
weights = np.array([0.05, 0.1, 0.2, 0.4])
found = {"axial-strain": [], "bending": []}
for weight in weights:
    study = robot.with_values({"robot.gravity": [0, 0, -9.81 * weight]})
    data = fx.simulate(study, duration=1e-3, step=1e-3).isel(time=0)  # at rest
    for cause, values in found.items():
        values.append(float(abs(data.deviation_by_cause.sel(cause=cause, axis="z").sum("leg"))))
doubled = {cause: np.log2(np.array(values)[1:] / values[:-1]) for cause, values in found.items()}  # orders on the way
order = {cause: 2 * two[0] - two[1] for cause, two in doubled.items()}  # to no weight, along a straight line
print({cause: f"order {value:.3f}" for cause, value in order.items()})

# A tenth of the weight is 120 N in a leg, 0.2 % of its Euler load: squares of that are 1e-5. Rounding of places of 1 m
# is 1e-16 m beside 2e-12 m, 1e-4.
np.testing.assert_allclose([order["axial-strain"], order["bending"]], [1, 2], atol=5e-4)

figure, axes = plt.subplots()
for cause, values in found.items():
    axes.loglog(weights, 1e9 * np.array(values), "o-", label=f"{cause}, order {order[cause]:.2f}")
axes.set(xlabel="gravity over 9.81 m/s^2", ylabel="payload lower by [nm]", title="Stretch and bending at rest")
axes.set_xticks(weights, weights)
axes.minorticks_off()
axes.legend()
