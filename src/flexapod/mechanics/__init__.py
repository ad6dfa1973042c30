"""Equations of a leg from energies, compiled to C: symbolic, shapes, elements, leg."""
