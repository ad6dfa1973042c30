"""Active damping of a hexapod on flexures by integral force feedback: what gains bring and cost, what delays do."""

import numpy as np

import flexapod as fx
from flexapod.control import IFF, margins, root_locus

plant = fx.linearize(fx.preset("nano-hexapod"), inputs=["drive", "wrench"], outputs=["tool", "force-sensor:base"])
plant = plant.reduce(below="2 kHz")  # faster modes give way as at rest
still = abs(plant.select("wrench:fz", "tool:z").at(0.01).item())


def feedback(gain):
    return IFF(gain, high_pass="5 Hz", sensor="force-sensor:base")


for gain in (0.0, 100.0, 400.0, 1600.0):
    loop = plant.close(feedback(gain))
    poles = loop.damp()
    suspension = (poles.frequency > 100) & (poles.frequency < 600) & (poles.damping_ratio < 1)
    rest = abs(loop.select("wrench:fz", "tool:z").at(0.01).item()) / still
    print(
        f"gain {gain:4.0f} 1/s: damping {100 * poles.damping_ratio.values[suspension].min():5.2f} % at least,", end=" "
    )
    print(f"{rest:5.2f} times the compliance at rest")

late = margins(plant, feedback(400.0), delay="0.1 ms")
print(f"late by 0.1 ms the loop of 400 1/s has {late.attrs['unstable_poles']} poles that grow,", end=" ")
print(f"its distance from -1 is {late.modulus_margin.values.min():.2f}")

locus = root_locus(plant, feedback(100.0), np.geomspace(1e-2, 1e2, 200))
fx.plot.save(fx.plot.root_locus(locus, below=600), "force-feedback")
