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
# # The error budget of a machine
#
# Whose micrometres are they? `machine-hexapod` is made of catalogue parts, warm, made to tolerances, with friction.

# %%
# %matplotlib inline
import numpy as np

import flexapod as fx

study = fx.preset("machine-hexapod")
budget = fx.budget(study)
print(budget.attrs["summary"])

# %%
figure = fx.plot.budget(budget)
figure

# %% [markdown]
# ## By part
#
# `budget` has what a part adds, by kind of error and direction; `share` is its part in the sum of all sizes.

# %%
budget.share.sortby(budget.share, ascending=False)[:6].to_pandas().map("{:.1%}".format)

# %% [markdown]
# ## Before and after a calibration
#
# Tolerances are constant: a controller that knows them takes them off. Heat and load stay.

# %%
before, after = (float(np.linalg.norm(budget.pose_accuracy.sel(state=s)[:3])) for s in ("uncalibrated", "calibrated"))
print(f"{1e6 * before:.0f} um before, {1e6 * after:.1f} um after")

# %% [markdown]
# ## Which part to buy
#
# Twice the stiffness of the joints against half of the warmth of the screws. Heat lifts this tool and weight lowers it,
# so that stiffer joints make the sum larger: a budget has to be read with its signs.

# %%
ends = ("leg.base_joint.stiffness.axial", "leg.platform_joint.stiffness.axial")
variants = {
    "as it is": {},
    "stiffer joints": dict.fromkeys(ends, "400 N/um"),
    "cooled screws": {"heat.screw": 22.5},
}
for name, values in variants.items():
    found = fx.budget(study.with_values(values))
    left = np.linalg.norm(found.pose_accuracy.sel(state="calibrated")[:3])
    print(f"{name}: {1e6 * left:.1f} um after calibration")

# %% [markdown]
# In one file each, with a number by hand: `flexapod new --example better_joint`, `tolerances`, `warm_machine`.
