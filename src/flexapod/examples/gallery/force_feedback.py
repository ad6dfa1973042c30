r"""
Integral force feedback on a hexapod of flexures
================================================

Each drive yields to the integral of its own force: as a spring whose loss factor is $g / \omega$. A mode is
then damped by $\zeta = \zeta_0 + \nu g / (2 \omega)$ with the share $\nu$ of its energy in the drives
(Preumont, Vibration Control of Active Structures). Flexures and rods of stiffness $k_s$ in series with drives
of $k_a$ leave $\nu = k_s / (k_s + k_a)$.
"""

import numpy as np

import flexapod as fx
from flexapod.control import IFF

study = fx.preset("nano-hexapod")
plant = fx.linearize(study, inputs=["drive", "wrench"], outputs=["tool", "force-sensor:drive"])
plant = plant.reduce(below="2 kHz")


def damping(system):
    """Frequencies and damping of the six modes of the platform on its legs."""
    found = system.damp()
    return found.sel(mode=(found.frequency > 100) & (found.frequency < 600) & (found.damping_ratio < 1))


before = damping(plant)
gains = (50.0, 100.0, 200.0)  # 1/s
found = np.array([damping(plant.close(IFF(gain))).damping_ratio for gain in gains])

leg = study.robot.legs[0]
k_a = leg.drive.stiffness
k_s = 1 / (2 / 93.95e6 + leg.piston.length / leg.piston.EA)  # two flexures and a rod
share, omega = k_s / (k_s + k_a), 2 * np.pi * before.frequency.values
by_hand = before.damping_ratio.values + share * np.outer(gains, 1 / (2 * omega))
for gain, one, hand in zip(gains, found, by_hand, strict=True):
    print(f"{gain:3.0f} 1/s: damping {one.min():.2%} to {one.max():.2%}, by hand {hand.min():.2%} to {hand.max():.2%}")

# Flexures bend, too, which holds up to (38 Hz / 378 Hz)^2 = 1 % of a mode's energy; second order in the damping, 0.5 %.
np.testing.assert_allclose(found, by_hand, rtol=0.02)

hz = np.geomspace(20, 1000, 600)
loops = {"open": plant} | {f"{gain:.0f} 1/s": plant.close(IFF(gain, high_pass="5 Hz")) for gain in (200.0, 1000.0)}
responses = {name: loop.frequency_response(hz) for name, loop in loops.items()}
figure = fx.plot.bode(responses, "wrench:fz", "tool:z")
