"""What runs achieve, found while they go on, for those who keep no trajectory. Nothing that only a trajectory tells."""

__all__ = ["watch", "watching"]
