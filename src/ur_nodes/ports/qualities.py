"""The ways in which the values of a topic travel."""

from __future__ import annotations

from enum import Enum


class Quality(Enum):
    """A topic's promise, on both of its ends."""

    NEWEST = "newest"
    """Only the newest counts: one that is still waiting is replaced."""

    LATCHED = "latched"
    """As NEWEST, and who listens later gets the last one that was sent."""

    EVERY = "every"
    """Each counts, in order; of more than 100 that wait the oldest goes."""

    COMMAND = "command"
    """As EVERY, and sent without waiting for more to send with it."""

    LOSSLESS = "lossless"
    """As EVERY, and none is lost: sending waits for who listens. For a source that can be slowed down."""
