"""Checks, estimates and remarks on a study and its results."""
