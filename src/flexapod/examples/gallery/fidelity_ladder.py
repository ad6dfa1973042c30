r"""
The ladder of fidelities
========================

One beam, clamped in a hub and let go: of hinged segments, of shapes, of beam elements. Its first frequency is known,
$\omega = 1.8751^2 \sqrt{EI / \rho A L^4}$. What is the error of each, and of which order does it fall?
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

STUDY = """
[actuator]
length = "1.2 m"
EI = 756.65
rhoA = 4.02
free_length = "1 m"
gravity = 0

[initial]
tip_displacement = "1 mm"

[simulation]
duration = "4 s"
step = "0.1 ms"
"""
EXACT = 1.87510407**2 * np.sqrt(756.65 / 4.02) / (2 * np.pi)


def frequency(fidelity, number):
    """Frequency of the tip, from the first to the last of its passages through zero [Hz]."""
    data = fx.simulate_actuator(fx.loads(STUDY), fidelity=fidelity, modes=number)
    tip, time = data.tip_deflection.values, data.time.values
    up = np.flatnonzero((tip[:-1] < 0) & (tip[1:] >= 0))
    passed = time[up] - tip[up] * (time[up + 1] - time[up]) / (tip[up + 1] - tip[up])
    return (len(passed) - 1) / (passed[-1] - passed[0])


RUNGS = {"finite-segment": (2, 4, 8), "assumed-modes": (1, 2, 3), "beam-fem": (2, 4, 6)}
error = {name: [abs(frequency(name, n) / EXACT - 1) for n in numbers] for name, numbers in RUNGS.items()}
order = np.log2(error["finite-segment"][1] / error["finite-segment"][2])
print(f"exact {EXACT:.4f} Hz; order of the segments {order:.2f}; errors", {n: np.round(e, 6) for n, e in error.items()})

# A mode has 12 / (beta L)^4 of the tip: 97 %, 2.5 %, 0.3 %. Higher ones move a passage by 0.029 rad at most; two of
# them over 30 periods the frequency by 2 * 0.029 / (2 pi * 30) = 3e-4.
np.testing.assert_allclose(error["assumed-modes"], 0, atol=3e-4)
# Errors have even powers of a segment's length h. The second is (beta h)^2 / 30 of the first for central differences
# of waves; half of (beta h)^2 is allowed here: 0.1 for four segments.
np.testing.assert_allclose(order, 2, atol=0.1)

figure, axes = plt.subplots()
for name, numbers in RUNGS.items():
    axes.loglog(numbers, error[name], "o-", label=name)
axes.set(xlabel="segments, or shapes", ylabel="error of the first frequency", title="Error against effort")
axes.set_xticks([1, 2, 3, 4, 6, 8], ["1", "2", "3", "4", "6", "8"])
axes.minorticks_off()
axes.legend(loc="lower right")
