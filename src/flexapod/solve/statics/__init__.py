"""What a robot is at rest: loads, equilibria, stiffness, forces in joints, one batch of poses at once."""
