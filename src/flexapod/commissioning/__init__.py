"""Commissioning of the machine: feedforward commands."""
