"""A robot that slides straight to its goals over a small empty map: for tests of programs that send goals."""

from __future__ import annotations

import math

import actionlib
import rospy
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import OccupancyGrid, Path
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.geometry import pose_message, pose_of_message, transform_message

STEP = 0.05  # s
SPEED = 4.0  # m/s
SIDE = 100  # cells of 0.1 m, the origin in the middle


class FakeRobot:
    def __init__(self) -> None:
        self.pose = Pose2(0.0, 0.0, 0.0)
        self.tf = rospy.Publisher("tf", TFMessage, queue_size=10)
        self.scan = rospy.Publisher("scan", LaserScan, queue_size=1)
        self.plan = rospy.Publisher("move_base/NavfnROS/plan", Path, queue_size=1)
        self.current = rospy.Publisher("move_base/current_goal", PoseStamped, queue_size=1)
        self.map = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
        self.map.publish(make_map())
        rospy.Subscriber("cmd_vel", Twist, lambda _: None)
        self.server = actionlib.SimpleActionServer("move_base", MoveBaseAction, self.drive, auto_start=False)
        self.server.start()
        rospy.Timer(rospy.Duration(STEP), self.tell)

    def drive(self, goal: MoveBaseGoal) -> None:
        target = pose_of_message(goal.target_pose.pose)
        self.current.publish(goal.target_pose)
        if max(abs(target.x), abs(target.y)) > SIDE * 0.05:
            self.server.set_aborted(text="the goal is off the map")
            return
        start, length = self.pose, math.hypot(target.x - self.pose.x, target.y - self.pose.y)
        self.plan.publish(Path(poses=[PoseStamped(pose=pose_message(p)) for p in (start, target)]))
        steps = max(1, round(length / (SPEED * STEP)))
        for i in range(1, steps + 1):
            if self.server.is_preempt_requested() or rospy.is_shutdown():
                self.server.set_preempted(text="cancelled")
                return
            part = i / steps
            self.pose = Pose2(start.x + part * (target.x - start.x), start.y + part * (target.y - start.y), target.yaw)
            rospy.sleep(STEP)
        self.server.set_succeeded(text="Goal reached.")

    def tell(self, _event: object) -> None:
        now = rospy.Time.now()
        links = [("map", "odom", Pose2(0, 0, 0)), ("odom", "base_footprint", self.pose)]
        links.append(("base_footprint", "laser", Pose2(0.1, 0, 0)))
        message = TFMessage()
        for parent, child, pose in links:
            link = TransformStamped(child_frame_id=child, transform=transform_message(pose))
            link.header.stamp, link.header.frame_id = now, parent
            message.transforms.append(link)
        self.tf.publish(message)
        scan = LaserScan(angle_min=-math.pi, angle_increment=math.pi / 180, range_min=0.1, range_max=10.0)
        scan.header.stamp, scan.header.frame_id = now, "laser"
        scan.ranges = [1.5] * 360
        self.scan.publish(scan)


def make_map() -> OccupancyGrid:
    grid = OccupancyGrid()
    grid.info.width = grid.info.height = SIDE
    grid.info.resolution = 0.1
    grid.info.origin = pose_message(Pose2(-SIDE * 0.05, -SIDE * 0.05, 0.0))
    edge = {0, SIDE - 1}
    grid.data = [100 if row in edge or column in edge else 0 for row in range(SIDE) for column in range(SIDE)]
    return grid


if __name__ == "__main__":
    rospy.init_node("fake_robot")
    ROBOT = FakeRobot()
    rospy.spin()
