"""Show the pictures of a topic on a terminal, or describe them in lines, until the user ends it."""

import sys
import threading
import time
from typing import Protocol

from ur_nodes.pictures.decode import BadPictureError, Pixels, fit_picture
from ur_nodes.pictures.feed import FeedView, decode_view
from ur_nodes.teleop.camera.picture_screen import describe_feed, describe_silence, draw_picture_screen
from ur_nodes.teleop.terminal.keys import leaves_view
from ur_nodes.teleop.terminal.raw import QuitKey, RawTerminal

_POLL = 0.05  # s
_STATUS_EVERY = 0.5  # s: the status changes though no picture arrives
_REDRAW_ALL = 2.0  # s: other programs may have written on the screen
_LINE_EVERY = 2.0  # s
_REASON_EVERY = 10.0  # s between two lines with the same reason


class Feed(Protocol):
    """The pictures of a topic."""

    @property
    def view(self) -> FeedView:
        """Return the newest picture, and what is known of the feed."""


def show_pictures(terminal: RawTerminal, feed: Feed, ended: threading.Event, period: float, *, rich: bool) -> None:
    """Draw each picture, at most one every `period` s, until q or Ctrl-C is pressed or `ended` is set."""
    shown, drawn_at, redrawn_at = -1, 0.0, 0.0
    while not ended.is_set():
        now, view = time.monotonic(), feed.view
        since = now - drawn_at
        if since >= _STATUS_EVERY or (view.number != shown and since >= period):
            again = now - redrawn_at > _REDRAW_ALL
            redrawn_at = now if again else redrawn_at
            terminal.show(draw_view(view, *terminal.size(), rich=rich), again=again)
            shown, drawn_at = view.number, now
        wait = drawn_at + period - time.monotonic()
        keys = terminal.read_keys(min(wait, _POLL) if wait > 0.0 else _POLL)
        if keys is None or any(map(leaves_view, keys)):
            return


def draw_view(view: FeedView, columns: int, rows: int, *, rich: bool) -> list[str]:
    """Return lines with the newest picture and its status, or the reason why there is none."""
    pixels: Pixels | None = None
    notice = describe_silence(view)
    try:
        pixels = decode_view(view, (columns, 2 * (rows - 1)))
    except BadPictureError as problem:
        notice = notice or f"{view.topic}: {problem}"
    if pixels is not None:
        pixels = fit_picture(pixels, columns, 2 * (rows - 1))
    return draw_picture_screen(pixels, describe_feed(view), columns, rows, rich=rich, notice=notice)


def write_lines(feed: Feed, ended: threading.Event, source: int) -> None:
    """Write lines until `ended` is set or `q` is read from a file descriptor."""
    quit_key, lines = QuitKey(source), FeedLines()
    while not ended.is_set():
        if line := lines.step(feed.view, time.monotonic()):
            sys.stdout.write(line + "\n")
            sys.stdout.flush()
        if quit_key.wait(_POLL, ended):
            return


class FeedLines:
    """Chooses lines about pictures: one every 2 s, and while none arrives one for each reason, repeated every 10 s."""

    def __init__(self) -> None:
        self._reported = ""
        self._due = 0.0

    def step(self, view: FeedView, now: float) -> str:
        """Return the line that is due at `now` (s); empty for none."""
        line = describe_silence(view) or describe_feed(view)
        subject = view.reason or ("pictures" if view.picture else line)
        repeats = now >= self._due and (view.reason or view.picture)
        if not repeats and subject == self._reported:
            return ""
        self._reported, self._due = subject, now + (_REASON_EVERY if view.reason else _LINE_EVERY)
        return line
