"""The log of a run on the screen: only visible lines are drawn."""

import time
from dataclasses import dataclass

from rich.cells import cell_len, set_cell_size
from rich.segment import Segment
from rich.style import Style
from rich.text import Text
from textual.geometry import Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

from ur.source.ansi import strip_styles
from ur.source.printable import printable
from ur.tui.journal import RANK, Entry, Filter, Journal
from ur.tui.palette import ScreenPalette

MOST_ROWS = 20_000
NAME_CELLS = 22
CLOCK_FROM = 100  # columns above which the time is shown


@dataclass(frozen=True, slots=True)
class LogRow:
    """One line on the screen: characters `start` to `end` of a line of an entry, colours not counted."""

    entry: Entry
    line: int
    start: int
    end: int


def wrap_entry(entry: Entry, width: int) -> list[LogRow]:
    """Return the rows of an entry whose lines are broken after `width` cells."""
    rows = []
    for number, line in enumerate(entry.lines):
        text = strip_styles(line)
        rows += [LogRow(entry, number, start, end) for start, end in _cut(text, max(width, 8))]
    return rows


def _cut(text: str, width: int) -> list[tuple[int, int]]:
    if len(text) * 2 <= width or cell_len(text) <= width:  # no letter is wider than two cells
        return [(0, len(text))]
    pieces = []
    start = cells = 0
    for index, letter in enumerate(text):
        size = cell_len(letter)
        if cells + size > width:
            space = text.rfind(" ", start + width // 2, index + 1)  # between words, where one ends soon enough
            end = index if space < 0 else space
            pieces.append((start, end))
            start = end if space < 0 else space + 1
            cells = cell_len(text[start:index])
        cells += size
    return [*pieces, (start, len(text))]


def short_name(name: str, cells: int) -> str:
    """Return a node's name in a number of cells: without its leading slash, and shortened from the left."""
    bare = printable(name.lstrip("/"))
    return bare if len(bare) <= cells else "…" + bare[1 - cells :]


class LogView(ScrollView, can_focus=False):
    """Shows a journal through a filter. Follows its end until it is scrolled away from it."""

    def __init__(self, journal: Journal, palette: ScreenPalette) -> None:
        super().__init__(id="log")
        self.filter = Filter()
        self.palette = palette
        self._journal = journal
        self.rows: list[LogRow] = []  # all that can be scrolled to
        self._width = 0
        self.follows = True  # new messages
        self._name_cells = 0

    def show_changes(self) -> None:
        """Add new entries of the journal."""
        oldest = self._journal.pop_changes()
        if oldest is not None:
            self._rebuild(oldest)

    def rebuild(self) -> None:
        """Rebuild all rows after a change of the filter or the width."""
        self._rebuild(-1)

    def on_resize(self) -> None:
        """Rebuild the rows, since lines are broken elsewhere."""
        if self.size.width != self._width:
            self.rebuild()
        elif self.follows:
            self._show_end()

    def scroll_to_end(self) -> None:
        """Follow the end again."""
        self.follows = True
        self._show_end()

    def watch_scroll_y(self, old_value: float, new_value: float) -> None:
        """Follow the end of the log unless the user has scrolled away from it."""
        super().watch_scroll_y(old_value, new_value)
        self.follows = new_value >= len(self.rows) - self.size.height - 0.5

    def _show_end(self) -> None:
        self.scroll_to(y=len(self.rows) - self.size.height, animate=False, immediate=True, force=True)

    def _rebuild(self, oldest: int) -> None:
        follows = self.follows
        self._width = self.size.width
        names = max((len(name) for name in {e.name for e in self._journal.entries}), default=0)
        cells = max(6, min(NAME_CELLS, names - 1, self._width // 4))
        if cells != self._name_cells:
            self._name_cells, oldest = cells, -1
        first = self._journal.entries[0].number if self._journal.entries else 0
        kept = [row for row in self.rows if first <= row.entry.number < oldest]
        lost = sum(row.entry.number < first for row in self.rows) if oldest >= 0 else 0
        room = self._width - ((9 if self._width >= CLOCK_FROM else 0) + self._name_cells + 4) - 1
        fresh: list[LogRow] = []
        for entry in reversed(self._journal.entries):
            if entry.number < oldest or len(fresh) >= MOST_ROWS:
                break
            if self.filter.admits(entry):
                fresh += reversed(wrap_entry(entry, room))
        rows = kept + fresh[::-1]
        lost += max(0, len(rows) - MOST_ROWS)
        self.rows = rows[-MOST_ROWS:]
        self.virtual_size = Size(self._width, len(self.rows))
        if follows:
            self._show_end()
        elif lost:
            self.scroll_to(y=max(0, self.scroll_target_y - lost), animate=False, immediate=True)
        self.refresh()

    def render_line(self, y: int) -> Strip:
        """Return one visible line."""
        palette = self.palette
        ground = Style(bgcolor=palette.ground)
        index = y + self.scroll_offset.y
        if index >= len(self.rows):
            return Strip.blank(self.size.width, ground)
        row = self.rows[index]
        entry = row.entry
        begins = row.line == 0 and row.start == 0
        quiet = Style(color=palette.quiet)
        style = palette.of_severity(entry.severity if entry.name or RANK[entry.severity] > 1 else "debug")
        head = Text()
        if self._width >= CLOCK_FROM:
            clock = time.strftime("%H:%M:%S ", time.localtime(entry.time))
            head.append(clock if begins else " " * len(clock), quiet)
        name = short_name(entry.name, self._name_cells) if begins and entry.name else ("ur" if begins else "")
        head.append(set_cell_size(name, self._name_cells), quiet)
        head.append(" ▌ " if RANK[entry.severity] > 1 else "   ", style)
        line = Text.from_ansi(entry.lines[row.line]) if "\x1b" in entry.lines[row.line] else Text(entry.lines[row.line])
        line = line[row.start : row.end]
        line.style = style
        if entry.count > 1 and begins and row.end == len(strip_styles(entry.lines[0])):
            line.append(f"  \u00d7{entry.count}", quiet)
        head.append_text(line)
        head.no_wrap = True
        segments = [Segment(text, ground + (part or Style.null())) for text, part, _ in head.render(self.app.console)]
        return Strip(segments).adjust_cell_length(self.size.width, ground)
