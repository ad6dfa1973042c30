"""The paper's whole study and its claims: `study.replicate`, then `claims.claims`."""
