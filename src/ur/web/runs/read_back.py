"""The joint between what nodes have printed into their log files and what the run sends from now on.

Lines that a node prints before the run sends them are only in its file; some of the first that it sends are in the
file, too. Each is shown once: the file is read when the run is first seen, and again up to the moment when the run has
confirmed that it sends lines. Those that it has sent until then are held, and dropped where the file has them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping

from ur.run.clients.protocol import find_severity
from ur.web.runs.log_lines import read_lines

Show = Callable[[str, str, str], None]


class ReadBack:
    """Calls `show` with the node, severity and text of each line of one run."""

    def __init__(self, show: Show) -> None:
        self._show = show
        self._offsets: dict[str, int] = {}
        self._held: list[tuple[str, str, str]] | None = []
        self._twice: dict[str, deque[str]] = {}

    def begin(self, logs: Mapping[str, str]) -> None:
        """Show what the log files hold, by node. The run is asked for new lines next."""
        for node, path in logs.items():
            self._read(node, path)

    def take(self, node: str, severity: str, text: str) -> None:
        """Take a line that the run has sent."""
        if self._held is not None:
            self._held.append((node, severity, text))
        elif not self._is_shown(node, text):
            self._show(node, severity, text)

    def confirm(self, logs: Mapping[str, str]) -> None:
        """The run sends lines by now: show what was printed before. Nothing after the first call."""
        if self._held is None:
            return
        for node, path in logs.items():
            self._twice[node] = deque(self._read(node, path))
        held, self._held = self._held, None
        for line in held:
            self.take(*line)

    def _read(self, node: str, path: str) -> list[str]:
        lines, self._offsets[node] = read_lines(path, self._offsets.get(node, 0))
        for line in lines:
            self._show(node, find_severity(line), line)
        return lines

    def _is_shown(self, node: str, text: str) -> bool:
        """Return whether a line that arrives was read in the file; those before it were not sent."""
        waiting = self._twice.get(node)
        if not waiting:
            return False
        if text not in waiting:
            waiting.clear()
            return False
        while waiting.popleft() != text:
            pass
        return True
