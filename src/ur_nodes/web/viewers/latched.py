"""The newest message of each latching publisher, which later subscribers get, too."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from ur_nodes.ports.raw import RawMessage

_MOST_PUBLISHERS = 64


@dataclass(slots=True)
class Latched:
    """Messages by the name of their publisher, as bytes."""

    messages: dict[str, bytes] = field(default_factory=dict)

    def note(self, message: RawMessage) -> None:
        """Note a message."""
        if message.sender is not None and message.sender.kept:
            self.messages[message.sender.name] = message.data
            while len(self.messages) > _MOST_PUBLISHERS:
                del self.messages[next(iter(self.messages))]


def compare_topics(offered: Mapping[str, str], found: Iterable[tuple[str, str]]) -> tuple[list[str], dict[str, str]]:
    """Return the topics to withdraw, and the topics to offer with their types; a topic of a new type is in both."""
    now = {name: kind for name, kind in found if "/" in kind}
    ended = [name for name, kind in offered.items() if now.get(name) != kind]
    return ended, {name: kind for name, kind in now.items() if offered.get(name) != kind}
