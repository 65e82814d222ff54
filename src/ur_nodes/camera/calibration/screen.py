"""Collect views of the board, with their progress on a terminal or in lines, until they suffice."""

import sys
import threading
import time

from ur_nodes.camera.calibration.session import CalibrationSession, advise, describe, describe_progress, draw_overlay
from ur_nodes.pictures.decode import BadPictureError, Pixels, fit_picture
from ur_nodes.pictures.feed import decode_view
from ur_nodes.teleop.camera.picture_screen import draw_picture_screen
from ur_nodes.teleop.camera.viewer import Feed
from ur_nodes.teleop.terminal.keys import Key, leaves_view
from ur_nodes.teleop.terminal.raw import QuitKey, RawTerminal

_LINE_EVERY = 10.0  # s between two lines that say the same
_PAUSE = 0.05  # s
_FEWEST = 3  # views with which `c` calibrates


class Views:
    """Takes each picture of a feed into a session, once."""

    def __init__(self, feed: Feed, session: CalibrationSession) -> None:
        self.session = session
        self._feed = feed
        self._number = 0
        self._problem = ""

    def pop(self) -> Pixels | None:
        """Search the newest picture for the board and return that picture; None if it was taken before."""
        view = self._feed.view
        if view.number == self._number:
            return None
        self._number, self._problem = view.number, ""
        try:
            pixels = decode_view(view)
        except BadPictureError as problem:
            self._problem = f"{view.topic}: {problem}"
            return None
        if pixels is not None:
            self.session.look(pixels)
        return pixels

    def explain_silence(self) -> str:
        """Return the reason why no picture arrives, or that the last one is damaged; '' while pictures arrive."""
        view = self._feed.view
        if not view.silent:
            return self._problem
        return f"no picture on {view.topic}" + (f": {view.reason}" if view.reason else "")


def show_session(terminal: RawTerminal, views: Views, ended: threading.Event, *, rich: bool) -> bool:
    """Draw picture and progress until the views are complete or `c` is pressed; False after q or Ctrl-C."""
    session, picture = views.session, None
    while not ended.is_set() and not session.coverage.is_complete:
        pixels = views.pop()
        columns, rows = terminal.size()
        if pixels is not None:
            picture = fit_picture(draw_overlay(pixels, session), columns, 2 * max(1, rows - 2))
        enough = len(session.views) >= _FEWEST
        advice = advise(session.coverage), "c calibrates" if enough else ""
        status, notice = describe_progress(session), views.explain_silence()
        terminal.show(draw_picture_screen(picture, status, columns, rows, rich=rich, notice=notice, advice=advice))
        keys = terminal.read_keys(_PAUSE)
        if keys is None or any(map(leaves_view, keys)):
            return False
        if enough and any(isinstance(key, Key) and key.name == "c" for key in keys):
            return True
    return session.coverage.is_complete


def write_session(views: Views, ended: threading.Event, source: int) -> bool:
    """Write a line for each change until the views are complete; False when `q` is read from a descriptor."""
    session, quit_key = views.session, QuitKey(source)
    written, due = "", 0.0
    while not ended.is_set() and not session.coverage.is_complete:
        views.pop()
        line = views.explain_silence() or describe(session)
        now = time.monotonic()
        if line != written or now >= due:
            sys.stdout.write(line + "\n")
            sys.stdout.flush()
            written, due = line, now + _LINE_EVERY
        if quit_key.wait(_PAUSE, ended):
            return False
    return session.coverage.is_complete
