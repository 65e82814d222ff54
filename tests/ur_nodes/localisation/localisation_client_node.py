"""For the tests of map_server and amcl: a robot without physics, and questions answered line by line (JSON)."""

from __future__ import annotations

import math
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
from tests.json_client import answer_requests, claim_output
from tests.ur_nodes.navigation.synthetic import ANGLES, LASER, RANGE_MAX, Drifter, cast_rays
from tests.ur_nodes.ros1_client import stamped_transform
from tf2_msgs.msg import TFMessage

from ur_nodes.codecs.geometry import pose3_of_transform, pose_message
from ur_nodes.geometry.grid import load_map
from ur_nodes.geometry.pose import Pose2

PATIENCE = 30.0  # s


class LocalisationClient:
    """One robot on one map, which moves only when told; every move is published with odometry, then a scan."""

    def __init__(self, map_file: Path) -> None:
        self._grid = load_map(map_file)
        self._rng = np.random.default_rng(1)
        self._robot = Drifter(Pose2(0.0, 0.0, 0.0), self._rng)
        self._corrections: dict[float, Pose2] = {}
        self._news = threading.Condition()
        self._tf = rospy.Publisher("/tf", TFMessage, queue_size=100)
        self._static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        self._scan = rospy.Publisher("scan", LaserScan, queue_size=5)
        self._place = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)
        rospy.Subscriber("/tf", TFMessage, self._take_tf, queue_size=100)
        self._static.publish(TFMessage([stamped_transform("base_footprint", "laser", LASER, rospy.Time.now())]))

    def map(self) -> Any:
        """What the topics and the service say, each as [width, height, resolution, frame, sum of cells]."""
        topic = rospy.wait_for_message("map", OccupancyGrid, PATIENCE)
        again = rospy.wait_for_message("map", OccupancyGrid, PATIENCE)  # latched: a second one gets it, too
        meta = rospy.wait_for_message("map_metadata", MapMetaData, PATIENCE)
        rospy.wait_for_service("static_map", PATIENCE)
        service = rospy.ServiceProxy("static_map", GetMap)().map
        maps = [[m.info.width, m.info.height, m.header.frame_id, sum(m.data)] for m in (topic, again, service)]
        return {"maps": maps, "meta": [meta.width, meta.height, round(meta.resolution, 6)]}

    def initialpose(self, x: float, y: float, yaw: float) -> None:
        """Say where the robot is."""
        message = PoseWithCovarianceStamped()
        message.header.frame_id = "map"
        message.pose.pose = pose_message(Pose2(x, y, yaw))
        covariance = np.zeros((6, 6))
        covariance[0, 0] = covariance[1, 1] = 0.04
        covariance[5, 5] = 0.02
        message.pose.covariance = covariance.ravel().tolist()
        self._wait(lambda: self._place.get_num_connections() > 0, "a subscriber of initialpose")
        self._place.publish(message)

    def search(self) -> None:
        """Call global_localization."""
        rospy.wait_for_service("global_localization", PATIENCE)
        rospy.ServiceProxy("global_localization", Empty)()

    def drive(self, steps: int, distance: float, turn: float) -> list[float]:
        """Move; the error (m) of the published map -> odom, composed with the odometry, after each step."""
        self._wait(lambda: self._scan.get_num_connections() > 0, "a subscriber of scan")
        return [self._step(distance, turn) for _ in range(steps)]

    def cloud(self) -> int:
        """How many particles are shown."""
        return len(rospy.wait_for_message("particlecloud", PoseArray, PATIENCE).poses)

    def pose(self) -> list[Any]:
        """The latched amcl_pose: frame, x, y, variance of x."""
        message = rospy.wait_for_message("amcl_pose", PoseWithCovarianceStamped, PATIENCE)
        at = message.pose.pose.position
        return [message.header.frame_id, at.x, at.y, message.pose.covariance[0]]

    def _step(self, distance: float, turn: float) -> float:
        self._robot.drive(distance, turn)
        end = rospy.get_time() + PATIENCE
        while rospy.get_time() < end:  # amcl may still be waiting for its map: say it again
            stamp = rospy.Time.now()
            self._tf.publish(TFMessage([stamped_transform("odom", "base_footprint", self._robot.odometry, stamp)]))
            self._scan.publish(self._scan_message(stamp))
            key = round((stamp + rospy.Duration(0.1)).to_sec(), 4)
            with self._news:
                if self._news.wait_for(lambda wanted=key: wanted in self._corrections, 1.0):  # type: ignore[misc]
                    found = self._corrections[key].compose(self._robot.odometry)
                    return math.dist(found[:2], self._robot.truth[:2])
        raise TimeoutError("map -> odom was not published")

    def _scan_message(self, stamp: rospy.Time) -> LaserScan:
        ranges = cast_rays(self._grid, self._robot.truth.compose(LASER))
        noisy = ranges + self._rng.normal(0.0, 0.01, len(ranges))
        message = LaserScan(angle_min=ANGLES[0], angle_max=ANGLES[-1], angle_increment=ANGLES[1] - ANGLES[0])
        message.header.frame_id = "laser"
        message.header.stamp = stamp
        message.range_min, message.range_max, message.ranges = 0.1, RANGE_MAX, noisy.tolist()
        return message

    def _take_tf(self, message: TFMessage) -> None:
        with self._news:
            for transform in message.transforms:
                if transform.child_frame_id == "odom":
                    key = round(transform.header.stamp.to_sec(), 4)
                    self._corrections[key] = pose3_of_transform(transform.transform).planar()
            self._news.notify_all()

    @staticmethod
    def _wait(condition: Any, what: str) -> None:
        end = rospy.get_time() + PATIENCE
        while not condition():
            if rospy.get_time() > end:
                raise TimeoutError(what)
            rospy.sleep(0.02)


def main() -> None:
    """Answer questions on standard input until it ends."""
    answers = claim_output()
    rospy.init_node("client", disable_signals=True)
    answer_requests(answers, LocalisationClient(Path(sys.argv[1])))


if __name__ == "__main__":
    main()
