"""Many runs of one study: variants (`sweeps`), poses (`workspace`), steps and shapes (`convergence`)."""
