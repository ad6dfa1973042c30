r"""
Friction and reversal
=====================

A screw with friction bends before it slides: coming from the other side the tool stands elsewhere. A torque $T$
at the screw is a force $F = 2 \pi T / p$ along it, and what lies between motor and stroke yields by
$F / k$; half of the way to and fro is what the leg lags.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

study = fx.preset("machine-hexapod")
torques = np.array([0.125, 0.25, 0.5, 1.0])  # N m
lost = [float(fx.parts(study.with_values({"leg.drive.friction.torque": torque})).lost_motion[0]) for torque in torques]
k_twist = float(fx.parts(study).part_stiffness.sel(leg=1, part="twist"))
by_hand = 2 * np.pi * torques / 0.01 / k_twist  # a lead of 10 mm; the screw winds up between motor and nut
print(f"0.5 N m: the leg lags by {1e9 * lost[2]:.1f} nm, by hand {1e9 * by_hand[2]:.1f} nm")

np.testing.assert_allclose(lost, by_hand, rtol=1e-6)

figure, axes = plt.subplots()
axes.plot(torques, 1e9 * by_hand, label=r"$2 \pi T / (p \, k)$")
axes.plot(torques, 1e9 * np.array(lost), "o", label="flexapod")
axes.set(xlabel="friction of a drive [N m]", ylabel="a leg lags by [nm]", title="Half of the lost motion")
axes.legend()
