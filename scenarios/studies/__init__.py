"""Many runs: sweeps, the comparison with baselines, laws side by side, audits, the paper's numbers."""
