"""The parts of a leg, one file each: how a part moves the frame of the next one, its energies, its springs."""
