"""Finite elements of actuators and legs, and decks for finite element programs."""
