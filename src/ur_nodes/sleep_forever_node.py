"""A node that does nothing: while it runs, so do its launch file and its master."""

import sys

from ur_nodes.run import run

if __name__ == "__main__":
    sys.exit(run("sleep_forever", lambda _node: None))
