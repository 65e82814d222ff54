"""A node beside the robot: prints a line for each velocity that it really has, and for each goal that is held or not.

    ubiquity_launches/lib/node witness.py

A line is JSON: [monotonic s, m/s, rad/s], or [monotonic s, state], the state of `hold` of navigation.
"""

from __future__ import annotations

import json
import sys
import threading
import time

from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Odometry
from ur_nodes.run import attach


def say(*values: object) -> None:
    """Print a line with the time."""
    sys.stdout.write(json.dumps([time.monotonic(), *values]) + "\n")
    sys.stdout.flush()


def start(node: Node) -> None:
    """Subscribe."""
    node.subscribe(
        "base_pose_ground_truth", Odometry, lambda seen: say(seen.twist.forward, seen.twist.turn), Quality.EVERY
    )
    node.subscribe("move_base/hold", str, lambda text: say(json.loads(text)["state"]), Quality.LATCHED)


def main() -> None:
    """Print until the end of the middleware."""
    ended = threading.Event()
    with attach("witness", start, ended.set):
        ended.wait()


if __name__ == "__main__":
    main()
