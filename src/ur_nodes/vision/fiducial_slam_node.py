"""Builds a map of fiducials, or finds the robot on one: the node fiducial_slam, with its topics and parameters.

It takes the corners of fiducials (`fiducial_vertices`) rather than their poses (`fiducial_transforms`): only corners
tell how sure a pose is, and that a second one explains them as well.
"""

from __future__ import annotations

import math
import sys
import threading
from collections import Counter
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from sensor_msgs.msg import CameraInfo
from std_srvs.srv import Empty, EmptyRequest, EmptyResponse, Trigger, TriggerRequest, TriggerResponse
from visualization_msgs.msg import MarkerArray

from ur.source.diagnostic import UserError, error
from ur_nodes.codecs.genpy.fiducials import message_classes
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.rigid import Floats, from_pose, to_angles
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.frames import Frames
from ur_nodes.rosio.geometry import pose_message, pose_of_message
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.publishers import TransformSender
from ur_nodes.rosio.shell import run_node
from ur_nodes.vision.detect import CameraModel, Sizes, estimate_poses
from ur_nodes.vision.fiducial_map import MapEntry, read_map, write_map
from ur_nodes.vision.fiducial_parameters import SlamSettings, read_sizes, read_slam_settings
from ur_nodes.vision.image_message import read_camera
from ur_nodes.vision.localise import Localiser
from ur_nodes.vision.mapping import Mapper
from ur_nodes.vision.marker_message import make_markers
from ur_nodes.vision.observation import Observation, make_observation
from ur_nodes.vision.search import without_twins

_PIXEL_NOISE = 0.5
_SHOW_EVERY = 1.0  # s between maps that are published
_SAVE_EVERY = 10.0  # s between maps that are written
_WRONG = 20  # pictures in which something is wrong with a fiducial, before it is logged
_PLANAR = (3, 4, 2)  # x, y, heading among rotation and translation


