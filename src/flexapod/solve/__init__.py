"""Numerics on the equations: starts, equilibria, time integration, modes, stiffness."""
