"""Calibrates a camera with a printed chessboard; the terminal shows where views are missing."""

from __future__ import annotations

import os
import signal
import sys
import threading
from dataclasses import dataclass

from ur.source.ansi import has_true_colour, is_plain
from ur_nodes.camera.calibration.board import Board
from ur_nodes.camera.calibration.screen import Views, show_session, write_session
from ur_nodes.camera.calibration.session import CalibrationSession
from ur_nodes.camera.calibration.solve import describe_result, solve_or_fail
from ur_nodes.camera.calibration.store import CalibrationClient
from ur_nodes.pictures.feed import PictureFeed
from ur_nodes.ports.node import Node
from ur_nodes.run import run_foreground
from ur_nodes.teleop.terminal.raw import own_terminal

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
