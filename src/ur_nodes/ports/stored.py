"""Messages in recordings, as values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StoredReader:
    """Reads the messages of a recorded topic and type; `read` raises ValueError and UserError."""

    topic: str
    type_name: str
    read: Callable[[bytes], object]


FindReader = Callable[[str, type], StoredReader | None]
"""Finds what a subscription of a topic and kind reads; None: there is no message for it."""
