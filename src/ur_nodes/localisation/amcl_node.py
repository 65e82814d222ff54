"""The node `amcl`: where the robot is on a known map, from odometry and a lidar."""

from __future__ import annotations

import sys
import threading

import numpy as np
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import SetMap, SetMapRequest, SetMapResponse
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty, EmptyRequest, EmptyResponse

from ur.source.diagnostic import UserError
from ur_nodes.geometry.difference import describe_places
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import Mount, points_of_scan
from ur_nodes.localisation.amcl_output_node import Outputs
from ur_nodes.localisation.amcl_settings import read_settings
from ur_nodes.localisation.likelihood import make_field
from ur_nodes.localisation.localiser import Localiser
from ur_nodes.rosio.freed_memory import return_large_arrays
from ur_nodes.rosio.geometry import pose_of_message
from ur_nodes.rosio.grid_message import GridMessage, GridService, grid_of_message
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.scan_queue import SILENCE, ScanQueue
from ur_nodes.rosio.shell import run_node


class AmclNode:
    """Translates messages for a Localiser. One thread of its own does the work; callbacks only hand things over."""

    def __init__(self) -> None:
        self._parameters = Parameters()
        self._settings = settings = read_settings(self._parameters)
        self._rng = np.random.default_rng(settings.seed)
        self._outputs = Outputs(settings)
        self._localiser: Localiser | None = None
        self._grid: Grid | None = None  # that it works on
        self._places = 0  # that fit, as reported last
        self._work = threading.RLock()  # guards the localiser
        self._queue = ScanQueue(settings.odom_frame, settings.base_frame, frozenset((settings.odom_frame,)))
        rospy.Subscriber("scan", LaserScan, self._queue.add, queue_size=2, tcp_nodelay=True)
        rospy.Subscriber("initialpose", PoseWithCovarianceStamped, self._take_pose, queue_size=2)
        rospy.Service("global_localization", Empty, self._answer_global)
        rospy.Service("request_nomotion_update", Empty, self._answer_update)
        rospy.Service("set_map", SetMap, self._answer_set_map)
        if settings.use_map_topic:
            self._map = rospy.Subscriber("map", GridMessage, self._take_map, queue_size=1)
        self._thread = threading.Thread(target=self._run, name="localise", daemon=True)
        self._thread.start()

    # -- the map ---------------------------------------------------------------------------------------------------

    def _take_map(self, message: OccupancyGrid) -> None:
        with self._work:
            if not (self._settings.first_map_only and self._localiser):
                self._use_map(message)

    def _use_map(self, message: OccupancyGrid) -> bool:
        """Start on a map. The pose on the last one is kept if there was one. False if the map cannot be used."""
        frame = message.header.frame_id.lstrip("/")
        if frame != self._settings.map_frame:
            rospy.logwarn("map in frame %r, expected ~global_frame_id, %r", frame, self._settings.map_frame)
        try:
            grid: Grid = grid_of_message(message)
        except UserError as problem:
            rospy.logerr("%s", problem)
            return False
        with self._work:
            localiser = Localiser(make_field(grid, self._settings.beams), self._settings.filter, self._rng)
            start = self._outputs.last
            if start:
                localiser.place(start.pose, start.covariance)
            else:
                localiser.place(self._settings.initial_pose, self._settings.initial_covariance)
            self._localiser, self._grid = localiser, grid
        rospy.loginfo("map of %d x %d cells of %g m", grid.width, grid.height, grid.resolution)
        return True

    def _fetch_map(self) -> None:
        """Ask the service `static_map` until it returns a map; log the wait once in a while."""
        while not rospy.is_shutdown() and not self._localiser:
            message = _call_static_map()
            if message and not self._use_map(message):
                return  # the service will not change its mind; set_map may still bring another

    def _answer_set_map(self, request: SetMapRequest) -> SetMapResponse:
        with self._work:
            done = self._use_map(request.map)
            if done:
                self._place(request.initial_pose)
        return SetMapResponse(success=done)

    # -- requests of the user---------------------------------------------------------------------------------------

    def _take_pose(self, message: PoseWithCovarianceStamped) -> None:
        frame = message.header.frame_id.lstrip("/")
        if frame and frame != self._settings.map_frame:
            rospy.logwarn("initialpose in frame %r ignored, expected %r", frame, self._settings.map_frame)
            return
        self._place(message)

    def _place(self, message: PoseWithCovarianceStamped) -> None:
        pose = pose_of_message(message.pose.pose).compose(self._moved_since(message.header.stamp))
        covariance = np.reshape(message.pose.covariance, (6, 6))[np.ix_((0, 1, 5), (0, 1, 5))]
        with self._work:
            if self._localiser and np.isfinite(pose).all() and np.isfinite(covariance).all():
                self._localiser.place(pose, covariance)
                rospy.loginfo("placed at x %.2f m, y %.2f m, yaw %.2f rad", *pose)
            else:
                rospy.logwarn("initialpose ignored, expected a map first and finite numbers")

    def _moved_since(self, stamp: rospy.Time) -> Pose2:
        """Return the robot's motion since a stamp; none when the odometry does not reach back so far."""
        before, now = self._queue.odometry(stamp), self._queue.odometry(rospy.Time(0))
        if stamp.is_zero() or not before or not now:
            return Pose2(0.0, 0.0, 0.0)
        return before.inverse().compose(now)

    def _answer_global(self, _request: EmptyRequest) -> EmptyResponse:
        with self._work:
            if not self._localiser or not self._localiser.scatter():
                raise rospy.ServiceException("there is no map with free cells yet, expected one")
        rospy.loginfo("global localisation: the robot may be anywhere")
        return EmptyResponse()

    def _answer_update(self, _request: EmptyRequest) -> EmptyResponse:
        with self._work:
            if self._localiser:
                self._localiser.request_update()
        return EmptyResponse()

    # -- scans -----------------------------------------------------------------------------------------------------

    def _run(self) -> None:
        if not self._settings.use_map_topic:
            self._fetch_map()
        self._queue.serve(self._use_scan)

    def _use_scan(self, scan: LaserScan, odometry: Pose2 | None) -> None:
        assert odometry, "there is always an odometry's frame"
        mount = self._queue.mount(scan.header.frame_id.lstrip("/"))
        with self._work:
            if not mount:
                rospy.logwarn_throttle(
                    SILENCE,
                    f"no transform from {scan.header.frame_id} to {self._settings.base_frame}, expected one",
                )
            if not mount or not self._localiser:
                return
            estimate = self._localiser.update(odometry, self._points(scan, mount))
            stamp = scan.header.stamp
            if estimate:
                self._outputs.publish_estimate(estimate, odometry, self._localiser.particles, stamp)
                self._report_places(self._localiser.places)
            self._outputs.publish_correction(stamp)
        self._outputs.save_sometimes()

    def _report_places(self, places: list[Pose2]) -> None:
        """Log when more than one place fits, with what would tell the best two apart, and when one is left."""
        if len(places) == self._places:
            return
        if places:
            assert self._grid
            rospy.logwarn("%s", describe_places(self._grid, places, "place the robot by hand"))
        else:
            rospy.loginfo("only one place on the map fits now")
        self._places = len(places)

    def _points(self, scan: LaserScan, mount: Mount) -> np.ndarray:
        low, high = self._settings.laser_limits
        limits = (max(low, scan.range_min), min(high, scan.range_max) if high > 0.0 else scan.range_max)
        return points_of_scan(scan, mount, limits)


def _call_static_map() -> OccupancyGrid | None:
    try:
        rospy.wait_for_service("static_map", timeout=5.0)
        return rospy.ServiceProxy("static_map", GridService)().map
    except rospy.ROSInterruptException:
        return None
    except (rospy.ROSException, rospy.ServiceException) as problem:
        rospy.logwarn("no map from service %s yet: %s", rospy.resolve_name("static_map"), problem)
        return None


def main() -> int:
    """Run until shutdown; exit code 2 when a parameter cannot be used."""
    nodes: list[AmclNode] = []
    return_large_arrays()
    return run_node("amcl", lambda: nodes.append(AmclNode()))


if __name__ == "__main__":
    sys.exit(main())
