"""Verdict on requirements: what a machine must keep, judged over a box of poses, its states and its motion."""

from flexapod.analysis.requirements.verdict_dataset import verdict

__all__ = ["verdict"]
