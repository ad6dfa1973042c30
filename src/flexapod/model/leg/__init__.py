"""A leg as written: cylinder, piston, joints, drive, friction, damping."""
