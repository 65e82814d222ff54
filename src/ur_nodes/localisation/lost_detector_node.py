"""The node `lost_detector`: whether scans fit the map at the pose that another localisation gives, as Nav2's amcl.

`~lost` is true while they do not, sent again and again as a lock of the mux; `~lost_text` is for people. The map has to
be complete: while one is made, scans see what it does not have yet.
"""

import math
import sys

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.geometry.scan import points_of_scan
from ur_nodes.localisation.likelihood import BeamModel, LikelihoodField, make_field
from ur_nodes.localisation.localiser import FOUND, LEAST_BEAMS, LITTLE, LOST, PoseFit, share_through_walls, step_doubt
from ur_nodes.localisation.scan_match import MatchSettings, match_scan
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import ScanFeed
from ur_nodes.ports.values import Map, Scan
from ur_nodes.run import run

_BEAMS = 60
_STEP, _TURN = 0.2, math.pi / 6.0  # m, rad: nearer scans are not judged again while all is well, as amcl does
_SPREAD = np.diag((0.1, 0.1, 0.05)) ** 2  # m, m, rad: by which a pose may be off
_PERIOD = 0.1  # s
_MODEL = BeamModel(0.95, 0.05, 0.2, 2.0)  # upstream's defaults of amcl


class LostDetector:
    """Judges scans at poses on one map. Pure. `lost` is None before the first scan."""

    def __init__(self, field: LikelihoodField) -> None:
        self._field = field
        self._settings = MatchSettings()
        self._at: Pose2 | None = None  # where the last scan was judged; None: the next one is in any case
        self._doubt, self._fits = 0.0, 0
        self.lost: bool | None = None

    def judge(self, pose: Pose2, points: NDArray[np.float64]) -> None:
        """Use a scan: the ends (n, 2) of its beams in the robot's frame, m, and the pose given for its time."""
        if len(points) < LEAST_BEAMS or not self._is_due(pose):
            return
        chosen = points[np.linspace(0, len(points) - 1, min(len(points), _BEAMS)).round().astype(int)]
        match = match_scan(self._field, pose, _SPREAD, chosen, self._settings)
        decisive = self.lost or match.agreement < LITTLE
        through = share_through_walls(self._field.grid, match.pose, chosen) if decisive else 0.0
        fit = PoseFit(match.agreement, through)
        self._doubt = step_doubt(self._doubt, fit)
        self._fits = self._fits + 1 if fit.is_good else 0
        if self.lost:
            self.lost = self._fits < FOUND
            self._doubt *= self.lost
        else:
            self.lost = self._doubt >= LOST
        self._at = None if self.lost or fit.is_contradicted else pose

    def _is_due(self, pose: Pose2) -> bool:
        at = self._at
        return at is None or math.dist(at[:2], pose[:2]) >= _STEP or abs(wrap_angle(at.yaw - pose.yaw)) >= _TURN


class LostDetectorNode:
    """Connects a `LostDetector` to topics."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._detector: LostDetector | None = None
        self._lost: bool | None = None  # as reported last
        self._lock = node.publish("~lost", bool, Quality.LATCHED)
        self._text = node.publish("~lost_text", str, Quality.LATCHED)
        own = node.parameters
        frames = own.text("global_frame_id", "map"), own.text("base_frame_id", "base_link")
        self._feed = ScanFeed(node, *frames, self._on_scan)
        node.subscribe("map", Map, self._on_map, Quality.LATCHED)
        node.every(_PERIOD, self._report, steady=True)

    def _on_map(self, given: Map) -> None:
        self._detector = LostDetector(make_field(given.grid, _MODEL))

    def _on_scan(self, scan: Scan, pose: Pose2 | None) -> None:
        mount = self._feed.mount(scan.frame)
        if self._detector and mount and pose:
            self._detector.judge(pose, points_of_scan(scan, mount, (scan.range_min, scan.range_max)))

    def _report(self) -> None:
        lost = self._detector.lost if self._detector else None
        if lost is None:
            return
        if lost != self._lost:
            text = "lost: the scan does not fit the map here; set the robot's pose" if lost else ""
            self._text.send(text)
            if text or self._lost:
                self._node.log.warn(text or "found: the scan fits the map again")
            self._lost = lost
        self._lock.send(lost)


def main() -> int:
    """Run until shutdown."""
    return run("lost_detector", LostDetectorNode)


if __name__ == "__main__":
    sys.exit(main())
