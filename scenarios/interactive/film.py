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
        form: ``gif`` or ``mp4``.
    """

    data: bytes
    form: Literal["gif", "mp4"]

    def __repr__(self) -> str:
        return f"<film, {self.form}, {len(self.data)} bytes>"

    def _repr_html_(self) -> str:
        encoded = base64.b64encode(self.data).decode()
        if self.form == "gif":
            return f'<img alt="film of the run" src="data:image/gif;base64,{encoded}">'
        return f'<video controls loop muted src="data:video/mp4;base64,{encoded}"></video>'
