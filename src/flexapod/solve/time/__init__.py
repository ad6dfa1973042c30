"""Time integration: starts, fixed steps, steps within a tolerance, commands and loads as functions of time."""
