"""Films of a run: the frames, and the encoders. Measures nothing."""

__all__ = ["encode", "film", "layout"]
