"""Calibrates a camera with a printed chessboard; the terminal shows where views are missing."""

from __future__ import annotations

import os
import select
import sys
import threading
import time
from typing import Any

import rospy
from sensor_msgs.msg import CompressedImage
from sensor_msgs.srv import SetCameraInfo

from ur.source.ansi import is_plain
from ur.source.diagnostic import UserError, error
from ur_nodes.camera.calibration.board import Board
from ur_nodes.camera.calibration.coverage import advise
from ur_nodes.camera.calibration.session import Session, describe, describe_progress, draw_overlay
from ur_nodes.camera.calibration.solve import Result, solve
from ur_nodes.camera.camera_info_message import make_camera_info
from ur_nodes.pictures.decode import BadPictureError, Pixels, decode_picture, fit_picture
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.silence import SilenceMonitor
from ur_nodes.teleop.camera.picture_screen import draw_picture_screen
from ur_nodes.teleop.terminal.foreground_node import run_in_foreground
from ur_nodes.teleop.terminal.keys import Key, decode_keys
from ur_nodes.teleop.terminal.raw import Terminal, own_terminal

_NAME = "calibrate_camera"
_SILENT = 3.0  # s
_LINE_EVERY = 10.0  # s between two lines that say the same
_PAUSE = 0.05  # s
_SERVICE_SECONDS = 5.0
_FEWEST = 3  # views with which `c` calibrates


class Pictures:
    """The newest picture of a camera, and why there is none."""

    def __init__(self, camera: str) -> None:
        self.topic = rospy.resolve_name(camera) + "/image/compressed"
        self._newest: Any = None
        self._since = time.monotonic()
        self._silence = SilenceMonitor(self.topic)
        self._subscriber = rospy.Subscriber(self.topic, CompressedImage, self._take, queue_size=1, buff_size=1 << 24)

    def take(self) -> Pixels | None:
        """The newest picture, once."""
        message, self._newest = self._newest, None
        if message is None:
            return None
        try:
            return decode_picture(message.data)
        except BadPictureError as problem:
            rospy.logwarn_throttle(10.0, f"{self.topic}: {problem}")
            return None

    def explain_silence(self) -> str:
        """Explain why no picture comes; '' while pictures come."""
        silent = time.monotonic() - self._since
        if silent < _SILENT:
            self._silence.stop()
            return ""
        reason = self._silence.explain(int(self._subscriber.get_num_connections()))
        return f"no picture on {self.topic}" + (f": {reason}" if reason else "")

    def _take(self, message: Any) -> None:
        self._newest, self._since = message, time.monotonic()


def main() -> int:
    """Run until the calibration is stored, or until q, Ctrl-C or shutdown. Returns the exit code."""
    return run_in_foreground(_NAME, _run)


def _run(ended: threading.Event) -> int:
    own = Parameters()
    camera = own.text("camera", "raspicam_node")
    board = Board(
        own.integer("columns", 8, minimum=3),
        own.integer("rows", 6, minimum=3),
        own.number("square", 0.025, minimum=0.001, maximum=1.0),
    )
    session, pictures = Session(board), Pictures(camera)
    if sys.stdin.isatty() and sys.stdout.isatty() and not is_plain(os.environ):
        rich = os.environ.get("COLORTERM", "") in ("truecolor", "24bit")
        with own_terminal(sys.stdin.fileno(), sys.stdout.fileno()) as terminal:
            complete = show_session(terminal, session, pictures, ended, rich=rich)
    else:
        complete = write_session(session, pictures, ended, sys.stdin.fileno())
    if not complete:
        sys.stdout.write(f"no calibration: ended after {len(session.views)} views; nothing was changed\n")
        return 130 if ended.is_set() else 1
    result = solve(session.views, board, "camera")
    if result is None or result.problem:
        reason = result.problem if result else f"{len(session.views)} views have no solution: take more, all tilted"
        raise UserError(error(f"the camera is not calibrated, nothing was changed: {reason}", rule="bad-calibration"))
    sys.stdout.write(describe_result(result) + "\n")
    sys.stdout.write(store_result(result, camera) + "\n")
    return 0


def show_session(
    terminal: Terminal, session: Session, pictures: Pictures, ended: threading.Event, *, rich: bool
) -> bool:
    """Draw picture and progress until the views are complete or `c` is pressed; False after q or Ctrl-C."""
    rest, picture = b"", None
    while not ended.is_set() and not session.coverage.is_complete:
        fresh = pictures.take()
        columns, rows = terminal.size()
        if fresh is not None:
            session.look(fresh)
            picture = fit_picture(draw_overlay(fresh, session), columns, 2 * max(1, rows - 2))
        notice = pictures.explain_silence()
        advice = advise(session.coverage), "c calibrates" if len(session.views) >= _FEWEST else ""
        status = describe_progress(session)
        terminal.show(draw_picture_screen(picture, status, columns, rows, rich=rich, notice=notice, advice=advice))
        data = terminal.read(_PAUSE)
        if data is None:
            return False
        events, rest = decode_keys(rest + data, final=not data)
        for event in events:
            if isinstance(event, Key) and (event.name in ("q", "Q", "escape") or (event.name == "c" and event.ctrl)):
                return False
            if isinstance(event, Key) and event.name == "c" and len(session.views) >= _FEWEST:
                return True
    return session.coverage.is_complete


def write_session(session: Session, pictures: Pictures, ended: threading.Event, source: int) -> bool:
    """Write a line for each change until the views are complete; False when `q` is read from a descriptor."""
    written, due, reading = "", 0.0, True
    while not ended.is_set() and not session.coverage.is_complete:
        fresh = pictures.take()
        if fresh is not None:
            session.look(fresh)
        line = pictures.explain_silence() or describe(session)
        now = time.monotonic()
        if line != written or now >= due:
            sys.stdout.write(line + "\n")
            sys.stdout.flush()
            written, due = line, now + _LINE_EVERY
        if not reading:
            ended.wait(_PAUSE)
        elif select.select([source], [], [], _PAUSE)[0]:
            data = os.read(source, 1024)
            if b"q" in data:
                return False
            reading = bool(data)
    return session.coverage.is_complete


def describe_result(result: Result) -> str:
    """A calibration and its quality in two lines."""
    matrix = result.calibration.camera_matrix
    return (
        f"reprojection error {result.error:.2f} pixels from {result.used} of {result.given} views;"
        f" focal length uncertain by {100 * result.deviation:.2f} %\n"
        f"focal lengths {matrix[0]:.1f} and {matrix[4]:.1f} pixels, centre {matrix[2]:.1f} {matrix[5]:.1f},"
        f" pictures of {result.calibration.width} x {result.calibration.height}"
    )


def store_result(result: Result, camera: str) -> str:
    """Have the camera's node use and keep a calibration; its answer. Raises UserError."""
    service = rospy.resolve_name(camera) + "/set_camera_info"
    calibration = result.calibration
    message = make_camera_info(calibration, calibration.width, calibration.height, "")
    try:
        rospy.wait_for_service(service, _SERVICE_SECONDS)
        answer = rospy.ServiceProxy(service, SetCameraInfo)(message)
    except (rospy.ROSException, rospy.ServiceException) as problem:
        raise UserError(
            error(f"{service}: {problem}, expected the service of a real camera's node", rule="no-service")
        ) from None
    if not answer.success:
        raise UserError(error(f"{service}: {answer.status_message}", rule="bad-calibration"))
    return str(answer.status_message)


if __name__ == "__main__":
    sys.exit(main())
