"""A study written for other programs."""
