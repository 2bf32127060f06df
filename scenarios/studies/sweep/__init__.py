"""Monte Carlo: one scenario or its variations, many seeds, one row per run, and what the rows say together."""
