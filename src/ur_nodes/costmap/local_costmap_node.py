"""The local costmap alone: the stand-in for costmap_2d_node, of a scan and of sonars."""

from __future__ import annotations

import sys

from ur_nodes.costmap.local_costmap import LocalCostmap
from ur_nodes.costmap.local_costmap_settings import read_settings
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, Outline, Range, Scan
from ur_nodes.run import run

_QUIET = 10  # s from the start, as on a small computer a base starts later than this node, and between two warnings


def start(node: Node) -> None:
    """Subscribe, update the costmap, and publish while it has subscribers."""
    settings = read_settings(node.parameters.below("costmap"))
    costmap = LocalCostmap(settings, node.transforms)
    grids = node.publish("~costmap/costmap", Map)
    outlines = node.publish("~costmap/footprint", Outline)
    quiet_until = node.now() + _QUIET * SECOND

    def update() -> None:
        nonlocal quiet_until
        for problem in costmap.update(node.now() / SECOND):
            if node.now() > quiet_until:
                quiet_until = node.now() + _QUIET * SECOND
                node.log.warn(problem)

    def publish() -> None:
        if costmap.robot is None:
            return
        if grids.subscribers():
            grids.send(Map(node.now(), settings.frame, costmap.grid()))
        if outlines.subscribers():
            outlines.send(Outline(node.now(), settings.frame, settings.footprint.outline_at(costmap.robot)))

    if settings.scan:
        node.subscribe(settings.scan, Scan, costmap.on_scan)
    for topic in settings.sonars:
        node.subscribe(topic, Range, costmap.on_range, Quality.EVERY)
    node.every(1.0 / settings.update_frequency, update)
    node.every(1.0 / settings.publish_frequency, publish)


def main() -> int:
    """Run the node until it ends."""
    return run("costmap_node", start)


if __name__ == "__main__":
    sys.exit(main())
