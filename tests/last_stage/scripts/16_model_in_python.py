"""A robot built in Python from its parts, changed part by part, and written as a file."""

import json

import numpy as np

import flexapod as fx
from flexapod.model import (
    AxisMotion,
    CombinedMotion,
    Cylinder,
    Home,
    Leg,
    Payload,
    Piston,
    PrescribedDrive,
    Robot,
    ServoDrive,
    Simulation,
    Stroke,
    Study,
    base_circle,
    load,
    loads,
    platform_circle,
    preset_text,
    to_toml,
)

leg = Leg(
    cylinder=Cylinder(mass=3.0, com=0.1575, inertia=0.0248, mouth=0.315),
    piston=Piston(length=0.75, EA=1e8, EI=5e3, rhoA=4.5),
    stroke=Stroke(min=0.76, max=1.02),
    damping=0.005,
    drive=PrescribedDrive(),
)
robot = Robot(
    type="6-UPS",
    base_joints=base_circle(0.25, np.deg2rad(10)),
    platform_joints=platform_circle(0.15, np.deg2rad(10)),
    home=Home(position=[0.0, 0.0, 0.9]),
    gravity=[0.0, 0.0, -9.81],
    payload=Payload(mass=60.0, inertia=[1.5, 1.5, 2.4], com=[0.0, 0.0, 0.08], tool=[0.0, 0.0, 0.08]),
    legs=(leg,) * 6,
)
motion = CombinedMotion(amplitudes={"surge": 0.01, "heave": 0.01}, duration=0.1, hold=0.1)
study = Study(robot=robot, motion=motion, simulation=Simulation(fidelity="lumped", step=1e-3, duration=0.05))
data = fx.simulate(study)
alone = fx.simulate(robot, motion, fidelity="lumped", step=1e-3, duration=0.05)
text = to_toml(study)
again = loads(text)

soft = leg.replace(drive=ServoDrive(stiffness=1e7, damping=1e3))
softer = study.replace(robot=robot.replace(legs=(soft,) * 6))
heavier = study.replace(robot=robot.replace(payload=robot.payload.replace(mass=80.0)))
rolled = study.replace(motion=AxisMotion(type="roll", amplitude=0.05, duration=0.1, hold=0.0))
changed = study.replace(simulation=Simulation(step=1e-3))
machine = load("robot.toml")
refused = []
for call in (lambda: Piston(length=-1.0), lambda: loads("[robot]\ntype = 1\n"), lambda: fx.preset("hexapot")):
    try:
        call()
    except fx.InputError as error:
        refused.append([error.key, str(error.value)])

found = {
    "end": data.tool_deviation.values[-1],
    "alone": bool((alone.tool_deviation == data.tool_deviation).all()),
    "again": bool((fx.simulate(again).tool_deviation == data.tool_deviation).all()),
    "tables": [line for line in text.splitlines() if line.startswith("[")],
    "soft": fx.modes(softer).frequency.values[:3],
    "heavier": fx.stiffness(heavier).stiffness.values.diagonal(),
    "rolled": fx.inverse_kinematics(rolled).leg_length_command.values[-1],
    "changed": changed.simulation.fidelity,
    "numbers": [leg.piston.EA, robot.count, float(robot.home.position[2]), machine.robot.legs[0].drive.lead],
    "shown": [
        type(study).__name__,
        isinstance(machine, fx.Study),
        isinstance(fx.preset("paper-actuator"), fx.ActuatorStudy),
    ],
    "presets": [name for name in fx.model.PRESETS],
    "text_of_preset": preset_text("tripod").count("[robot]"),
    "refused": refused,
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
