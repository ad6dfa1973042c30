r"""
An element of your own
======================

A spring in series with a damper, side by side with the stroke, as an elastomer seal has it: one class. Pulled steadily
it holds back with $F = c v = k \tau v$, and it takes some $\tau$ to get there.
"""

from typing import Annotated, ClassVar

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx


class Maxwell(fx.Element):
    """A Maxwell element: `stiffness` [N/m] of the spring, `relaxation` [s] of the pair."""

    at: ClassVar[str] = "pair"
    coordinates: ClassVar = (("z", 1),)  # m, how far the damper has given way
    parameters: ClassVar = (("k", 1), ("c", 1), ("m", 1), ("home", 1))

    stiffness: Annotated[float, fx.Quantity("stiffness", above=0, why="of the spring")]
    relaxation: Annotated[float, fx.Quantity("time", above=0, why="damping over stiffness")]

    def numbers(self, leg, standing):
        """Stiffness, damping, a mass that stands for none, the length at which nothing is stretched."""
        k, tau = self.stiffness, self.relaxation
        return {"k": k, "c": k * tau, "m": 0.0 if standing.at_rest else 1e-8 * k * tau**2, "home": standing.length}

    @classmethod
    def energy(cls, p, q, v):
        """The spring is stretched by what the damper has not followed."""
        stretch = q.l - p.home - q.z
        return fx.Energies(kinetic=0.5 * p.m * v.z**2, strain=0.5 * p.k * stretch**2, dissipation=0.5 * p.c * v.z**2)

    outputs: ClassVar = (
        fx.Output("force", "N", "force of the seal along the leg", lambda p, q: p.k * (q.l - p.home - q.z)),
    )


study = fx.preset("paper-robot").with_values({"leg.pair": {"stiffness": "100 N/mm", "relaxation": "50 ms"}})
data = fx.simulate(study, fidelity="rigid", step=5e-4)
force, time = data.pair_force.sel(leg=1).values, data.time.values

# By hand: the stroke's rate through a filter of first order, dF/dt = k v - F / tau.
k, tau, h = 1e5, 0.05, time[1] - time[0]
rate, by_hand = np.gradient(data.leg_length_command.sel(leg=1).values, time, edge_order=2), np.zeros_like(time)
for i in range(len(time) - 1):
    by_hand[i + 1] = by_hand[i] * np.exp(-h / tau) + k * tau * (1 - np.exp(-h / tau)) * (rate[i] + rate[i + 1]) / 2
print(f"the seal of leg 1 holds with up to {abs(force).max():.1f} N, by hand {abs(by_hand).max():.1f} N")
np.testing.assert_allclose(force, by_hand, atol=1e-3 * abs(by_hand).max())

figure, axes = plt.subplots()
axes.plot(time, force, label="flexapod")
axes.plot(time, by_hand, "--", label="by hand")
axes.set(xlabel="time [s]", ylabel="force of the seal [N]", title="A seal that relaxes within 50 ms")
axes.legend()
