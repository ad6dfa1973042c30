r"""
Two loops: forces damp the legs, strokes hold the payload
=========================================================

A hexapod on ball screws. Forces at the platform damp its legs; about that a loop of strokes, decoupled by the
Jacobian at the centre of mass, holds the payload direction by direction. Its integral makes rigid what lies before the
stroke (screw, nut, bearing); what lies behind stands in series, $K_z = 6 k (h / l)^2$ with $1 / k = \sum 1 / k_i$.
"""

import numpy as np

import flexapod as fx
from flexapod.control import Decentralised, by_jacobian, gain, integrator, lead, robot_jacobian

CROSSING = 25.0  # Hz
study = fx.preset("machine-hexapod")
outputs = ["tool", "stroke", "force-sensor:platform"]
plant = fx.linearize(study, inputs=["drive", "wrench"], outputs=outputs, drives="force")
plant = plant.reduce(below="1 kHz")  # faster modes give way as at rest

# Rotors lie between drives and sensors; their inertia turns the sign of force feedback: it pushes where it is pushed.
damping = Decentralised(integrator(-100.0, high_pass="5 Hz"), sensor="force-sensor:platform")
frame = by_jacobian(robot_jacobian(study.robot, "com"))  # strokes into motions, a wrench into forces of drives


def hold_payload(system):
    """The system with a lead and an integral in each direction of the payload, of size 1 at the crossing."""
    response = frame.into @ system.select("drive", "stroke").at(CROSSING)[:, :, 0] @ frame.out
    shape = lead(CROSSING, 3.0) * (gain(1.0) + integrator(2 * np.pi * CROSSING / 10))
    return system.close(frame.controller([(1 / abs(size)) * shape for size in np.diag(response)]))


loops = {"position alone": hold_payload(plant), "with force feedback": hold_payload(plant.close(damping))}
parts = fx.parts(study).part_stiffness.sel(leg=1)
behind = (1 / parts.sel(part=["base_plate", "base_joint", "piston", "platform_joint", "top_plate"])).sum().item()
robot = study.robot
leg = robot.platform_joints[0] + robot.home.position - robot.base_joints[0]
by_hand = 6 / behind * (leg[2] / np.linalg.norm(leg)) ** 2
for name, loop in loops.items():
    poles = loop.damp()
    swings = (poles.frequency > 5) & (poles.frequency < 120) & (poles.damping_ratio < 1)
    stiffness = abs(1 / loop.select("wrench:fz", "tool:z").at(1e-4).item())
    print(f"{name}: damping at least {poles.damping_ratio.values[swings].min():.1%},", end=" ")
    print(f"K_z at rest {1e-6 * stiffness:.2f} N/um, by hand {1e-6 * by_hand:.2f} N/um")

    # The integral acts below 2.5 Hz, the high-pass of the forces below 5 Hz; weight adds parts in 1e5.
    np.testing.assert_allclose(stiffness, by_hand, rtol=5e-4)

hz = np.geomspace(2, 300, 600)
responses = {name: loop.frequency_response(hz) for name, loop in loops.items()}
figure = fx.plot.bode(responses, "wrench:fz", "tool:z")
