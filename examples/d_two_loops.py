"""Two loops about a hexapod on ball screws: forces damp the legs, strokes hold the payload, direction by direction."""

import numpy as np

import flexapod as fx
from flexapod.control import Decentralised, by_jacobian, gain, integrator, lead, margins, robot_jacobian

CROSSING = 25.0  # Hz
study = fx.preset("machine-hexapod")
plant = fx.linearize(
    study, inputs=["drive", "floor"], outputs=["tool", "stroke", "force-sensor:platform"], drives="force"
)

# Rotors lie between drives and sensors; their inertia turns the sign of force feedback: it pushes where it is pushed.
damping = Decentralised(integrator(-100.0, high_pass="5 Hz"), sensor="force-sensor:platform")
frame = by_jacobian(
    robot_jacobian(study.robot, "com")
)  # strokes into motion of the centre of mass, its wrench into forces


def position(system):
    """A lead and an integral in each direction of the payload, of size 1 at the crossing."""
    response = frame.into @ system.select("drive", "stroke").at(CROSSING)[:, :, 0] @ frame.out
    shape = lead(CROSSING, 3.0) * (gain(1.0) + integrator(2 * np.pi * CROSSING / 10))
    return frame.controller([(1 / abs(size)) * shape for size in np.diag(response)])


hz = np.geomspace(2, 300, 2000)
for name, system in {"position alone": plant, "with force feedback": plant.close(damping)}.items():
    law = position(system)
    loop = system.close(law)
    poles = loop.damp()
    swings = (poles.frequency > 5) & (poles.frequency < 120) & (poles.damping_ratio < 1)
    carried = (
        1 - (2 * np.pi * hz) ** 2 * loop.select("floor", "tool").at(hz)[0, 0]
    )  # what of the floor the tool follows
    bears = 1e3 * margins(system, law).delay_margin.values.min()
    print(f"{name}: damping at least {100 * poles.damping_ratio.values[swings].min():.2g} %,", end=" ")
    print(f"floor to tool along x at most {np.abs(carried).max():.2g}, delay borne {bears:.2g} ms")
