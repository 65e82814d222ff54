"""A node that offers what `move_base` offers to clients of Nav2, and answers that it has been done."""

from __future__ import annotations

import sys

from ur_nodes.ports.node import Node
from ur_nodes.ports.services import ClearCostmap
from ur_nodes.ports.values import Result
from ur_nodes.run import run


def start(node: Node) -> None:
    for each in ("global", "local"):
        service = f"{each}_costmap/clear_entirely_{each}_costmap"
        node.serve(service, ClearCostmap, lambda _request: Result(success=True))


if __name__ == "__main__":
    sys.exit(run("service_server", start))
