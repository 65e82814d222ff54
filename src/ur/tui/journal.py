"""The log of a run for display: grouped messages, counted repetitions, limited floods and memory. Pure."""

import re
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

from ur.run.clients.protocol import Notice, OutputLine, Severity, find_severity
from ur.source.ansi import STYLE, strip_styles

MOST_ENTRIES = 10_000
MOST_LINES = 200  # of one message
MOST_AT_ONCE = 200  # lines of one node between two updates; more are counted, the log file has them all
REACH = 64  # entries between two lines of one message, or two equal messages
RANK: dict[Severity, int] = {"debug": 0, "": 1, "info": 1, "warning": 2, "error": 3, "fatal": 4}

_HEAD = re.compile(r"\[ *[A-Z]+ *\] *(?:\[(?:WallTime: )?[0-9.]+(?:[^\]]*)\] *)?:? ?")
_CLOSED = re.compile("\x1b\\[0?m")


@dataclass(slots=True)
class Entry:
    """A message of a node (`name` empty: of the run itself). `time` is when it arrived, s since the epoch.

    `lines` may contain colours but no other control sequences. `count` is the number of its repetitions in a row.
    `number` increases. `open` while the next line of the node belongs to the message.
    """

    number: int
    time: float
    name: str
    severity: Severity
    lines: list[str]
    count: int = 1
    open: bool = False
    trace: bool = False  # a Python traceback, up to the line that names the exception
    flood: int = 0  # lines that are not shown


@dataclass(frozen=True, slots=True)
class Filter:
    """The filter of the log.

    `rank` is the minimum severity; `node` and `text` empty: all; `muted` nodes are left out.
    """

    node: str = ""
    rank: int = 0
    text: str = ""
    muted: frozenset[str] = frozenset()

    def admits(self, entry: Entry) -> bool:
        """Return whether an entry is shown, always as a whole."""
        if RANK[entry.severity] < self.rank:
            return False
        if entry.name and ((self.node and entry.name != self.node) or entry.name in self.muted):
            return False
        wanted = self.text.lower()
        return not wanted or wanted in entry.name.lower() or any(wanted in strip_styles(x).lower() for x in entry.lines)


@dataclass(slots=True)
class Journal:
    """The log of a run. `entries` oldest first; `take_changes` returns the position of new ones."""

    entries: deque[Entry] = field(default_factory=lambda: deque(maxlen=MOST_ENTRIES))
    _last: dict[str, Entry] = field(default_factory=dict)
    _next: int = 0
    _oldest_change: int | None = None

    def add(self, events: Iterable[OutputLine | Notice], now: float) -> None:
        """Add the lines printed since the last update. `now` in s since the epoch."""
        counts: dict[str, int] = {}
        for event in events:
            if isinstance(event, Notice):
                lines = [clean(line) for line in event.text.split("\n")][:MOST_LINES]
                self._append(now, "", event.severity or "info", lines)
                continue
            count = counts.get(event.name, 0) + 1
            counts[event.name] = count
            if count <= MOST_AT_ONCE:
                self._add_line(event, now)
        for name, count in counts.items():
            if count > MOST_AT_ONCE:
                self._add_flood(name, count - MOST_AT_ONCE, now)

    def clear(self) -> None:
        """Remove all entries."""
        self.entries.clear()
        self._last.clear()
        self._oldest_change = 0

    def pop_changes(self) -> int | None:
        """Return the number of the oldest entry that is new or has changed since the last call, or None."""
        found, self._oldest_change = self._oldest_change, None
        return found

    def _add_line(self, event: OutputLine, now: float) -> None:
        text = clean(event.text)
        before = self._recent(event.name)
        if before is not None and not event.severity and _goes_on(before, text):
            if len(before.lines) < MOST_LINES:
                before.lines.append(strip_styles(text) if before.severity else text)
            if before.open and _CLOSED.search(text):
                before.open = False
            if before.trace and not text.startswith((" ", "\t")):
                before.trace = False
                before.severity = "error"
            self._touch(before)
            return
        severity, shown = event.severity or find_severity(text), text
        if severity:
            shown = strip_head(strip_styles(text))
        trace = text.startswith("Traceback (most recent call last)")
        severity = severity or ("error" if trace else "")
        if before is not None and not trace and before.severity == severity and before.lines == [shown]:
            before.count += 1
            self._touch(before)
            return
        entry = self._append(now, event.name, severity, [shown])
        entry.trace = trace
        entry.open = bool(event.severity) and "\x1b[" in text and not _CLOSED.search(text)

    def _add_flood(self, name: str, count: int, now: float) -> None:
        before = self._recent(name)
        if before is None or not before.flood:
            before = self._append(now, name, "debug", [""])
        before.flood += count
        before.lines[0] = f"... {before.flood:,} more lines arrived too fast to be read; the log file has them"
        self._touch(before)

    def _append(self, now: float, name: str, severity: Severity, lines: list[str]) -> Entry:
        entry = Entry(self._next, now, name, severity, lines)
        self._next += 1
        self.entries.append(entry)
        self._last[name] = entry
        self._touch(entry)
        return entry

    def _recent(self, name: str) -> Entry | None:
        found = self._last.get(name)
        return found if found is not None and self._next - found.number <= REACH else None

    def _touch(self, entry: Entry) -> None:
        if self._oldest_change is None or entry.number < self._oldest_change:
            self._oldest_change = entry.number


def clean(text: str) -> str:
    """Return a line without cursor moves and the bell: colours stay, tabs become spaces, other controls `?`."""
    if text.isprintable():
        return text
    pieces = []
    position = 0
    for colour in STYLE.finditer(text):
        pieces += [_hide(text[position : colour.start()]), colour.group()]
        position = colour.end()
    return "".join([*pieces, _hide(text[position:])])


def strip_head(text: str) -> str:
    """Return a message without the prefix `[ INFO] [1700000000.123]: ` of rosconsole and rospy."""
    found = _HEAD.match(text)
    return text[found.end() :] if found else text


def _hide(text: str) -> str:
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() else "?" for letter in text.expandtabs(4))


def _goes_on(entry: Entry, text: str) -> bool:
    bare = strip_styles(text)
    if entry.flood:
        return False
    return entry.open or entry.trace or (bool(entry.severity) and bare[:1] in (" ", "\t"))
