"""What happens on the way of a run, from a scenario's tables: checked and named here, not carried out."""

__all__ = ["build", "event", "reshape"]
