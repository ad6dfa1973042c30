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
# # A first robot
#
# A study is one text file: what is analysed, how it moves, how it is computed. `flexapod new robot.toml --from
# "home=900 mm, payload=150 kg, stroke=200 mm"` writes one for a machine of your size; here is a preset, a small hexapod
# of electric cylinders.

# %%
# %matplotlib inline
import numpy as np

import flexapod as fx

study = fx.preset("small-hexapod")  # or fx.load("robot.toml")
study

# %% [markdown]
# ## At rest
#
# Stiffness along each leg is that of its parts in series; the softest ones are worth money.

# %%
parts = fx.parts(study)
share = parts.leg_stiffness.sel(leg=1) / parts.part_stiffness.sel(leg=1)
share.sortby(share, ascending=False).to_pandas().map("{:.0%}".format)

# %%
modes = fx.modes(study)
modes[["frequency", "damping_ratio", "kind"]].isel(mode=slice(6)).to_dataframe().round(4)

# %% [markdown]
# ## In motion

# %%
data = fx.simulate(study)
print(f"The tool misses its path by up to {1e6 * float(np.abs(data.tool_deviation).max()):.1f} um.")

# %%
figure = fx.plot.deviation_by_cause(data)
figure

# %% [markdown]
# ## A change
#
# A study is frozen; a changed one is a new one. What do pistons of aluminium do?

# %%
light = study.with_values({"leg.piston.material": "aluminium"})
for name, one in (("steel", study), ("aluminium", light)):
    print(name, f"{float(fx.modes(one).frequency[0]):.1f} Hz")

# %% [markdown]
# `flexapod new --example paper_robot` and `better_joint` go on from here: problems solved in one file each.
