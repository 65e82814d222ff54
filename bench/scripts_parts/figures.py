"""A script that reads pose and scan, and prints what that costs.

    ubiquity_launches/lib/node figures.py SECONDS

Prints JSON: shares of a processor core of the node alone, of one that receives scans, and of one whose script reads
the pose 30 times a second and the scan 10 times.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable

from ur_nodes.client import Robot

POSES, EVERY = 30.0, 3  # 1/s; each third time the scan, too


def measure(seconds: float, act: Callable[[int], None]) -> float:
    """The share of a core that this process uses while it acts 30 times a second."""
    began, used = time.monotonic(), time.process_time()
    for step in range(round(seconds * POSES)):
        act(step)
        time.sleep(max(0.0, began + (step + 1) / POSES - time.monotonic()))
    return (time.process_time() - used) / (time.monotonic() - began)


def main() -> None:
    """Measure three times in turn, and print the least of each."""
    seconds = float(sys.argv[1])
    with Robot("figures") as robot:
        robot.pose()

        def read(step: int) -> None:
            robot.pose()
            if step % EVERY == 0:
                robot.scan()

        alone = measure(seconds, lambda _: None)
        robot.scan()
        pairs = [(measure(seconds, lambda _: None), measure(seconds, read)) for _ in range(3)]
    receiving, reading = zip(*pairs, strict=True)
    print(json.dumps({"alone": alone, "receiving": receiving, "reading": reading}), flush=True)


if __name__ == "__main__":
    main()
