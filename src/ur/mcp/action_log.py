"""The log of what assistants have asked for: one JSON object a line, with the client that asked."""

import json
import os
import time
from pathlib import Path

from ur.source.replace import PRIVATE

_LARGEST = 5_000_000  # bytes; the file before it is kept, too
_LONGEST = 500  # characters of a text


class ActionLog:
    """Adds lines to a file that only its user may read."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def read(self) -> list[str]:
        """The lines of the newest file."""
        try:
            return self._path.read_text(encoding="utf-8").splitlines()
        except OSError:
            return []

    def add(self, client: str, action: str, arguments: object, result: str) -> None:
        """Note an action and what became of it. A file that cannot be written is no reason not to stop a robot."""
        line = {
            "time": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
            "client": client[:100],
            "action": action[:100],
            "arguments": json.dumps(arguments, default=str)[:_LONGEST],
            "result": result[:_LONGEST],
        }
        try:
            self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            if self._path.exists() and self._path.stat().st_size > _LARGEST:
                self._path.replace(self._path.with_suffix(".log.1"))
            with open(self._path, "a", encoding="utf-8", opener=lambda p, f: os.open(p, f, PRIVATE)) as file:
                file.write(json.dumps(line) + "\n")
        except OSError:
            return
