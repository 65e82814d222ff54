"""The shape of a stand-in."""

from __future__ import annotations

from typing import Protocol


class Firmware(Protocol):
    """The behaviour of a device at the end of a line; `covers` are the keys of sensors that it reports."""

    covers: frozenset[str]

    def take(self, data: bytes) -> bytes:
        """Take bytes of the driver, and return the answers. No bytes make it raise."""

    def tick(self) -> bytes:
        """Return what the device sends by itself until now."""
