"""How accurate a pose is: errors of the machine as built and warm, tolerances, play."""

from flexapod.pose_errors.motion import play
from flexapod.pose_errors.pose import accuracy

__all__ = ["accuracy", "play"]
