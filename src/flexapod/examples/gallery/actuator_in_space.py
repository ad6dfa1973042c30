r"""
A single actuator in space
==========================

A light arm that slews, rises to the horizontal and slides out at once. At rest there its tip hangs as a cantilever's by
$m g L^3 / 3 EI + \rho A g L^4 / 8 EI$.
"""

import numpy as np

import flexapod as fx

STUDY = """
[actuator]
space = true
length = "2 m"
section = { diameter = "40 mm", inner_diameter = "34 mm" }
material = "aluminium"
free_length = "1.2 m"
elevation = "-50 deg"
gravity = 9.81
damping = 0.3   # so much that it comes to rest
hub_inertia = "0.5 kg m^2"
tip_mass = "2 kg"

[motion]
rotation = { law = "quintic", amplitude = "120 deg", duration = "1.5 s" }
elevation = { law = "quintic", amplitude = "50 deg", duration = "1.5 s" }
extension = { law = "quintic", amplitude = "0.5 m", duration = "1.5 s" }

[simulation]
modes = 3
basis = "tip-load"
duration = "4 s"
"""

study = fx.loads(STUDY)
data = fx.simulate_actuator(study)
found = -float(data.tip_deflection[-1].sel(direction="elevation"))
arm, L, g = study.actuator, 1.7, 9.81
by_hand = (2 * L**3 / 3 + arm.rhoA * L**4 / 8) * g / arm.EI
print(f"at rest the tip hangs {1e3 * found:.4f} mm below the line of the hub, by hand {1e3 * by_hand:.4f} mm")

# Left out is the square of the slope at the tip, (m g L^2 / 2 EI + rho A g L^3 / 6 EI)^2 = 8e-5; the time integration
# has a tolerance of 1e-4.
np.testing.assert_allclose(found, by_hand, rtol=2e-4)

figure = fx.plot.actuator_response(data)
