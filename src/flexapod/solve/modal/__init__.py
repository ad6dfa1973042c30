"""Frequencies, shapes and damping about rest."""