class FiducialSlam:
    """Takes each set of corners when the frames at its time are known, newest first.

    While the robot's place is not known there is no transform, so that a navigator that depends on it stops.
    """

    def __init__(self, settings: SlamSettings, sizes: Sizes, known: tuple[MapEntry, ...], start: Pose2 | None) -> None:
        self._settings, self._sizes = settings, sizes
        self._lock = threading.RLock()
        self._camera: CameraModel | None = None
        self._waiting: Any = None
        self._correction: Pose2 | None = None
        self._saved = 0
        self._changes = 0
        self._known = known
        self._wrong: Counter[int] = Counter()
        self._estimator: Mapper | Localiser = (
            Localiser(known, start=start, spread_limit=settings.spread_limit)
            if settings.read_only
            else Mapper(known, start=start)
        )
        self._transforms = TransformSender(queue=10)
        self._pose: Any = rospy.Publisher("fiducial_pose", PoseWithCovarianceStamped, queue_size=1)
        self._markers: Any = rospy.Publisher("fiducials", MarkerArray, queue_size=1, latch=True)
        self._map: Any = rospy.Publisher(
            "fiducial_map", message_classes("FiducialMapEntryArray")[0], queue_size=1, latch=True
        )
        self._frames = Frames(self._try, frozenset({settings.odom_frame}))
        rospy.Subscriber("camera_info", CameraInfo, self._take_info, queue_size=1)
        rospy.Subscriber("fiducial_vertices", message_classes("FiducialArray")[0], self._take, queue_size=1)
        rospy.Subscriber("initialpose", PoseWithCovarianceStamped, self._place, queue_size=1)
        rospy.Service("clear_map", Empty, self._clear)
        rospy.Service("save_map", Trigger, self._save_now)
        if settings.read_only:
            rospy.Service("global_localization", Empty, self._forget)
        rospy.Timer(rospy.Duration.from_sec(settings.interval), lambda _: self._publish_tf(), reset=True)
        rospy.Timer(rospy.Duration.from_sec(_SHOW_EVERY), lambda _: self._show(), reset=True)
        rospy.Timer(rospy.Duration.from_sec(_SAVE_EVERY), lambda _: self._save(), reset=True)
        rospy.on_shutdown(self._save)
        self._show(always=True)

    def _take_info(self, message: CameraInfo) -> None:
        self._camera = read_camera(message)

    @quiet_at_end
    def _take(self, message: Any) -> None:
        with self._lock:
            self._waiting = message
        self._try()

    @quiet_at_end
    def _try(self) -> None:
        """Use what was seen last, if the frames at that time are known by now."""
        settings = self._settings
        with self._lock:
            message = self._waiting
            if message is None or self._camera is None:
                return
            odometry = self._frames.find(settings.odom_frame, settings.base_frame, message.header.stamp)
            mount = self._frames.find(settings.base_frame, message.header.frame_id, rospy.Time(0))
            if odometry is None or mount is None:
                return
            self._waiting = None
            observed = [self._observe(each, self._camera, from_pose(mount)) for each in message.fiducials]
            self._update(message.header.stamp, odometry.planar(), [each for each in observed if each])

    def _observe(self, fiducial: Any, camera: CameraModel, mount: Floats) -> Observation | None:
        number = fiducial.fiducial_id
        if number in self._sizes.ignored:
            return None
        corners = np.array([[getattr(fiducial, f"{axis}{corner}") for axis in "xy"] for corner in range(4)])
        size = self._sizes.special.get(number, self._sizes.usual)
        found = estimate_poses(corners, size, camera, _PIXEL_NOISE)
        poses = [(each.pose, each.error, each.covariance) for each in found]
        return make_observation(number, mount, poses, _PIXEL_NOISE) if poses else None

    def _update(self, stamp: rospy.Time, odometry: Pose2, observed: list[Observation]) -> None:
        seen, twins = without_twins(observed)
        self._name(twins, "is often twice in one picture, expected each number once; it is overlooked there")
        known_before = self._estimator.robot(odometry) is not None
        changed = self._estimator.add(odometry, seen)
        robot = self._estimator.robot(odometry)
        self._name(
            self._estimator.contradicting,
            "is not where the map has it, expected it there: it was moved, or hangs twice; it is overlooked",
        )
        if changed and isinstance(self._estimator, Mapper):
            self._changes += 1
        if robot is None:
            self._correction = None
            if known_before:
                rospy.logwarn("lost: what is seen does not fit, or nothing was seen for long; looking for the robot")
            return
        if not known_before:
            rospy.loginfo("the robot is at %.2f %.2f, %.0f degrees", robot.x, robot.y, math.degrees(robot.yaw))
        self._correction = robot.compose(odometry.inverse())
        self._publish_tf()
        if changed:
            message = PoseWithCovarianceStamped()
            message.header.stamp, message.header.frame_id = stamp, self._settings.map_frame
            message.pose.pose = pose_message(robot)
            message.pose.covariance = self._covariance(robot)
            self._pose.publish(message)

    def _name(self, numbers: Collection[int], what: str) -> None:
        """Log once for each fiducial that something is wrong with it, when that has been so for long."""
        self._wrong.update(numbers)
        for number in sorted(numbers):
            if self._wrong[number] == _WRONG:
                rospy.logwarn("fiducial %d %s", number, what)

    def _covariance(self, robot: Pose2) -> list[float]:
        """Row-major 6 x 6 along the axes of the map."""
        if isinstance(self._estimator, Localiser):
            planar = self._estimator.covariance
        else:
            planar = self._estimator.covariance()[np.ix_(_PLANAR, _PLANAR)]
        c, s = math.cos(robot.yaw), math.sin(robot.yaw)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        whole = np.zeros((6, 6))
        whole[np.ix_((0, 1, 5), (0, 1, 5))] = turn @ planar @ turn.T
        flat: list[float] = whole.ravel().tolist()
        return flat

    @quiet_at_end
    def _publish_tf(self) -> None:
        settings, correction = self._settings, self._correction
        if correction is not None and settings.publish_tf:
            stamp = rospy.Time.now() + rospy.Duration.from_sec(settings.future)
            self._transforms.send(stamp, (settings.map_frame, settings.odom_frame, correction))

    def _place(self, message: PoseWithCovarianceStamped) -> None:
        frame = message.header.frame_id.lstrip("/")
        if not isinstance(self._estimator, Localiser) or frame != self._settings.map_frame:
            wanted = f"one in frame {self._settings.map_frame!r} while the map is only read (~read_only_map)"
            rospy.logwarn("initialpose in frame %r is of no use now, expected %s", frame, wanted)
            return
        with self._lock:
            self._estimator.place(pose_of_message(message.pose.pose))

    def _forget(self, _request: EmptyRequest) -> EmptyResponse:
        """Find the robot anew, wherever it is: the service that amcl has."""
        with self._lock:
            if isinstance(self._estimator, Localiser):
                self._estimator.forget()
                self._correction = None
        return EmptyResponse()

    def _clear(self, _request: EmptyRequest) -> EmptyResponse:
        """Forget the map; the robot's pose stays."""
        if self._settings.read_only:
            raise rospy.ServiceException("the map is only read (~read_only_map), expected a map that is being built")
        with self._lock:
            assert isinstance(self._estimator, Mapper)
            here = self._estimator.last or Pose2(0.0, 0.0, 0.0)
            self._estimator = Mapper(start=here)
            self._changes += 1
        return EmptyResponse()

    def _save_now(self, _request: TriggerRequest) -> TriggerResponse:
        try:
            count = self._write()
        except UserError as problem:
            return TriggerResponse(success=False, message=str(problem))
        return TriggerResponse(success=True, message=f"{count} fiducials written to {self._settings.map_file}")

    def _save(self) -> None:
        if self._settings.read_only or self._saved == self._changes:
            return
        try:
            self._write()
        except UserError as problem:
            rospy.logerr_throttle(60.0, str(problem))

    def _write(self) -> int:
        with self._lock:
            self._saved = self._changes
            if isinstance(self._estimator, Mapper):
                self._estimator.refine()
                entries = self._estimator.entries()
            else:
                entries = self._known
        write_map(self._settings.map_file, entries)
        return len(entries)

    @quiet_at_end
    def _show(self, *, always: bool = False) -> None:
        wanted = self._markers.get_num_connections() or self._map.get_num_connections()
        if not always and (self._settings.read_only or not wanted):
            return
        with self._lock:
            if isinstance(self._estimator, Mapper):
                poses = dict(self._estimator.fiducials)
            else:
                poses = {entry.id: entry.pose for entry in self._known}
        sizes = {number: self._sizes.special.get(number, self._sizes.usual) for number in poses}
        self._markers.publish(make_markers(poses, sizes, self._settings.map_frame))
        array, element = message_classes("FiducialMapEntryArray")
        self._map.publish(
            array(
                [
                    element(number, *pose[:3, 3].tolist(), *map(math.degrees, to_angles(pose)))
                    for number, pose in sorted(poses.items())
                ]
            )
        )


def start() -> None:
    """Read parameters and map, and begin. Raises UserError."""
    own = Parameters()
    settings = read_slam_settings(own)
    initial = own.text("initial_map_file", "")
    source = Path(initial).expanduser() if initial else settings.map_file
    known = read_map(source) if initial or settings.read_only or source.is_file() else ()
    if settings.read_only and not known:
        raise UserError(error(f"{source}: no fiducials in it, expected a map that was built before", rule="bad-map"))
    place = Pose2(
        own.number("initial_pose_x", 0.0), own.number("initial_pose_y", 0.0), own.number("initial_pose_a", 0.0)
    )
    FiducialSlam(settings, read_sizes(own), known, None if known else place)


def main() -> int:
    """Run the node. Returns the exit code."""
    return run_node("fiducial_slam", start)


if __name__ == "__main__":
    sys.exit(main())
