"""Optimisation of a study: variables, an objective, constraints by outputs, and what the best of them costs."""
