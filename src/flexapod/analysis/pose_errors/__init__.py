"""Accuracy of a pose: errors of the machine as built and at operating temperature, tolerances, play."""

from flexapod.analysis.pose_errors.backlash import play
from flexapod.analysis.pose_errors.pose_accuracy import accuracy

__all__ = ["accuracy", "play"]
