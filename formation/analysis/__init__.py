"""What theory says before anything moves: ends, rates, the exact closed loop, linearisations. Moves nothing."""

__all__ = ["closed_loop", "flow", "linearisation", "prediction"]
