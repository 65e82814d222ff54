"""The node `record`: writes topics to MCAP files until it ends, or the disk is nearly full."""

import sys

from ur_nodes.recorder.topic_recording import RecordNode
from ur_nodes.run import run


def main() -> int:
    """Run the node until it ends."""
    return run("record", RecordNode)


if __name__ == "__main__":
    sys.exit(main())
