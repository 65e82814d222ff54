"""The request that saves the map while it is made, and a line about its result."""

from __future__ import annotations

from ur.maps.names import is_map_name
from ur_nodes.ports.node import Node
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result

HINT = "s saves the map"
_PATIENCE = 30.0  # s


class MapSaving:
    """Calls a service that saves the map, one call at a time. Reads and requests may come from any thread."""

    def __init__(self, node: Node, service: str, hint: str = HINT) -> None:
        """`hint` is the first line."""
        self._node, self._service = node, service
        self._news = hint
        self._busy = False
        self.line = ""
        """The line about the last call that has ended."""
        self.name = ""
        """The name of the map that was saved last."""
        self.count = 0
        """The number of calls that have ended."""

    def ask(self) -> None:
        """Start to save, unless a call is in progress."""
        self._node.post(self._ask)

    def take_news(self) -> str:
        """Return the newest line once; '' when there is none."""
        news = self._news
        if news:
            self._node.post(lambda: self._forget(news))
        return news

    def _ask(self) -> None:
        if not self._busy:
            self._busy, self._news = True, "saving the map ..."
            self._node.call(self._service, Trigger(), self._take, _PATIENCE)

    def _take(self, result: Result) -> None:
        name, problem = read_saved(result)
        self._busy, self.name = False, name or self.name
        self.line = self._news = f"map '{name}' saved" if name else f"the map was not saved: {problem}"
        self.count += 1

    def _forget(self, news: str) -> None:
        if self._news == news:
            self._news = ""


def read_saved(result: Result) -> tuple[str, str]:
    """Return the name of the map from the answer of the service that saves it, or '' and the reason."""
    if not result.success:
        return "", result.text
    return (result.text, "") if is_map_name(result.text) else ("", "the service answers no name of a map")
