"""How accurate a pose is: errors of the machine as built and warm, tolerances, play."""

from flexapod.study.accuracy.motion import play
from flexapod.study.accuracy.pose import accuracy

__all__ = ["accuracy", "play"]
