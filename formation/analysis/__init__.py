"""What theory says before anything moves: ends, rates, the exact closed loop, linearisations. Moves nothing."""

__all__ = [
    "amplification",
    "cascade",
    "closed_loop",
    "collisions",
    "exact",
    "first_follower",
    "flow",
    "lags",
    "linearisation",
    "margins",
    "noise",
    "prediction",
]
