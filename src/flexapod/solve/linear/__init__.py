"""Linear model about rest, and its vibration under disturbances."""
