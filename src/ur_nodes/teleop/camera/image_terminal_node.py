"""Show a camera's pictures in the terminal; without a terminal, print lines about their rate, or why none arrives."""

import os
import sys
import threading
from dataclasses import dataclass

from ur.source.ansi import has_true_colour, is_plain
from ur_nodes.pictures.feed import PictureFeed
from ur_nodes.ports.node import Node
from ur_nodes.run import run_foreground
from ur_nodes.teleop.camera.viewer import show_pictures, write_lines
from ur_nodes.teleop.terminal.raw import own_terminal


@dataclass(frozen=True, slots=True)
class ImageTerminal:
    """The feed of pictures, and the shortest time between two that are shown (s)."""

    feed: PictureFeed
    period: float


def start(node: Node) -> ImageTerminal:
    """Read the parameters and subscribe."""
    own = node.parameters
    image = own.text("image", "raspicam_node/image")
    packed = own.text("transport", "compressed", choices=["compressed", "raw"]) == "compressed"
    period = 1.0 / own.number("rate_limit", 15.0, minimum=0.5, maximum=100.0)
    return ImageTerminal(PictureFeed(node, image, packed=packed), period)


def show(wired: ImageTerminal, ended: threading.Event) -> int:
    """Show pictures until q, Ctrl-C or the end of the node. Returns the exit code."""
    if sys.stdin.isatty() and sys.stdout.isatty() and not is_plain(os.environ):
        with own_terminal(sys.stdin.fileno(), sys.stdout.fileno()) as terminal:
            show_pictures(terminal, wired.feed, ended, wired.period, rich=has_true_colour(os.environ))
    else:
        write_lines(wired.feed, ended, sys.stdin.fileno())
    return 0


if __name__ == "__main__":
    sys.exit(run_foreground("image_terminal", start, show))
