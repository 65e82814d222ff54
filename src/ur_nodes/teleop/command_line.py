"""The input line: history, and the map's keys while it is empty."""

from __future__ import annotations

from textual import events
from textual.message import Message
from textual.widgets import Input

EMPTY_LINE_KEYS = frozenset({"plus", "minus", "equals_sign", "0", "f", "t", "left", "right", "pageup", "pagedown"})
"""Keys that no command begins with: they are the map's while nothing is typed."""


class CommandLine(Input):
    """Posts `Entered` with the line and clears itself. Up and down walk through what was entered before."""

    class Entered(Message):
        """A line was entered."""

        def __init__(self, line: str) -> None:
            super().__init__()
            self.line = line

    class MapKey(Message):
        """A key of the map was pressed on the empty line."""

        def __init__(self, key: str) -> None:
            super().__init__()
            self.key = key

    class EmergencyKey(Message):
        """The space bar was pressed where no space belongs."""

    def __init__(self, *, id: str | None = None) -> None:
        super().__init__(
            id=id,
            compact=True,
            select_on_focus=False,
            placeholder="g X Y [ANGLE], m NAME, ? for help; Space: emergency stop",
        )
        self._history: list[str] = []
        self._at = 0

    def on_key(self, event: events.Key) -> None:
        """Take the keys that an input line does not."""
        taken = True
        if event.key == "up":
            self._recall(self._at - 1)
        elif event.key == "down":
            self._recall(self._at + 1)
        elif event.key == "space" and (not self.value or self.value[-1] == " "):
            self.post_message(self.EmergencyKey())  # no command begins with a space or holds two in a row
        elif event.key == "escape":
            self.value = ""
        elif not self.value and event.key in EMPTY_LINE_KEYS:
            self.post_message(self.MapKey(event.key))
        else:
            taken = False
        if taken:
            event.stop()
            event.prevent_default()

    async def action_submit(self) -> None:
        """Enter."""
        line = self.value.strip()
        self.value = ""
        if not line:
            return
        if not self._history or self._history[-1] != line:
            self._history.append(line)
        self._at = len(self._history)
        self.post_message(self.Entered(line))

    def _recall(self, at: int) -> None:
        self._at = max(0, min(at, len(self._history)))
        self.value = self._history[self._at] if self._at < len(self._history) else ""
        self.cursor_position = len(self.value)
