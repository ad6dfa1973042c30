"""
A sweep through a catalogue
===========================

Five pistons of a catalogue in one robot. What they stretch by is as one over their area, so that the deviation is a
straight line of slope -2 over their diameter.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

DIAMETERS = ["20 mm", "25 mm", "32 mm", "40 mm", "50 mm"]

study = fx.preset("paper-robot")
study = study.replace(simulation=study.simulation.replace(fidelity="lumped"))
data = fx.sweep(study, {"vary": [{"key": "leg.piston.diameter", "values": DIAMETERS}]}, workers=0)
peak = 1e6 * data.com_deviation_peak.values
diameter = np.array([float(text.split()[0]) for text in DIAMETERS])
slope = np.polyfit(np.log(diameter), np.log(peak), 1)[0]
print(f"{DIAMETERS[0]}: {peak[0]:.1f} um, {DIAMETERS[-1]}: {peak[-1]:.1f} um; slope {slope:.3f}")

# What is heavier needs more force, and vibrates: pistons are a tenth of the payload, and move along it.
np.testing.assert_allclose(slope, -2, atol=0.1)

figure, axes = plt.subplots()
axes.loglog(diameter, peak, "o-")
axes.set(xlabel="diameter of the pistons [mm]", ylabel="largest deviation [um]", title="Pistons of a catalogue")
axes.set_xticks(diameter, DIAMETERS)
axes.set_yticks([5, 10, 20, 30], ["5", "10", "20", "30"])
axes.minorticks_off()
