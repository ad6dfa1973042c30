"""The verification pack: cases with a published or closed-form answer, computed on the spot: `pack.verify`."""
