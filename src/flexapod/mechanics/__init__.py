"""A leg as energies, and as C: symbolic, shapes, elements, leg."""
