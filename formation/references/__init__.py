"""What a formation is told to do that changes all the time: the leader's path, its scale and turn; and how it lags.

Knows no law's code but the feed-forward, no file and no robot.
"""

__all__ = ["curves", "lag", "protocol", "ramps", "way_points"]
