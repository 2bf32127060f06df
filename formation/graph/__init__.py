"""Who senses whom, and the conditions on it that laws name."""
