"""For the tests of slam_gmapping: the simulator in lock step, and questions answered line by line (JSON)."""

from __future__ import annotations

import math
import threading
from typing import Any

import rospy
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64
from tests.json_client import answer_requests, claim_output
from tests.ur_nodes.ros1_client import stamped_transform
from tf2_msgs.msg import TFMessage

from ur.robot.base import load_base
from ur.source.project import launch_library
from ur.worlds.world_file import read_world
from ur_nodes.codecs.geometry import pose3_of_transform
from ur_nodes.codecs.maps import grid_of_message
from ur_nodes.geometry.pose import Pose2
from ur_nodes.simulator.simulation import Simulation

PATIENCE = 30.0  # s


class SlamClient:
    """A robot in the maze that moves only when told; every scan waits until it has been used."""

    def __init__(self) -> None:
        self._base = load_base(launch_library(), "stage", "")
        world = read_world(launch_library() / "n_simulator" / "worlds" / "maze.yaml")
        self._simulation = Simulation(world, self._base, seed=1)
        self._used = 0
        self._correction: Pose2 | None = None
        self._news = threading.Condition()
        self._tf = rospy.Publisher("/tf", TFMessage, queue_size=100)
        self._static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        self._scan = rospy.Publisher("scan", LaserScan, queue_size=5)
        rospy.Subscriber("/tf", TFMessage, self._take_tf, queue_size=100)
        rospy.Subscriber("slam_gmapping/entropy", Float64, self._take_entropy, queue_size=100)
        assert self._base.lidar
        laser = Pose2(self._base.lidar.pose[0], self._base.lidar.pose[1], self._base.lidar.pose[5])
        placed = stamped_transform("base_footprint", "laser", laser, rospy.Time.now())
        self._static.publish(TFMessage([placed]))

    def drive(self, linear: float, angular: float, seconds: float) -> float:
        """Drive; the distance (m) between the true pose and the published one at the end."""
        self._wait(lambda: all(each.get_num_connections() > 0 for each in (self._scan, self._tf)))
        end = self._simulation.time + seconds
        while self._simulation.time < end:
            self._simulation.command(0, linear, angular)
            if "scan" in self._simulation.advance().due:
                self._publish()
        return self._error()

    def map(self) -> dict[str, Any]:
        """The frames of the map from service and topic, its resolution, how many cells are occupied and free."""
        rospy.wait_for_service("dynamic_map", PATIENCE)
        message = rospy.ServiceProxy("dynamic_map", GetMap)().map
        topic = rospy.wait_for_message("map", OccupancyGrid, PATIENCE)
        metadata = rospy.wait_for_message("map_metadata", MapMetaData, PATIENCE)
        values = grid_of_message(message).values
        return {
            "frames": [message.header.frame_id, topic.header.frame_id],
            "resolution": round(metadata.resolution, 6),
            "occupied": int((values == 100).sum()),
            "free": int((values == 0).sum()),
        }

    def _publish(self) -> None:
        before = self._used
        odometry = Pose2(*self._simulation.odometry(0).pose)
        ranges = self._simulation.scan(0).tolist()
        deadline = rospy.get_time() + PATIENCE
        while True:  # the node may not be connected yet
            stamp = rospy.Time.now()
            self._tf.publish(TFMessage([stamped_transform("odom", "base_footprint", odometry, stamp)]))
            self._scan.publish(self._message(ranges, stamp))
            with self._news:
                if self._news.wait_for(lambda: self._used != before, 1.0):
                    return
            if rospy.get_time() > deadline:
                raise TimeoutError("the scan was not used")

    def _message(self, ranges: list[float], stamp: rospy.Time) -> LaserScan:
        lidar = self._base.lidar
        assert lidar
        message = LaserScan(angle_min=lidar.angle_min, angle_max=lidar.angle_max)
        message.angle_increment = (lidar.angle_max - lidar.angle_min) / (lidar.samples - 1)
        message.header.frame_id, message.header.stamp = "laser", stamp
        message.range_min, message.range_max, message.ranges = lidar.range_min, lidar.range_max, ranges
        return message

    def _error(self) -> float:
        """Once the transform as of the last scan is published: it comes again and again, so the second one is."""
        for _ in range(2):
            with self._news:
                self._correction = None
                if not self._news.wait_for(lambda: self._correction is not None, PATIENCE):
                    raise TimeoutError("map -> odom was not published")
                found = self._correction
        assert found
        found = found.compose(Pose2(*self._simulation.odometry(0).pose))
        return math.dist(found[:2], self._simulation.pose(0)[:2])

    def _take_entropy(self, _message: Float64) -> None:
        with self._news:
            self._used += 1
            self._news.notify_all()

    def _take_tf(self, message: TFMessage) -> None:
        with self._news:
            for item in message.transforms:
                if item.header.frame_id == "map" and item.child_frame_id == "odom":
                    self._correction = pose3_of_transform(item.transform).planar()
                    self._news.notify_all()

    @staticmethod
    def _wait(condition: Any) -> None:
        end = rospy.get_time() + PATIENCE
        while not condition():
            if rospy.get_time() > end:
                raise TimeoutError("nothing subscribes scan")
            rospy.sleep(0.02)


def main() -> None:
    """Answer questions on standard input until it ends."""
    answers = claim_output()
    rospy.init_node("client", disable_signals=True)
    answer_requests(answers, SlamClient())


if __name__ == "__main__":
    main()
