"""For the tests of slam_gmapping: the simulator in lock step, and questions answered line by line (JSON)."""

from __future__ import annotations

import itertools
import math
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import Quaternion, TransformStamped
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap
from scipy.spatial import cKDTree
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Float64
from tests.json_client import answer_requests, claim_output
from tf2_msgs.msg import TFMessage

from ur.robot.base import load_base
from ur.worlds.world_file import read_world
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.geometry import pose3_of_transform, transform_message
from ur_nodes.rosio.grid_message import grid_of_message
from ur_nodes.simulator.simulation import Simulation

PATIENCE = 30.0  # s
PACKAGE = Path(__file__).resolve().parents[3] / "ubiquity_launches"
UPSIDE_DOWN_YAW = 2.0  # rad: how a lidar that hangs upside down is turned besides


class Client:
    """A robot in the maze that moves only when told; every scan waits until it has been used."""

    def __init__(self, child: str, mount: str = "") -> None:
        """`child` is the frame whose transform from the map is expected; `mount`: `upside-down`, or two `halves`."""
        self._child = child
        self._upside_down, self._halves = mount == "upside-down", mount == "halves"
        self._base = load_base(PACKAGE, "stage", "")
        world = read_world(PACKAGE / "n_simulator" / "worlds" / "maze.yaml")
        self._simulation = Simulation(world, self._base, seed=1)
        plan = world.floor_plan
        floor = Grid(np.where(plan.walls, 100, 0).astype(np.int8), plan.resolution, Pose2(*plan.origin))
        self._walls = cKDTree(floor.points_of_cells(np.argwhere(plan.walls)))
        self._used = 0
        self._begin = rospy.Time.now()
        self._correction: Pose2 | None = None
        self._news = threading.Condition()
        self._tf = rospy.Publisher("/tf", TFMessage, queue_size=100)
        self._static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        self._scan = rospy.Publisher("scan", LaserScan, queue_size=5)
        self._rear = rospy.Publisher("rear_scan", LaserScan, queue_size=5)
        self._imu = rospy.Publisher("imu", Imu, queue_size=50)
        rospy.Subscriber("/tf", TFMessage, self._take_tf, queue_size=100)
        rospy.Subscriber("slam_gmapping/entropy", Float64, self._take_entropy, queue_size=100)
        assert self._base.lidar
        laser = Pose2(self._base.lidar.pose[0], self._base.lidar.pose[1], self._base.lidar.pose[5])
        placed = transform("base_footprint", "laser", laser, rospy.Time.now())
        if self._upside_down:  # rolled by half a turn, then turned
            half = 0.5 * UPSIDE_DOWN_YAW
            placed.transform.rotation = Quaternion(math.cos(half), math.sin(half), 0.0, 0.0)
        self._static.publish(TFMessage([placed]))

    def drive(self, linear: float, angular: float, seconds: float) -> float:
        """Drive; the distance (m) between the true pose and the published one at the end."""
        used = (self._scan, self._tf, *((self._rear, self._imu) if self._halves else ()))
        self._wait(lambda: all(each.get_num_connections() > 0 for each in used))
        end = self._simulation.time + seconds
        while self._simulation.time < end:
            self._simulation.command(0, linear, angular)
            if self._simulation.advance().scan:
                self._publish()
        return self._error()

    def carry(self, x: float, y: float, yaw: float) -> None:
        """Carry the robot elsewhere; its odometry does not notice."""
        self._simulation.place("robot", (x, y, yaw))

    def map(self) -> dict[str, Any]:
        """The frames of the map from service and topic, its resolution, how many cells are occupied and free.

        `on_walls` is the share (0..1) of the occupied cells within 0.1 m of a wall of the world.
        """
        rospy.wait_for_service("dynamic_map", PATIENCE)
        message = rospy.ServiceProxy("dynamic_map", GetMap)().map
        topic = rospy.wait_for_message("map", OccupancyGrid, PATIENCE)
        metadata = rospy.wait_for_message("map_metadata", MapMetaData, PATIENCE)
        grid = grid_of_message(message)
        values = grid.values
        gaps = self._walls.query(grid.points_of_cells(np.argwhere(values == 100)))[0]
        return {
            "frames": [message.header.frame_id, topic.header.frame_id],
            "resolution": round(metadata.resolution, 6),
            "occupied": int((values == 100).sum()),
            "free": int((values == 0).sum()),
            "on_walls": float(np.mean(gaps < 0.1)),
        }

    def _publish(self) -> None:
        before = self._used
        odometry = Pose2(*self._simulation.odometry(0).pose)
        ranges = self._simulation.scan(0).tolist()
        deadline = rospy.get_time() + PATIENCE
        for again in itertools.count():  # the node may not be connected yet
            stamp = self._stamp(again)
            self._tf.publish(TFMessage([transform("odom", "base_footprint", odometry, stamp)]))
            if self._halves:
                self._publish_gyro(stamp)
                self._rear.publish(self._message(hide(ranges, front=True), stamp))
                self._scan.publish(self._message(hide(ranges, front=False), stamp))
            else:
                self._scan.publish(self._message(ranges, stamp))
            with self._news:
                if self._news.wait_for(lambda: self._used != before, 1.0):
                    return
            if rospy.get_time() > deadline:
                raise TimeoutError("the scan was not used")

    def _stamp(self, again: int) -> rospy.Time:
        """The time of a scan that is published `again`: with yaw rates that of the simulator, which they are about."""
        if self._halves:
            return self._begin + rospy.Duration(self._simulation.time + 0.001 * again)
        return rospy.Time.now()

    def _publish_gyro(self, stamp: rospy.Time) -> None:
        message = Imu()
        message.header.frame_id, message.header.stamp = "laser", stamp
        message.angular_velocity.z = self._simulation.odometry(0).velocity[1]
        self._imu.publish(message)

    def _message(self, ranges: list[float], stamp: rospy.Time) -> LaserScan:
        lidar = self._base.lidar
        assert lidar
        message = LaserScan(angle_min=lidar.angle_min, angle_max=lidar.angle_max)
        message.angle_increment = (lidar.angle_max - lidar.angle_min) / (lidar.samples - 1)
        message.header.frame_id, message.header.stamp = "laser", stamp
        message.range_min, message.range_max, message.ranges = lidar.range_min, lidar.range_max, ranges
        if self._upside_down:  # angles count the other way round
            first, last = (UPSIDE_DOWN_YAW - lidar.pose[5] - end for end in (lidar.angle_max, lidar.angle_min))
            message.angle_min, message.angle_max, message.ranges = first, last, ranges[::-1]
        return message

    def _error(self) -> float:
        """Once the transform as of the last scan is published: it comes again and again, so the second one is."""
        for _ in range(2):
            with self._news:
                self._correction = None
                if not self._news.wait_for(lambda: self._correction is not None, PATIENCE):
                    raise TimeoutError(f"map -> {self._child} was not published")
                found = self._correction
        assert found
        if self._child == "odom":
            found = found.compose(Pose2(*self._simulation.odometry(0).pose))
        return math.dist(found[:2], self._simulation.pose(0)[:2])

    def _take_entropy(self, _message: Float64) -> None:
        with self._news:
            self._used += 1
            self._news.notify_all()

    def _take_tf(self, message: TFMessage) -> None:
        with self._news:
            for item in message.transforms:
                if item.header.frame_id == "map" and item.child_frame_id == self._child:
                    self._correction = pose3_of_transform(item.transform).planar()
                    self._news.notify_all()

    @staticmethod
    def _wait(condition: Any) -> None:
        end = rospy.get_time() + PATIENCE
        while not condition():
            if rospy.get_time() > end:
                raise TimeoutError("nothing subscribes scan")
            rospy.sleep(0.02)


def hide(ranges: list[float], *, front: bool) -> list[float]:
    """The scan of a lidar all round that something hides the front, or the rear, of."""
    quarter = len(ranges) // 4
    kept = set(range(quarter, 3 * quarter)) if not front else {*range(quarter), *range(3 * quarter, len(ranges))}
    return [distance if index in kept else math.inf for index, distance in enumerate(ranges)]


def transform(parent: str, child: str, pose: Pose2, stamp: rospy.Time) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id, message.header.stamp = parent, child, stamp
    message.transform = transform_message(pose)
    return message


def main() -> None:
    """Answer questions on standard input until it ends."""
    answers = claim_output()
    rospy.init_node("client", disable_signals=True)
    answer_requests(answers, Client(*sys.argv[1:]))


if __name__ == "__main__":
    main()
