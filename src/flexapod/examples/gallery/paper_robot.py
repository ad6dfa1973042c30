"""
The paper's robot
=================

A payload of 100 kg rolls by 26.6 degrees on six steel pistons of 27 mm. How far does it miss its path? An independent
multibody program, Exudyn, gives peaks of 4.35, 9.39 and 19.33 um for the same robot.
"""

import numpy as np

import flexapod as fx

study = fx.preset("paper-robot")
data = fx.simulate(study)
peak = 1e6 * np.abs(data.com_deviation).max("time").values  # um, x y z
print("The payload misses its path by x {:.2f}, y {:.2f}, z {:.1f} um.".format(*peak))

# The tolerance of the integration, 1e-4, stands for 0.002 um of these; both programs agree to 0.004 um.
np.testing.assert_allclose(peak, [4.35, 9.39, 19.33], atol=0.03)

figure = fx.plot.com_path(data)
