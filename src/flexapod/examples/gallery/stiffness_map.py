"""
A map of stiffness
==================

How stiff is a hexapod where? Up its axis in closed form: $K_z = 6 k (h / l)^2$ with the height $h$ and
$l$ the length of the legs there.
"""

import numpy as np

import flexapod as fx

study = fx.preset("paper-robot").with_values({"payload.com": [0, 0, 0]})
map_ = fx.workspace_map(
    study, {"surge": np.linspace(-0.1, 0.1, 9), "heave": np.linspace(-0.05, 0.05, 11)}, load=np.zeros(6)
)
found = map_.stiffness.sel(surge=0)

robot, piston = study.robot, study.robot.legs[0].piston
up = robot.home.position[2] + map_.heave.values
leg = robot.platform_joints[0] - robot.base_joints[0]
by_hand = 6 * piston.EA / piston.length * up**2 / (leg[0] ** 2 + leg[1] ** 2 + up**2)
print(f"at home {1e-6 * float(found.sel(heave=0)):.1f} N/um, by hand {1e-6 * by_hand[5]:.1f} N/um")

# The weight of the payload turns stiffness by its force over its length, 1e-6 of it.
np.testing.assert_allclose(found, by_hand, rtol=1e-4)

figure = fx.plot.workspace_map(map_, "stiffness")
