"""The experiments: scenario files, runner, trajectory, metrics, recording, figures, comparison, command line."""
