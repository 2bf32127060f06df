"""Runs compared with baselines: files that say what each run gave, on which machine, and how far another may differ."""
