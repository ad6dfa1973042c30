r"""
A move that is compensated and shaped
=====================================

A robot on soft drives sags by $m g / K_z$ and oscillates after it has arrived. Feedforward commands compensate
the sag; two half moves, half a period apart, the oscillation. Made for a frequency $f_s$ they leave
$|\cos(\pi f / 2 f_s)|$ of a vibration of $f$ (Singer and Seering, 1990): nothing if it is the right one.
"""

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx

study = fx.loads("""
[robot]
type = "6-UPS"
base = { radius = "250 mm", half_angle = "10 deg" }
platform = { radius = "150 mm", half_angle = "10 deg" }
home_height = "0.9 m"

[payload]
mass = "60 kg"
inertia = [1.5, 1.5, 2.4]
com = [0, 0, 0]

[leg]
cylinder = { mass = "0.3 kg", com = "157.5 mm", inertia = 2.48e-3, mouth = "315 mm" }
piston = { length = "750 mm", EA = "100 MN", EI = "5 kN m^2", rhoA = "0.5 kg/m" }
stroke = { min = "760 mm", max = "1.02 m" }
drive = { type = "servo", stiffness = "0.2 N/um", damping = "0 N s/m" }

[motion]
type = "heave"
amplitude = "5 mm"
duration = "60 ms"
hold = "0.5 s"
[simulation]
fidelity = "lumped"
output_step = "1 ms"
""")
modes = fx.modes(study)
first = float(modes.frequency[np.argmax(abs(modes.platform_shape.sel(component="z").values))])  # up and down


def height(of):
    """Time [ms], height of the tool over where it has to be at last [um], the same once it is there."""
    data = fx.simulate(of)
    z = 1e6 * (data.tool_position.sel(axis="z").values - study.robot.home.position[2] - 5e-3)
    return 1e3 * data.time.values, z, z[data.time.values > of.motion.end_time - 0.3]


ahead = fx.compensate(study)
cases = {"as it is": study, "compensated": ahead}
cases |= {f"and shaped for {x:g} f": fx.shape(ahead, "zv", modes=[x * first]) for x in (1.2, 1.0)}
moves = {name: height(of) for name, of in cases.items()}
swing = {name: 0.5 * np.ptp(after) for name, (_, _, after) in moves.items()}
for name, (_, _, after) in moves.items():
    print(f"{name}: {0.5 * (after.max() + after.min()):.1f} um, swings by {swing[name]:.1f} um")
left = swing["and shaped for 1.2 f"] / swing["compensated"]
print(f"with a frequency that is 20 % too high {left:.3f} of it, by hand {np.cos(np.pi / 2 / 1.2):.3f}")

# Rows every ms see the largest place of a vibration of 22 Hz to 0.2 %; heights of 5 mm change its frequency by 1 %.
np.testing.assert_allclose(left, np.cos(np.pi / 2 / 1.2), rtol=0.02)

figure, axes = plt.subplots()
for name, (t, z, _) in moves.items():
    axes.plot(t, z, label=name)
axes.set(xlim=(0, 350), ylim=(-2500, 3000), xlabel="time [ms]", ylabel="height of the tool [um]")
axes.legend(loc="upper right")
