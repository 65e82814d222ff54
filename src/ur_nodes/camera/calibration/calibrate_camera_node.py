"""Calibrates a camera with a printed chessboard; the terminal shows where views are missing."""

import os
import signal
import sys
import threading
from dataclasses import dataclass

from ur.source.ansi import has_true_colour, is_plain
from ur.source.diagnostic import user_error
from ur_nodes.camera.calibration.board import Board
from ur_nodes.camera.calibration.screen import Views, show_session, write_session
from ur_nodes.camera.calibration.session import CalibrationSession
from ur_nodes.camera.calibration.solve import describe_result, solve_or_fail
from ur_nodes.pictures.feed import PictureFeed
from ur_nodes.ports.node import Node
from ur_nodes.ports.services import UseCalibration
from ur_nodes.ports.values import Calibration, Result
from ur_nodes.run import run_foreground
from ur_nodes.teleop.terminal.raw import own_terminal

_LIMIT = 5.0  # s
_POLL = 0.02  # s


class CalibrationClient:
    """Calls `CAMERA/set_camera_info`, for a user interface."""

    def __init__(self, node: Node, camera: str) -> None:
        self._node = node
        self._service = node.resolve(camera) + "/set_camera_info"
        self._result: Result | None = None

    def keep(self, calibration: Calibration, ended: threading.Event) -> str | None:
        """Let the camera's node use and store a calibration; return its answer, None if `ended` is set before.

        Not for the node's thread. Raises UserError.
        """
        request = UseCalibration(calibration)
        self._node.post(lambda: self._node.call(self._service, request, self._on_result, _LIMIT))
        while (result := self._result) is None:
            if ended.wait(_POLL):
                return None
        if not result.success:
            raise user_error(
                f"the calibration is not stored: {self._service}: {result.text}",
                rule="bad-calibration",
                help="is the camera's node running? That of a simulated camera stores no calibration",
            )
        return result.text

    def _on_result(self, result: Result) -> None:
        self._result = result


_INTERRUPTED = 128 + signal.SIGINT


@dataclass(frozen=True, slots=True)
class Calibrator:
    """The pictures of a camera, the views of the board in them, and the camera's store."""

    feed: PictureFeed
    session: CalibrationSession
    store: CalibrationClient


def start(node: Node) -> Calibrator:
    """Read the parameters and subscribe."""
    own = node.parameters
    camera = own.text("camera", "raspicam_node")
    board = Board(
        own.integer("columns", 8, minimum=3),
        own.integer("rows", 6, minimum=3),
        own.number("square", 0.025, minimum=0.001, maximum=1.0),
    )
    return Calibrator(PictureFeed(node, f"{camera}/image"), CalibrationSession(board), CalibrationClient(node, camera))


def calibrate(wired: Calibrator, ended: threading.Event) -> int:
    """Run until the calibration is stored, or until q, Ctrl-C or the end of the node. Returns the exit code."""
    session, views = wired.session, Views(wired.feed, wired.session)
    if sys.stdin.isatty() and sys.stdout.isatty() and not is_plain(os.environ):
        with own_terminal(sys.stdin.fileno(), sys.stdout.fileno()) as terminal:
            complete = show_session(terminal, views, ended, rich=has_true_colour(os.environ))
    else:
        complete = write_session(views, ended, sys.stdin.fileno())
    if not complete:
        sys.stdout.write(f"no calibration: ended after {len(session.views)} views; nothing was changed\n")
        return _INTERRUPTED if ended.is_set() else 1
    result = solve_or_fail(session.views, session.board)
    sys.stdout.write(describe_result(result) + "\n")
    if (answer := wired.store.keep(result.calibration, ended)) is None:
        return _INTERRUPTED
    sys.stdout.write(answer + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(run_foreground("calibrate_camera", start, calibrate))
