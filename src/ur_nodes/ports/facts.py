"""Facts that all nodes of a run share: base, variant, run, clock."""

from __future__ import annotations

from typing import Protocol


class Facts(Protocol):
    """Reads and writes facts, by names such as 'base_name'."""

    simulated_time: bool
    """True where the time of `Node.now` is a simulation's."""

    def get(self, name: str, default: object = None) -> object:
        """Return the value of a fact; `default` while it is unknown."""

    def set(self, name: str, value: object) -> None:
        """Publish a fact to all nodes."""
