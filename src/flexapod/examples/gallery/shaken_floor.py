r"""
On a floor that shakes
======================

A floor shakes a hexapod with the same acceleration at all frequencies, of density $S$. One mode answers with
$\sigma^2 = S / (8 \zeta \omega^3)$ (Crandall and Mark, Random Vibration in Mechanical Systems, 1963).
"""

from pathlib import Path

import numpy as np

import flexapod as fx

S = 1e-6  # (m/s^2)^2/Hz, one-sided
Path("floor.csv").write_text(f"frequency [Hz],z [(m/s^2)^2/Hz]\n0.01,{S}\n20000,{S}\n")
floor = {"disturbance.floor.spectrum": "floor.csv"}
study = fx.preset("paper-robot").with_values({"payload.com": [0, 0, 0], **floor})

data = fx.vibration(study)
found = float(data.vibration_rms.sel(component="z"))
up = int(np.argmax(abs(data.vibration_by_mode.sel(component="z").values)))
omega, zeta = 2 * np.pi * float(data.frequency[up]), float(data.damping_ratio[up])
by_hand = np.sqrt(S / (8 * zeta * omega**3))
print(f"{1e9 * found:.2f} nm, by hand {1e9 * by_hand:.2f} nm: a mode at {omega / 2 / np.pi:.0f} Hz, damping {zeta:.2%}")

# Legs weigh a tenth of the payload and shake a little by themselves: a few per cent in the share of the mode.
np.testing.assert_allclose(found, by_hand, rtol=0.1)

figure = fx.plot.vibration(data)
