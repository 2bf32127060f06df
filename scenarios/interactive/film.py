"""A film that a notebook plays."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, repr=False)
class Film:
    """A film in memory, which a notebook plays.

    Attributes:
        data: content of the file.
        form: ``gif``, ``webp`` or ``mp4``.
    """

    data: bytes
    form: Literal["gif", "webp", "mp4"]

    def __repr__(self) -> str:
        return f"<film, {self.form}, {len(self.data)} bytes>"

    def _repr_html_(self) -> str:
        encoded = base64.b64encode(self.data).decode()
        if self.form == "mp4":
            return f'<video controls loop muted src="data:video/mp4;base64,{encoded}"></video>'
        return f'<img alt="film of the run" src="data:image/{self.form};base64,{encoded}">'
