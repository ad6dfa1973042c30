import numpy as np

import flexapod as fx

data = fx.simulate(fx.preset("paper-robot"))
peak = 1e6 * np.abs(data.com_deviation).max("time")
stretch = 1e6 * np.abs(data.deviation_by_cause.sel(cause="axial-strain").sum("leg")).max("time")
print(f"The payload misses its path by x {peak[0]:.2f}, y {peak[1]:.2f}, z {peak[2]:.1f} um,")
print(f"the stretch of the pistons by x {stretch[0]:.2f}, y {stretch[1]:.2f}, z {stretch[2]:.1f} um.")
