"""Just enough of a terminal to read what `ur_nodes.teleop.terminal.raw` shows: lines are set and cleared."""

import re

_CONTROL = re.compile(r"\x1b\[([0-9;?]*)([A-Za-z])")


class Screen:
    """The text of a terminal screen. `feed` takes a program's output, `lines` are the visible lines."""

    def __init__(self) -> None:
        self._rows: dict[int, str] = {}
        self._row = 1
        self._rest = b""

    def feed(self, data: bytes) -> None:
        """Take what a program wrote; a control sequence may come in pieces."""
        data = self._rest + data
        cut = data.rfind(b"\x1b")
        unfinished = cut >= 0 and not _CONTROL.match(data[cut:].decode(errors="replace"))
        self._rest = data[cut:] if unfinished and len(data) - cut < 16 else b""
        text = data[: len(data) - len(self._rest)].decode(errors="replace")
        at = 0
        for control in _CONTROL.finditer(text):
            self._write(text[at : control.start()])
            at = control.end()
            self._control(control[1], control[2])
        self._write(text[at:])

    def lines(self) -> list[str]:
        """The lines from the top, without blanks around them."""
        return [self._rows.get(row, "").strip() for row in range(1, max(self._rows, default=0) + 1)]

    def _write(self, text: str) -> None:
        if text:
            self._rows[self._row] = self._rows.get(self._row, "") + text

    def _control(self, numbers: str, what: str) -> None:
        if what == "H":
            self._row = int(numbers.split(";")[0] or 1)
            if numbers:  # a line is shown anew, from its start
                self._rows.pop(self._row, None)
        elif what == "J":
            for row in [row for row in self._rows if row >= self._row]:
                del self._rows[row]
