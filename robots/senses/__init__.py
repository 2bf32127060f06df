"""What compiled robots sense of each other, and by what chance it is wrong. No law and no filter knows of it here."""

__all__ = ["chance", "late", "measure", "noise"]
