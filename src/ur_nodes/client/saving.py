"""Requests that save the map while it is made, or what has happened, and a line about their result."""

import threading
import time
from collections.abc import Callable

from ur.maps.names import is_map_name
from ur.source.printable import printable
from ur_nodes.ports.node import Node
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result

HINT = "s saves the map"
_PATIENCE = 30.0  # s
_PATIENCE_AT_END = 5.0  # s
_BLACK_BOX = "black_box/write"


class Saving:
    """Calls a service that saves something, one call at a time. Reads and requests may come from any thread."""

    def __init__(self, node: Node, service: str, doing: str, hint: str, describe: Callable[[Result], str]) -> None:
        """`hint` is the first line, `doing` the one during a call, and `describe` makes the one after it."""
        self._node, self._service, self._doing, self._describe = node, service, doing, describe
        self._news = hint
        self._busy = False
        self.line = ""
        """The line about the last call that has ended."""
        self.success = False
        """The last call has saved something."""
        self.count = 0
        """The number of calls that have ended."""

    def ask(self) -> None:
        """Start to save, unless a call is in progress."""
        self._node.post(self._ask)

    def pop_news(self) -> str:
        """Return the newest line once; '' when there is none."""
        news = self._news
        if news:
            self._node.post(lambda: self._forget(news))
        return news

    def _ask(self) -> None:
        if not self._busy:
            self._busy, self._news = True, f"{self._doing} ..."
            self._node.call(self._service, Trigger(), self._on_result, _PATIENCE)

    def _on_result(self, result: Result) -> None:
        self._busy, self.success = False, result.success
        self.line = self._news = self._describe(result)
        self.count += 1

    def _forget(self, news: str) -> None:
        if self._news == news:
            self._news = ""


class MapSaving(Saving):
    """Saves the map that is being made."""

    def __init__(self, node: Node, service: str, hint: str = HINT) -> None:
        super().__init__(node, service, "saving the map", hint, self._describe_map)
        self.name = ""
        """The name of the map that was saved last."""

    def save_last(self, ended: threading.Event) -> str:
        """Save the map as its program ends, and return how to go on; '' once the node has ended."""
        before, until = self.count, time.monotonic() + _PATIENCE_AT_END
        self.ask()
        while self.count == before and time.monotonic() < until:
            if ended.wait(0.02):
                return ""
        if self.count == before:
            return "the map is stored when the program has ended: 'ur maps' lists it"
        return describe_stored(self.name) if self.success else self.line

    def _describe_map(self, result: Result) -> str:
        name, problem = read_saved(result)
        self.name = name or self.name
        return f"map '{name}' saved" if name else f"the map was not saved: {problem}"


def describe_stored(name: str) -> str:
    """Report under which name a map is stored, and how to go on."""
    return f"the map is stored as '{name}'; navigate on it with\n    ur run keyboard_navigate map:={name}"


def save_recordings(node: Node) -> Saving:
    """Have the black box write what has happened."""
    return Saving(node, _BLACK_BOX, "saving what happened", "", describe_recording)


def request_recording(node: Node, callback: Callable[[Result], None]) -> None:
    """Have the black box write what has happened, once; `callback` gets the place of the file, or the reason."""
    node.call(_BLACK_BOX, Trigger(), callback, _PATIENCE)


def describe_recording(result: Result) -> str:
    """Describe the answer of the black box."""
    text = printable(result.text)
    return f"what happened is saved: {text}" if result.success else f"what happened was not saved: {text}"


def read_saved(result: Result) -> tuple[str, str]:
    """Return the name of the map from the answer of the service that saves it, or '' and the reason."""
    if not result.success:
        return "", result.text
    return (result.text, "") if is_map_name(result.text) else ("", "the service answers no name of a map")
