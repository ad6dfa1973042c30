"""Measured speed: `make bench` prints the table."""
