"""The node `amcl`: localisation on a known map, from odometry and a lidar."""

from __future__ import annotations

import sys

from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.amcl import Amcl
from ur_nodes.localisation.amcl_output import AmclOutputs
from ur_nodes.localisation.amcl_settings import read_settings
from ur_nodes.localisation.map_source import MapSource
from ur_nodes.memory_use import return_large_arrays
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import ScanFeed
from ur_nodes.ports.services import SetInitialPose, Silent, UseMap
from ur_nodes.ports.values import Map, PoseEstimate, Result, Scan
from ur_nodes.run import run


class AmclNode:
    """Connects an `Amcl` to topics."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._settings = settings = node.parameters.follow(read_settings, lambda changed: self._amcl.use(changed))
        self._amcl = Amcl(settings, node.log)
        self._outputs = AmclOutputs(node, settings)
        node.transforms.ignore((settings.odom_frame,))
        self._feed = ScanFeed(node, settings.odom_frame, settings.base_frame, self._use_scan)
        node.subscribe("initialpose", PoseEstimate, self._place, Quality.EVERY)
        node.serve("global_localization", Silent, lambda _request: self._amcl.scatter())
        node.serve("request_nomotion_update", Silent, lambda _request: self._amcl.request_update())
        node.serve("set_map", UseMap, self._set_map)
        node.serve("set_initial_pose", SetInitialPose, self._set_pose)
        self._source = MapSource(node, self._take_map, topic=settings.use_map_topic)

    def _take_map(self, given: Map) -> None:
        if not (self._settings.first_map_only and self._amcl.has_map):
            self._amcl.use_map(given)

    def _set_map(self, request: UseMap) -> Result:
        self._amcl.use_map(request.map)
        self._place(PoseEstimate(request.stamp, request.frame, request.pose, request.covariance))
        return Result(success=True)

    def _set_pose(self, request: SetInitialPose) -> Result:
        self._place(request.estimate)
        return Result(success=True)

    def _place(self, given: PoseEstimate) -> None:
        before, now = self._feed.odometry(given.stamp), self._feed.odometry()
        known = given.stamp and before and now  # else the odometry does not reach back so far
        moved = before.inverse().compose(now) if known and before and now else Pose2(0.0, 0.0, 0.0)
        self._amcl.place(given, moved)

    def _use_scan(self, scan: Scan, odometry: Pose2 | None) -> None:
        mount = self._feed.mount(scan.frame)
        if mount and odometry and self._amcl.has_map:
            estimate = self._amcl.update(scan, mount, odometry)
            self._outputs.publish_lost(self._amcl.lost)
            if estimate:
                self._outputs.publish_estimate(estimate, self._amcl.particles, scan.stamp)
            if self._amcl.correction:
                self._outputs.publish_correction(self._amcl.correction, scan.stamp)
            self._outputs.save_sometimes()


def main() -> int:
    """Run until shutdown; exit code 2 when a parameter cannot be used."""
    return_large_arrays()
    return run("amcl", AmclNode)


if __name__ == "__main__":
    sys.exit(main())
