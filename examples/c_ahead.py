"""A tripod 3-RPS whose weight is made up for, and which is shaped so that it stands still when it has arrived."""

import numpy as np

import flexapod as fx

study = fx.preset("tripod")
study = study.replace(motion=study.motion.replace(duration=0.3, hold=0.6))


def what_is_left(of: fx.Study) -> tuple[float, float]:
    """How far heave is off at rest at the start, and how far the tool still goes when it has arrived [um]."""
    data = fx.simulate(of)
    wanted = fx.kinematics.poses(study.robot, study.motion, np.zeros(1)).place(study.robot.tool)[0]
    after = data.tool_position.values[data.time.values >= of.motion.end_time - of.motion.hold]
    return 1e6 * abs(data.tool_position.values[0, 2] - wanted[2]), 1e6 * np.linalg.norm(np.ptp(after, axis=0))


ahead = fx.shape(fx.compensate(study), "2hei")  # wide enough for its three modes from 6.5 to 10 Hz
for name, of in (("as it is", study), ("compensated and shaped", ahead)):
    sag, swing = what_is_left(of)
    print(f"{name}: {sag:.4f} um too low, swings by {swing:.0f} um, {of.motion.end_time - of.motion.hold:.3f} s")
for said in ahead.notes:
    print(said)
