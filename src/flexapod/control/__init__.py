"""Linear systems with named channels, and loops around them: they take any state space, robots or not."""
