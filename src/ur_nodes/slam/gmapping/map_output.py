"""Draws the map of a mapping node, publishes it, and serves it on request."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ur_nodes.calibration_reports import CalibrationReports
from ur_nodes.geometry.calibration import MotionCalibration
from ur_nodes.geometry.difference import describe_poses
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap
from ur_nodes.ports.values import Map, MapInfo, Result
from ur_nodes.slam.gmapping.settings import GmappingSettings
from ur_nodes.slam.gmapping.slam import Slam, SlamStep
from ur_nodes.slam.gyro import Headings
from ur_nodes.slam.map_state import MapState
from ur_nodes.slam.occupancy import OccupancyMap

_SCANS = 20  # over which both motions are compared
_LEAST = (0.15, 0.3)  # m, rad: smaller differences are usual
_SHARE = 0.5  # of the distance by odometry: likewise


@dataclass(frozen=True, slots=True)
class Slip:
    """The same motion as odometry `reported` it and as the scans have `shown` it."""

    reported: Pose2
    shown: Pose2


class SlipWatch:
    """Compares the motions between scans by odometry and by the scans."""

    def __init__(self) -> None:
        self._steps: deque[tuple[Pose2, Pose2]] = deque(maxlen=_SCANS)

    def forget(self) -> None:
        """Restart, for example after a scan whose motion is uncertain."""
        self._steps.clear()

    def add(self, reported: Pose2, shown: Pose2) -> Slip | None:
        """Add the motion between two scans; returns a detected slip, and then restarts."""
        self._steps.append((reported, shown))
        whole = Pose2(0.0, 0.0, 0.0)
        other = Pose2(0.0, 0.0, 0.0)
        for by_wheels, by_scans in self._steps:
            whole, other = whole.compose(by_wheels), other.compose(by_scans)
        apart = math.hypot(whole.x - other.x, whole.y - other.y)
        turned = abs(wrap_angle(whole.yaw - other.yaw))
        if apart <= max(_LEAST[0], _SHARE * math.hypot(whole.x, whole.y)) and turned <= _LEAST[1]:
            return None
        self._steps.clear()
        return Slip(whole, other)


SLIP_SILENCE = 30.0  # s between two reports of wheels that slip


class SlamReports:
    """Logs changes from scan to scan. `describe` is called with places on the map that look alike."""

    def __init__(self, node: Node, describe: Callable[[Sequence[Pose2]], None], *, lost: bool) -> None:
        """`lost`: the initial state."""
        self._node, self._log = node, node.log
        self._describe = describe
        self._located, self._lost, self._places = True, lost, 0  # as reported last
        self._slip = SlipWatch()
        self._calibration, self._reports = MotionCalibration(), CalibrationReports(node)
        self._slip_due = 0
        self._last: Pose2 | None = None  # odometry at the last scan
        self._by_gyro = self._gyro_wrong = False  # as reported last

    def on_step(self, step: SlamStep) -> None:
        """Report the changes after a scan."""
        estimate = step.estimate
        if step.lost or self._lost:
            self._report_search(step)
        elif self._located and not estimate.located:
            share = 100.0 * estimate.agreement
            self._log.warn(f"the scan does not match the map ({share:.0f} % of it); the map goes on by odometry alone")
        elif estimate.located and not self._located:
            self._log.info("the scan matches the map again")
        self._located, self._lost = estimate.located or step.lost, step.lost
        self._watch_wheels(step)

    def watch_gyro(self, headings: Headings) -> None:
        """Report whether the gyroscope is used, and one that contradicts the scans."""
        if headings.trusted != self._by_gyro:
            self._by_gyro = headings.trusted
            source = f"the gyroscope on {self._node.resolve('imu')} turns" if self._by_gyro else "the wheels turn"
            self._log.info(f"{source} as the scans show: the robot's turns come from there")
        if headings.contradicted and not self._gyro_wrong:
            self._gyro_wrong = True
            topic = self._node.resolve("imu")
            self._log.warn(f"the yaw rates on {topic} contradict the scans and are not used; is its frame right?")

    def _report_search(self, step: SlamStep) -> None:
        if not step.lost:
            self._log.info("found again at ({:.2f}, {:.2f})".format(*step.estimate.pose[:2]))
            self._places = 0
            return
        if not self._lost:
            self._log.warn("lost: looking for the place on the map; drive slowly through places that are mapped")
        if len(step.poses) not in (0, self._places):
            self._describe(step.poses)
        self._places = len(step.poses)

    def _watch_wheels(self, step: SlamStep) -> None:
        last, self._last = self._last, step.odometry
        estimate = step.estimate
        if estimate.still:
            return
        if not step.odometry or not last or not estimate.step or step.lost:
            self._slip.forget()
            self._calibration.forget()
            return
        reported = last.inverse().compose(step.odometry)
        if step.mount:
            self._calibration.add(reported, estimate.step)
            self._reports.figures = self._calibration.figures(step.mount)
        slip = self._slip.add(reported, estimate.step)
        now = self._node.now()
        if slip and not self._slip_due - SLIP_SILENCE * SECOND < now < self._slip_due:
            self._slip_due = now + round(SLIP_SILENCE * SECOND)
            self._log.warn(
                "the wheels slip, or the robot is pushed: odometry reports {:.2f} m and {:.0f} degrees, the scans "
                "{:.2f} m and {:.0f} degrees; the map follows the scans".format(*_sizes(slip.reported, slip.shown))
            )


def _sizes(*motions: Pose2) -> list[float]:
    """Return the distance (m) and the turn (degrees) of each motion."""
    return [size for each in motions for size in (math.hypot(each.x, each.y), math.degrees(each.yaw))]


SCANS = "scans"
"""The lane of all that uses the mapper."""

_DRAWING = "map"


class GridMapOutput:
    """The topics `map` and `map_metadata`, latched, and the service `dynamic_map`. Drawing never delays a scan."""

    def __init__(self, node: Node, settings: GmappingSettings, slam: Slam) -> None:
        self._node, self._settings, self._slam = node, settings, slam
        self._busy = False
        self._drawn = OccupancyMap(settings.delta, settings.occ_thresh, settings.max_usable or float("inf"))
        if settings.edges:
            self._drawn.include(settings.edges[:2], settings.edges[2:])
        self._map = node.publish("map", Map, Quality.LATCHED)
        self._info = node.publish("map_metadata", MapInfo, Quality.LATCHED)
        node.serve_later("dynamic_map", AskMap, self._answer)
        self._timer = node.every(settings.map_update_interval, self.publish)

    def use(self, settings: GmappingSettings) -> None:
        """Use changed settings, and publish at once."""
        self._settings = settings
        self._drawn.threshold = settings.occ_thresh
        self._timer.cancel()
        self._timer = self._node.every(settings.map_update_interval, self.publish)
        self.publish()

    def publish(self) -> None:
        """Draw the changes, and publish the map; nothing is published before the first keyframe."""
        if not self._busy:
            self._busy = True
            self._picture(self._publish)

    def describe(self, poses: Sequence[Pose2]) -> None:
        """Log what would distinguish places on the map."""

        def compare(grid: Grid) -> None:
            text = "drive to another room"
            self._node.work(lambda: describe_poses(grid, poses, text), self._node.log.warn, _DRAWING)

        self.state(lambda state: self.draw(state, compare))

    def state(self, callback: Callable[[MapState], None]) -> None:
        """Pass the present map to `callback`."""
        self._node.work(self._slam.state, callback, SCANS)

    def draw(self, state: MapState, callback: Callable[[Grid], None]) -> None:
        """Pass the picture of a map with at least one keyframe to `callback`."""
        self._node.work(lambda: self._draw(state), callback, _DRAWING)

    def _picture(self, callback: Callable[[Grid | None], None]) -> None:
        self.state(lambda state: self.draw(state, callback) if state.poses else callback(None))

    def _draw(self, state: MapState) -> Grid:
        self._drawn.update(state.poses, state.scans, state.drives)
        return self._drawn.grid()

    def _publish(self, grid: Grid | None) -> None:
        self._busy = False
        if grid:
            now = self._node.now()
            self._map.send(Map(now, self._settings.map_frame, grid))
            self._info.send(MapInfo(now, grid.resolution, grid.width, grid.height, grid.origin))

    def _answer(self, _request: AskMap, give: Callable[[Result], None]) -> None:
        missing = Result(False, "there is no map yet; is the lidar driver running?")
        frame = self._settings.map_frame
        self._picture(lambda grid: give(Result(True, value=Map(self._node.now(), frame, grid)) if grid else missing))
