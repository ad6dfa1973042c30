"""Parts of a leg, one file each: the frame that a part passes to the next one, its energies, its springs."""
