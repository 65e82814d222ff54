"""The local costmap alone: the stand-in for costmap_2d_node, of a scan and of sonars."""

import sys
from collections import deque
from functools import partial

from ur_nodes.costmap.costmap import occupancy_of_costs
from ur_nodes.costmap.layers import Beams, beams_of_scan, level_beams
from ur_nodes.costmap.local_costmap_settings import LocalCostmapSettings, read_settings
from ur_nodes.costmap.rolling_costmap import RollingCostmap
from ur_nodes.costmap.sonar import beams_of_range
from ur_nodes.costmap.touched import BumperSource, TouchMarks, touched_points
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.transform_tree import ExtrapolationError, TransformError, TransformTree
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import ScanFeed
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import Map, Outline, Range, Scan
from ur_nodes.run import run

_WAITING = 100  # scans and ranges that are not worked in yet
_ODOMETRY_PATIENCE = 0.5  # s for which data wait for the odometry of their time


class LocalCostmap:
    """Collects data and works them in with `update`. `robot` is its newest pose, None before the first update."""

    def __init__(self, settings: LocalCostmapSettings, frames: TransformTree) -> None:
        self.robot: Pose2 | None = None
        self._settings = settings
        self._frames = frames
        self._costmap = RollingCostmap(settings.side, settings.resolution, settings.reach, settings.inflation)
        self._marks = TouchMarks()
        self._last = 0.0  # s: when the places of marks were seen last
        self._waiting: deque[tuple[str, float, Beams]] = deque(maxlen=_WAITING)

    def on_scan(self, scan: Scan, _odometry: Pose2 | None) -> None:
        """Keep a scan for the next update."""
        beams = beams_of_scan(scan, inf_is_valid=self._settings.inf_is_valid)
        self._waiting.append((scan.frame, seconds_of(scan.stamp), beams))

    def on_range(self, sonar: Range) -> None:
        """Keep a range for the next update."""
        beams = beams_of_range(sonar.range, sonar.field_of_view, sonar.range_min, sonar.range_max)
        self._waiting.append((sonar.frame, seconds_of(sonar.stamp), beams))

    def on_bumper(self, bumper: BumperSource, pressed: bool) -> None:
        """Mark what a pressed bumper touches."""
        if pressed and self.robot is not None:
            points = touched_points(self._settings.footprint.outline, (0.0, 0.0, 0.0), bumper)
            self._marks.add(self.robot.transform_points(points))
            self._costmap.touched = self._marks.points

    def update(self, now: float) -> list[str]:
        """Work in what has come, at a time in s. Return what could not be worked in, for the log."""
        settings = self._settings
        taken = [self._waiting.popleft() for _ in range(len(self._waiting))]
        try:
            robot = self._frames.pose(settings.frame, settings.base_frame)
        except TransformError as problem:
            return [f"no costmap: {problem}"]
        problems = []
        for frame, stamp, beams in taken:
            try:
                sensor = self._frames.lookup(settings.frame, frame, stamp)
            except TransformError as problem:
                late = isinstance(problem, ExtrapolationError) and problem.ahead
                if late and now - stamp < _ODOMETRY_PATIENCE:
                    self._waiting.append((frame, stamp, beams))  # the odometry of that moment has not arrived yet
                else:
                    problems.append(f"data of {frame} ignored: {problem}")
                continue
            place, level = level_beams(sensor, beams)
            self._costmap.update(robot, place, level)
            passed, self._last = min(max(stamp - self._last, 0.0), 0.5), stamp
            self._marks.look(robot, settings.footprint.circumscribed, place, level, passed)
            self._costmap.touched = self._marks.points
        self.robot = robot
        return problems

    def grid(self) -> Grid:
        """The costs as an occupancy grid, 0 to 100."""
        costmap = self._costmap.inflated()
        return Grid(occupancy_of_costs(costmap.costs), costmap.resolution, costmap.origin)


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
        ScanFeed(node, settings.frame, settings.base_frame, costmap.on_scan, topic=settings.scan)
    for topic in settings.sonars:
        node.subscribe(topic, Range, costmap.on_range, Quality.EVERY)
    for bumper in settings.bumpers:
        node.subscribe(bumper.topic, bool, partial(costmap.on_bumper, bumper), Quality.LATCHED)
    node.every(1.0 / settings.update_frequency, update)
    node.every(1.0 / settings.publish_frequency, publish)


def main() -> int:
    """Run the node until it ends."""
    return run("costmap_node", start)


if __name__ == "__main__":
    sys.exit(main())
