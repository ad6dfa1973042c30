"""The pose of a hexapod whose 42 parameters differ from the drawing, against a published calculation."""

import numpy as np
from scipy.spatial.transform import Rotation
from tests.mechanisms import CYLINDER, LOAD, PISTON, leg

from flexapod import rigid
from flexapod.model import Geometry, Robot

# Nominal and real parameters of Nategh & Agheli's hexapod, mm, as in tabathaviso/hexapod-parallel-manipulator
# (calibration.m) and the pose that its page html/calibration.html prints.
S = [(92.1597, 84.4488), (27.055, 122.037), (-119.2146, 37.5882)]
U = [(305.4001, 111.1565), (-56.4357, 320.0625), (-248.9644, 208.9060)]
REAL_S = [
    (96.6610, 81.7602, 1.0684), (22.2476, 125.2511, -0.5530), (-122.4519, 36.6453, 4.3547),
    (-120.6859, -34.4565, -4.9014), (24.7769, -125.0489, -4.8473), (91.3462, -80.9866, 0.2515),
]  # fmt: skip
REAL_U = [
    (305.2599, 115.0695, 2.6210), (-55.2814, 322.9819, 4.2181), (-244.7954, 208.0087, 3.9365),
    (-252.5755, -211.8783, -3.0128), (-53.9678, -320.6115, 4.3181), (302.4266, -109.4351, 3.3812),
]  # fmt: skip
L0, REAL_L0 = 604.8652, (604.4299, 607.2473, 600.4441, 605.9031, 604.5251, 600.0616)


def mirrored(points):
    return np.array([(x, y, 0.0) for x, y in points] + [(x, -y, 0.0) for x, y in points[::-1]])


def test_the_pose_of_the_real_hexapod_is_the_printed_one():
    base, platform = 1e-3 * mirrored(U), 1e-3 * mirrored(S)
    legs = (leg("UPS", cylinder=CYLINDER, piston=PISTON),) * 6
    geometry = Geometry(
        base_joints=1e-3 * np.array(REAL_U) - base,
        platform_joints=1e-3 * np.array(REAL_S) - platform,
        leg_offset=1e-3 * (np.array(REAL_L0) - L0),
    )
    robot = Robot(
        type="6-UPS", base_joints=base, platform_joints=platform, home_height=0.8, payload=LOAD, legs=legs,
        gravity=[0, 0, -9.81], geometry=geometry,
    )  # fmt: skip
    path = rigid.Poses.at_rest([-0.025, -0.75, 0.8], np.eye(3))
    found = rigid.built_poses(robot, path)
    # The print has two decimals of a millimetre, and angles that its solver left at about a hundredth of a degree.
    np.testing.assert_allclose(1e3 * found.position[0], [21.31, -731.19, 818.91], atol=0.006)
    angles = Rotation.from_matrix(found.rotation[0]).as_euler("XYZ", degrees=True)
    np.testing.assert_allclose(angles, [0.95, 3.68, -9.14], atol=0.015)
