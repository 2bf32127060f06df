"""Give the pictures of a folder a palette, where the eye does not see it: a quarter of the bytes.

    .venv/bin/python docs/palette.py docs/images

Areas keep their colours exactly; shades at the edges of lines, of which a drawing has thousands, are merged with their
neighbours. A picture that this would change visibly, or not make smaller, is kept as it is.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

import numpy as np
from PIL import Image

COLOURS, EXACT = 256, 32
"""Of a palette, and how many of them are the most frequent ones of the picture."""

VISIBLE, RARE = 20, 1e-4
"""A difference of a colour component, of 255, that the eye might see at the edge of a line, and the share of pixels
that may have it."""


def with_palette(content: bytes) -> bytes:
    """A PNG with a palette, or as it was."""
    image = Image.open(io.BytesIO(content))
    if image.mode == "P":
        return content
    pixels = np.asarray(image.convert("RGB"))
    colours, index, count = np.unique(pixels.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(-count, kind="stable")
    frequent, others = colours[order[:EXACT]], colours[order[EXACT:]]
    palette = frequent if not len(others) else np.concatenate([frequent, merged(others, COLOURS - len(frequent))])
    apart = np.abs(colours[:, None].astype(int) - palette.astype(int)).max(axis=-1)
    nearest = apart.argmin(axis=1)
    drawn = Image.fromarray(nearest[index].reshape(pixels.shape[:2]).astype(np.uint8), "P")
    drawn.putpalette(palette.tobytes())
    buffer = io.BytesIO()
    drawn.save(buffer, "PNG", optimize=True)
    small = buffer.getvalue()
    visible = count[apart.min(axis=1) > VISIBLE].sum() / count.sum()
    return small if visible <= RARE and len(small) < len(content) else content


def merged(colours: np.ndarray, count: int) -> np.ndarray:
    """(count, 3) colours that are near all of the colours (c, 3)."""
    strip = Image.fromarray(colours[None])
    found = strip.quantize(count, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE).getpalette()
    return np.array(found, dtype=np.uint8).reshape(-1, 3)[:count]


def main(folder: Path) -> None:
    for path in sorted(folder.glob("*.png")):
        before = path.read_bytes()
        after = with_palette(before)
        path.write_bytes(after)
        print(f"{path}: {len(before) / 1e3:.0f} -> {len(after) / 1e3:.0f} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
