"""Show a camera's pictures in the terminal; without a terminal, describe in lines how they come, or why none does."""

from __future__ import annotations

import os
import select
import sys
import threading
import time
from typing import Any

import rospy
from sensor_msgs.msg import CompressedImage, Image

from ur.source.ansi import is_plain
from ur_nodes.pictures.decode import BadPictureError, Pixels, decode_picture, fit_picture, read_size, unpack_picture
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.silence import SilenceMonitor
from ur_nodes.teleop.camera.picture_screen import Feed, describe_feed, describe_silence, draw_picture_screen
from ur_nodes.teleop.terminal.foreground_node import run_in_foreground
from ur_nodes.teleop.terminal.keys import Key, decode_keys
from ur_nodes.teleop.terminal.raw import Terminal, own_terminal

_NAME = "image_terminal"
_LINE_EVERY = 2.0  # s
_REASON_EVERY = 10.0  # s between two lines with the same reason
_ESCAPE_WAIT = 0.05  # s: a sequence's bytes come together


class Camera:
    """The newest picture of a topic and how its pictures come. Nothing is decoded before it is shown."""

    def __init__(self, image: str, transport: str) -> None:
        """`transport` is `compressed` (the topic `IMAGE/compressed`) or `raw`."""
        kind = CompressedImage if transport == "compressed" else Image
        topic = rospy.resolve_name(image) + ("/compressed" if transport == "compressed" else "")
        self.feed = Feed(topic, time.monotonic())
        self.fresh = threading.Event()
        self._newest: Any = None
        self._silence = SilenceMonitor(topic)
        self._subscriber = rospy.Subscriber(topic, kind, self._take, queue_size=1, buff_size=1 << 24)

    @property
    def publishers(self) -> int:
        """Return the number of publishers of the topic."""
        return int(self._subscriber.get_num_connections())

    def why_silent(self, now: float) -> str:
        """Return why no picture comes, as far as it is known; empty while pictures come."""
        if self.feed.is_silent(now):
            return self._silence.explain(self.publishers)
        self._silence.stop()
        return ""

    def _take(self, message: Any) -> None:
        try:
            size = read_size(message.data) if hasattr(message, "format") else (message.width, message.height)
        except BadPictureError as problem:
            rospy.logwarn_throttle(10.0, f"{self.feed.topic}: {problem}")
            return
        self._newest = message
        self.feed.take(time.monotonic(), size, len(message.data))
        self.fresh.set()

    def look(self, columns: int, rows: int) -> Pixels | None:
        """The newest picture, fitted into a box of pixels; None before the first and for one that is broken."""
        message = self._newest
        if message is None:
            return None
        try:
            if hasattr(message, "format"):
                pixels = decode_picture(message.data, (columns, rows))
            else:
                pixels = unpack_picture(message.data, message.width, message.height, message.step, message.encoding)
        except BadPictureError as problem:
            rospy.logwarn_throttle(10.0, f"{self.feed.topic}: {problem}")
            return None
        return fit_picture(pixels, columns, rows)


def main() -> int:
    """Run until q, Ctrl-C or shutdown. Returns the exit code."""
    return run_in_foreground(_NAME, _run)


def _run(ended: threading.Event) -> int:
    own = Parameters()
    camera = Camera(
        own.text("image", "raspicam_node/image"), own.text("transport", "compressed", choices=["compressed", "raw"])
    )
    most = own.number("rate_limit", 15.0, minimum=0.5, maximum=100.0)
    if sys.stdin.isatty() and sys.stdout.isatty() and not is_plain(os.environ):
        rich = os.environ.get("COLORTERM", "") in ("truecolor", "24bit")
        with own_terminal(sys.stdin.fileno(), sys.stdout.fileno()) as terminal:
            show_pictures(terminal, camera, ended, 1.0 / most, rich=rich)
    else:
        write_lines(camera, ended, sys.stdin.fileno())
    return 0


def show_pictures(terminal: Terminal, camera: Camera, ended: threading.Event, period: float, *, rich: bool) -> None:
    """Draw what comes, every `period` s at the most, until q or Ctrl-C is pressed or `ended` is set."""
    rest, again_at = b"", 0.0
    while not ended.is_set():
        now = time.monotonic()
        columns, rows = terminal.size()
        again = now > again_at  # other programs may have written on the screen
        again_at = now + 2.0 if again else again_at
        camera.fresh.clear()
        picture = camera.look(columns, 2 * (rows - 1))
        status = describe_feed(camera.feed, camera.publishers, time.monotonic())
        notice = describe_silence(camera.feed, camera.why_silent(now), now)
        terminal.show(draw_picture_screen(picture, status, columns, rows, rich=rich, notice=notice), again=again)
        due = max(now + period, time.monotonic())
        while not ended.is_set() and ((left := due - time.monotonic()) > 0.0 or not camera.fresh.is_set()):
            data = terminal.read(max(_ESCAPE_WAIT, left))
            if data is None:
                return
            events, rest = decode_keys(rest + data, final=not data)
            if any(_quits(event) for event in events if isinstance(event, Key)):
                return
            if left < -0.5:
                break  # the status line changes though nothing comes


def _quits(key: Key) -> bool:
    return key.name in ("q", "Q", "escape") or (key.name == "c" and key.ctrl)


def write_lines(camera: Camera, ended: threading.Event, source: int) -> None:
    """Write a line every two seconds until `ended` is set or `q` is read from a file descriptor.

    While nothing comes there is a line when the reason changes, and every ten seconds.
    """
    reported, reading = "", True
    due = 0.0
    while not ended.is_set():
        now = time.monotonic()
        reason = camera.why_silent(now)
        line = describe_silence(camera.feed, reason, now) or describe_feed(camera.feed, camera.publishers, now)
        subject = reason or ("pictures" if camera.feed.times else line)
        if (now >= due and (reason or camera.feed.times)) or (subject != reported and line):
            sys.stdout.write(line + "\n")
            sys.stdout.flush()
            reported, due = subject, now + (_REASON_EVERY if reason else _LINE_EVERY)
        if not reading:
            ended.wait(_ESCAPE_WAIT)
        elif select.select([source], [], [], _ESCAPE_WAIT)[0]:
            data = os.read(source, 1024)
            if b"q" in data:
                return
            reading = bool(data)


if __name__ == "__main__":
    sys.exit(main())
