"""A study as written: robot, payload, control, settings."""
