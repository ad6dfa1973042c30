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
# # Mechanisms side by side
#
# The same calls take any robot whose platform is moved by legs. Here are three: six legs, three legs, and a large
# hydraulic one.

# %%
# %matplotlib inline
import numpy as np

import flexapod as fx

robots = {name: fx.preset(name) for name in ("machine-hexapod", "tripod", "motion-base")}
for name, study in robots.items():
    found = fx.mobility(study)
    print(f"{name}: {study.robot.type}, moves in {', '.join(found.motions.values)}")

# %% [markdown]
# ## How stiff, and how fast do they vibrate?

# %%
for name, study in robots.items():
    k = 1e-6 * np.diag(fx.stiffness(study).stiffness)[:3]
    f = fx.modes(study).frequency[:3].values
    print(f"{name}: {k.round(1)} N/um along x, y, z; {f.round(1)} Hz")

# %% [markdown]
# ## What makes them miss their path?
#
# Each for its own motion. In a tripod it is bending; in the others what gives way along the legs.

# %%
for name, study in robots.items():
    data = fx.simulate(study, tolerance=1e-3)
    size = np.abs(data.deviation_by_cause.sum("leg")).max(("time", "axis"))
    worst = size.sortby(size, ascending=False)
    causes = [
        f"{cause} {1e6 * value:.1f} um" for cause, value in zip(worst.cause.values, worst.values[:3], strict=False)
    ]
    print(f"{name}: {', '.join(causes)}")

# %%
figure = fx.plot.com_path(fx.simulate(robots["tripod"], tolerance=1e-3))
figure

# %% [markdown]
# In one file each, with a number by hand: `flexapod new --example tripod_against_hexapod`, `delta`, `hexaglide`.
