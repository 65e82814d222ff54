"""The topics of one simulated robot: what stage_ros publishes and subscribes."""

from __future__ import annotations

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Int32

from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.geometry import fill_pose
from ur_nodes.rosio.publishers import Edge, has_subscribers, make_publisher
from ur_nodes.simulator.settings import Settings
from ur_nodes.simulator.simulation import Simulation


class RobotTopics:
    """Publishers and the subscriber of one robot. Messages are made once and filled in again each time.

    Topics without subscribers cost nothing, tf and latched ones aside.
    """

    def __init__(self, simulation: Simulation, robot: int, prefix: str, settings: Settings) -> None:
        """`prefix` is put before topics and frames: '' for a single robot, else 'robot_<n>/'."""
        frames, queue = settings.frames, settings.queue_size
        self._simulation = simulation
        self._robot = robot
        self.command: tuple[float, float] | None = None
        lidar = simulation.base.lidar
        self._odom = make_publisher(f"{prefix}odom", Odometry, queue)
        self._truth = make_publisher(f"{prefix}base_pose_ground_truth", Odometry, queue)
        self._joints = make_publisher(f"{prefix}joint_states", JointState, queue)
        self._scan = make_publisher(prefix + lidar.topic, LaserScan, queue) if lidar else None
        self._collisions = rospy.Publisher(f"~{prefix}collisions", Int32, queue_size=1, latch=True)
        self._sent_collisions = -1
        odom, base = prefix + frames.odom, prefix + frames.base
        self._odom_message = _odometry_message(odom, base)
        self._truth_message = _odometry_message(frames.map, base)
        self._joint_message = JointState(name=[f"{prefix}left_wheel_joint", f"{prefix}right_wheel_joint"])
        self._edge = odom, base
        if lidar:
            self._scan_message = LaserScan(
                angle_min=lidar.angle_min,
                angle_max=lidar.angle_max,
                angle_increment=(lidar.angle_max - lidar.angle_min) / (lidar.samples - 1),
                scan_time=1.0 / lidar.rate,
                range_min=lidar.range_min,
                range_max=lidar.range_max,
            )
            self._scan_message.header.frame_id = prefix + lidar.frame
        rospy.Subscriber(f"{prefix}cmd_vel", Twist, self._on_command, queue_size=1, tcp_nodelay=True)

    def _on_command(self, message: Twist) -> None:
        self.command = (message.linear.x, message.angular.z)

    def pass_command_on(self) -> None:
        """Give the newest command to the simulation; called between ticks."""
        command, self.command = self.command, None
        if command is not None:
            self._simulation.command(self._robot, *command)

    def edge(self) -> Edge:
        """The transform odom -> base_footprint, from the odometry of the encoders."""
        return *self._edge, self._simulation.odometry(self._robot).pose

    def publish_odometry(self, stamp: rospy.Time) -> None:
        """Publish the odometry of the encoders, and the ground truth."""
        if has_subscribers(self._odom):
            odometry = self._simulation.odometry(self._robot)
            _fill_pose(self._odom_message, stamp, odometry.pose)
            self._odom_message.pose.covariance = _covariance(odometry.covariance)
            twist = self._odom_message.twist.twist
            twist.linear.x, twist.angular.z = odometry.velocity
            self._odom.publish(self._odom_message)
        if has_subscribers(self._truth):
            _fill_pose(self._truth_message, stamp, self._simulation.pose(self._robot))
            twist = self._truth_message.twist.twist
            twist.linear.x, twist.linear.y, twist.angular.z = self._simulation.velocity(self._robot)
            self._truth.publish(self._truth_message)

    def publish_scan(self, stamp: rospy.Time) -> None:
        """Publish a scan of the lidar, taken in an instant."""
        if self._scan is not None and has_subscribers(self._scan):
            self._scan_message.header.stamp = stamp
            self._scan_message.ranges = self._simulation.scan(self._robot).tolist()
            self._scan.publish(self._scan_message)

    def publish_joints(self, stamp: rospy.Time) -> None:
        """The angles of the wheels, and how fast they turn."""
        if has_subscribers(self._joints):
            self._joint_message.header.stamp = stamp
            self._joint_message.position = self._simulation.wheel_angles(self._robot)
            self._joint_message.velocity = self._simulation.wheel_speeds(self._robot)
            self._joints.publish(self._joint_message)

    def publish_collisions(self, count: int) -> None:
        """Publish the number of collisions of the robot; latched, sent when it changes."""
        if count != self._sent_collisions:
            self._sent_collisions = count
            self._collisions.publish(count)


def _odometry_message(frame: str, child: str) -> Odometry:
    message = Odometry(child_frame_id=child)
    message.header.frame_id = frame
    message.pose.covariance = _covariance((1e-9, 0.0, 0.0, 1e-9, 0.0, 1e-9))
    # Encoders: the speed to about 1 %, no motion sideways, up or over.
    message.twist.covariance = _covariance((1e-4, 0.0, 0.0, 1e-6, 0.0, 1e-3))
    return message


def _fill_pose(message: Odometry, stamp: rospy.Time, pose: Pose2) -> None:
    message.header.stamp = stamp
    fill_pose(message.pose.pose, pose)


def _covariance(planar: tuple[float, ...]) -> list[float]:
    """Row-major 6 x 6 from xx, xy, xw, yy, yw, ww; height, roll and pitch are known: the floor is flat."""
    xx, xy, xw, yy, yw, ww = planar
    known, zero = 1e-9, 0.0
    return [
        *(xx, xy, zero, zero, zero, xw),
        *(xy, yy, zero, zero, zero, yw),
        *(zero, zero, known, zero, zero, zero),
        *(zero, zero, zero, known, zero, zero),
        *(zero, zero, zero, zero, known, zero),
        *(xw, yw, zero, zero, zero, ww),
    ]
