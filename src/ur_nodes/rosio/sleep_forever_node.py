"""A node that does nothing: while it runs, so do its launch file and its master."""

from __future__ import annotations

import sys

from ur_nodes.rosio.shell import run_node


def start() -> None:
    """Nothing."""


if __name__ == "__main__":
    sys.exit(run_node("sleep_forever", start))
