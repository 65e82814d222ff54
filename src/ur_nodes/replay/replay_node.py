"""The node `replay`: publishes the messages of a recording, with the clock of the recording."""

import sys

from ur_nodes.replay.playback import ReplayNode
from ur_nodes.run import run


def main() -> int:
    """Run the node until it ends; exit code 2 when the recording cannot be read."""
    return run("replay", ReplayNode)


if __name__ == "__main__":
    sys.exit(main())
