# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Control of a hexapod
#
# A hexapod on flexures and piezo drives rings at some 230 Hz. Its plant comes from the same study as everything else;
# a loop about it is chosen with the linear model, and then run in samples.

# %%
# %matplotlib inline
import numpy as np

import flexapod as fx
from flexapod.control import DVF, IFF, margins, root_locus

study = fx.preset("nano-hexapod")
plant = fx.linearize(study, inputs=["drive", "wrench"], outputs=["tool", "stroke", "force-sensor:drive"])
plant

# %% [markdown]
# ## What rings, and how little is it damped?

# %%
plant = plant.reduce(below="2 kHz")  # faster modes give way as at rest
print(plant.damp()[["frequency", "damping_ratio"]].isel(mode=slice(6)).to_dataframe().round(4))

# %% [markdown]
# ## Force feedback: how much gain?
#
# Each drive gives way to the integral of the force that it carries. The locus shows where the poles go as the gain
# grows from a hundredth to a hundred times of 100 1/s.

# %%
locus = root_locus(plant, IFF(100.0, high_pass="5 Hz"), np.geomspace(1e-2, 1e2, 200))
figure = fx.plot.root_locus(locus, below=600)
figure

# %% [markdown]
# Damping is bought by softness: forces that stay are given way to, but for the high-pass.

# %%
hz = np.geomspace(1, 1000, 600)
laws = {"IFF": IFF(200.0, high_pass="5 Hz"), "DVF": DVF(100.0, low_pass="2 kHz", sensor="stroke")}


def ringing(system):
    """Least damping of the platform on its legs."""
    found = system.damp()
    return float(found.damping_ratio.where((found.frequency > 150) & (found.frequency < 600)).min())


loops = {"open": plant} | {name: plant.close(law) for name, law in laws.items()}
for name, loop in loops.items():
    rest = abs(loop.select("wrench:fz", "tool:z").at(0.01).item())
    print(f"{name}: damping {ringing(loop):.1%}, at rest {1e9 * rest:.0f} nm/N")

# %%
responses = {name: loop.frequency_response(hz) for name, loop in loops.items()}
figure = fx.plot.bode(responses, "wrench:fz", "tool:z")
figure

# %% [markdown]
# ## How late may it be?
#
# The delay is exact. The margin is how close a loop comes to the point where it would grow; 0.5 is good.

# %%
for name, law in laws.items():
    for delay in ("0.02 ms", "0.1 ms", "0.2 ms"):
        found = margins(plant, law, delay=delay)
        print(f"{name}, {delay}: {found.modulus_margin.min().item():.2f}, poles that grow: {found.unstable_poles}")

# %% [markdown]
# ## In time
#
# The whole robot moves, not the linear model, and the controller reads ten thousand times a second.

# %%
for name, law in {"open": None, "DVF": laws["DVF"]}.items():
    sample = None if law is None else "10 kHz"
    data = fx.simulate(study, fidelity="lumped", tolerance=1e-3, controller=law, sample=sample)
    z = data.tool_deviation.sel(axis="z").values[-100:]
    print(f"{name}: swings by {1e9 * np.ptp(z):.2f} nm in the last 10 ms")

# %% [markdown]
# In one file each, with a number by hand: `flexapod new --example force_feedback`, `two_loops`.
