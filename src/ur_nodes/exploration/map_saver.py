"""Saving of the map that an exploration makes, by the service of the node that makes it."""

from __future__ import annotations

from collections.abc import Callable

from ur.maps.names import is_map_name
from ur_nodes.ports.node import Node
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result

_AGAIN = 5.0  # s of this computer until a map that is not stored is saved again
_ANSWER_LIMIT = 60.0  # s
_MOST_SAVES = 4  # at the end
_LOGGED_EVERY = 10.0  # s


class MapSaveClient:
    """Asks a service that answers the map's name; without a service ('') no map has a name."""

    def __init__(self, node: Node, service: str) -> None:
        self._node, self._service = node, service
        self._saved = ""
        self._next = 0.0  # by node.steady

    def save_once(self) -> str:
        """Store the map for the first time, unless it is stored. Returns its name, '' while it has none."""
        if self._service and not self._saved and self._node.steady() >= self._next:
            self._next = self._node.steady() + _AGAIN
            self._ask(self._note)
        return self._saved

    def save_last(self, take: Callable[[str], None]) -> None:
        """Save the final map; `take` gets its name, '' if it cannot be saved."""
        left = _MOST_SAVES if self._service else 0

        def save() -> None:
            nonlocal left
            left -= 1
            self._ask(note) if left >= 0 else take("")

        def note(name: str) -> None:
            if name:
                take(name)
            else:
                self._node.after(_AGAIN, save, steady=True)

        save()

    def _note(self, name: str) -> None:
        self._saved = self._saved or name

    def _ask(self, take: Callable[[str], None]) -> None:
        def read(answer: Result) -> None:
            if not answer.success:
                self._node.log.warn(f"{self._service}: the map is not saved: {answer.text}", every=_LOGGED_EVERY)
            take(answer.text if answer.success and is_map_name(answer.text) else "")

        self._node.call(self._service, Trigger(), read, _ANSWER_LIMIT)
