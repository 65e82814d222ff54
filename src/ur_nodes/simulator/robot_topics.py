"""The topics of one simulated robot: what stage_ros publishes and subscribes."""

import numpy as np

from ur_nodes.geometry.dead_reckoning import SIDEWAYS_SPEED_COVARIANCE, SPEED_COVARIANCE, covariance_matrix
from ur_nodes.geometry.pose import Pose3, quaternion_of_yaw
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Joints, Odometry, Scan, Transform, Twist
from ur_nodes.simulator.settings import SimulatorSettings
from ur_nodes.simulator.simulation import Simulation
from ur_nodes.simulator.turning_lidar import TurningLidar, direction_of

_EXACT = np.diag((1e-9, 1e-9, 1e-9))


class RobotTopics:
    """Publishers and the subscription of one robot. Topics without subscribers cost nothing, latched ones aside."""

    def __init__(
        self,
        node: Node,
        simulation: Simulation,
        robot: int,
        prefix: str,
        settings: SimulatorSettings,
        *,
        real: bool = False,
    ) -> None:
        """`prefix` is put before topics and frames: '' for a single robot, else 'robot_<n>/'.

        `real`: drivers take its commands and publish its odometry, joints and scans; the truth alone is published here.
        """
        frames, quality = settings.frames, settings.quality
        self._simulation = simulation
        self._robot = robot
        self._map, self._odom_frame, self._base = frames.map, prefix + frames.odom, prefix + frames.base
        self._wheels = (f"{prefix}left_wheel_joint", f"{prefix}right_wheel_joint")
        sideways = simulation.base.limits.sideways
        self._speed_covariance = SIDEWAYS_SPEED_COVARIANCE if sideways else SPEED_COVARIANCE
        lidar = simulation.believed.lidar
        self._odom = None if real else node.publish(f"{prefix}odom", Odometry, quality)
        self._truth = node.publish(f"{prefix}base_pose_ground_truth", Odometry, quality)
        self._joints = None if real else node.publish(f"{prefix}joint_states", Joints, quality)
        self._lidar, self._lidar_frame = lidar, prefix + lidar.frame if lidar else ""
        self._scan = node.publish(prefix + lidar.topic, Scan, quality) if lidar and not real else None
        self._head = TurningLidar(simulation, robot) if self._scan and direction_of(simulation.base) else None
        self._collisions = node.publish(f"~{prefix}collisions", int, Quality.LATCHED)
        self._strikes = node.publish(f"~{prefix}people_struck", int, Quality.LATCHED) if simulation.has_people else None
        self._sent_collisions = self._sent_strikes = -1
        if not real:
            node.subscribe(f"{prefix}cmd_vel", Twist, self._on_command)

    def _on_command(self, command: Twist) -> None:
        self._simulation.command(self._robot, command.forward, command.turn, command.left)

    def transform(self, stamp: int) -> Transform:
        """The transform odom -> base_footprint, from the odometry of the encoders."""
        x, y, yaw = self._simulation.odometry(self._robot).pose
        return Transform(stamp, self._odom_frame, self._base, Pose3(x, y, 0.0, *quaternion_of_yaw(yaw)))

    def send_odometry(self, stamp: int) -> None:
        """Send the odometry of the encoders, and the ground truth."""
        if self._odom and self._odom.subscribers():
            odometry = self._simulation.odometry(self._robot)
            covariance = covariance_matrix(odometry.covariance)
            twist = Twist(*odometry.velocity)
            self._odom.send(
                Odometry(stamp, self._odom_frame, self._base, odometry.pose, twist, covariance, self._speed_covariance)
            )
        if self._truth.subscribers():
            forward, left, turn = self._simulation.velocity(self._robot)
            pose = self._simulation.pose(self._robot)
            twist = Twist(forward, turn, left)
            self._truth.send(Odometry(stamp, self._map, self._base, pose, twist, _EXACT, SPEED_COVARIANCE))

    def send_scan(self, stamp: int, *, due: bool) -> None:
        """Send a scan of the lidar if it is due: of a turn, or of an instant where there is no real lidar."""
        lidar, head, time, increment = self._lidar, self._head, stamp, 0.0
        if not lidar or not self._scan or not self._scan.subscribers():
            return
        ranges = head.measure(due=due) if head else self._simulation.scan(self._robot) if due else None
        if head and ranges is not None:
            time, increment = stamp - round((self._simulation.time - head.first) * SECOND), head.increment
        if ranges is not None:
            self._scan.send(
                Scan(
                    time,
                    self._lidar_frame,
                    lidar.angle_min + lidar.askew,
                    (lidar.angle_max - lidar.angle_min) / (lidar.samples - 1),
                    lidar.range_min,
                    lidar.range_max,
                    ranges.astype(np.float32),
                    scan_time=1.0 / lidar.rate,
                    angle_max=lidar.angle_max + lidar.askew,
                    time_increment=increment,
                )
            )

    def send_joints(self, stamp: int) -> None:
        """Send the angles of the wheels, and how fast they turn."""
        if self._joints and self._joints.subscribers():
            angles, speeds = self._simulation.wheel_angles(self._robot), self._simulation.wheel_speeds(self._robot)
            self._joints.send(Joints(stamp, self._wheels, angles, speeds))

    def send_collisions(self, count: int, strikes: int) -> None:
        """Send the numbers of collisions of the robot, and of those of them with people, when they change."""
        if count != self._sent_collisions:
            self._sent_collisions = count
            self._collisions.send(count)
        if self._strikes and strikes != self._sent_strikes:
            self._sent_strikes = strikes
            self._strikes.send(strikes)
