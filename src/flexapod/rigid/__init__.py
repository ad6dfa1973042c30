"""Closed-form mathematics of the rigid robot: NumPy, vectorised over time."""

from flexapod.rigid.breaks import Breaks, actuator_breaks, robot_breaks
from flexapod.rigid.dynamics import RigidForces
from flexapod.rigid.forward import Postures
from flexapod.rigid.jacobian import NearestSingularity, SingularityPath, length_jacobian
from flexapod.rigid.kinematics import LegState, joint_angles, leg_frames, leg_lengths, leg_rotations
from flexapod.rigid.laws import Law
from flexapod.rigid.limbs import ABSENT, COORDINATES, DRIVEN, FREE, HELD, Limbs, limbs
from flexapod.rigid.mechanism import Reach, lost_words
from flexapod.rigid.mobility import Mobility, Posture, displaced, mobility
from flexapod.rigid.motions import independent_axes, mobility_words, motion_names, refuse_loose
from flexapod.rigid.robot import (
    carriages,
    drive_jacobian,
    drive_positions,
    energies,
    forward_kinematics,
    home_frames,
    home_pose,
    inverse_dynamics,
    inverse_kinematics,
    leg_axes,
    leg_bodies,
    nearest_singularity,
    payload_body,
    poses,
    poses_from_home,
    postures,
    pull_out,
    reach,
    reachable,
    rigid_limbs,
    singularity,
    strokes,
)
from flexapod.rigid.schedule import load_law, motion_law, wrench
from flexapod.rigid.trajectory import Poses, poses_from_coordinates, rotation_matrix
from flexapod.rigid.workspace import Excess, WorkspaceMap, reachable_map

__all__ = [
    "ABSENT",
    "COORDINATES",
    "DRIVEN",
    "FREE",
    "HELD",
    "Breaks",
    "Excess",
    "Law",
    "LegState",
    "Limbs",
    "Mobility",
    "NearestSingularity",
    "Poses",
    "Posture",
    "Postures",
    "Reach",
    "RigidForces",
    "SingularityPath",
    "WorkspaceMap",
    "actuator_breaks",
    "carriages",
    "displaced",
    "drive_jacobian",
    "drive_positions",
    "energies",
    "forward_kinematics",
    "home_frames",
    "home_pose",
    "independent_axes",
    "inverse_dynamics",
    "inverse_kinematics",
    "joint_angles",
    "leg_axes",
    "leg_bodies",
    "leg_frames",
    "leg_lengths",
    "leg_rotations",
    "length_jacobian",
    "limbs",
    "load_law",
    "lost_words",
    "mobility",
    "mobility_words",
    "motion_law",
    "motion_names",
    "nearest_singularity",
    "payload_body",
    "poses",
    "poses_from_coordinates",
    "poses_from_home",
    "postures",
    "pull_out",
    "reach",
    "reachable",
    "reachable_map",
    "refuse_loose",
    "rigid_limbs",
    "robot_breaks",
    "rotation_matrix",
    "singularity",
    "strokes",
    "wrench",
]
