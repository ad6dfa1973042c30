"""Symbols, Lagrange's equations and their compilation; the only package that imports casadi."""
