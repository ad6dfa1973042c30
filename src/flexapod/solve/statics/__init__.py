"""Statics of a robot: loads, equilibria, stiffness, forces in joints, one batch of poses at once."""
