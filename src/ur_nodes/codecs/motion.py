"""Velocities, odometry, joints and joysticks."""

from geometry_msgs.msg import Twist as TwistMessage
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import JointState, Joy

from ur_nodes.codecs.codec import Codec, fill_header, frame_of
from ur_nodes.codecs.dialect import stamp_of
from ur_nodes.codecs.geometry import checked_pose_of, fill_pose, matrix_of, numbers_of
from ur_nodes.ports.values import DriverOdometry, Joints, Joystick, Odometry, StampedTwist, Twist

_KNOWN = 1e-9  # the floor is flat; filters want no variance of 0


def _fill_twist(message: TwistMessage, value: Twist) -> None:
    message.linear.x, message.linear.y, message.linear.z = value.forward, value.left, value.up
    message.angular.x, message.angular.y, message.angular.z = value.roll, value.pitch, value.turn


def twist_of(message: TwistMessage) -> Twist:
    """The velocity that a geometry_msgs/Twist has."""
    linear, angular = message.linear, message.angular
    return Twist(linear.x, angular.z, linear.y, linear.z, angular.x, angular.y)


def _fill_stamped(message: TwistStamped, value: StampedTwist) -> None:
    fill_header(message, value.stamp, value.frame)
    _fill_twist(message.twist, value.twist)


def _stamped_of(message: TwistStamped) -> StampedTwist:
    return StampedTwist(stamp_of(message.header.stamp), message.header.frame_id, twist_of(message.twist))


def _fill_odometry(message: OdometryMessage, value: Odometry) -> None:
    fill_header(message, value.stamp, value.frame)
    message.child_frame_id = value.child
    fill_pose(message.pose.pose, value.pose)
    _fill_twist(message.twist.twist, value.twist)
    message.pose.covariance = numbers_of(value.pose_covariance, _KNOWN)
    message.twist.covariance = numbers_of(value.twist_covariance, _KNOWN)


def _odometry_of(message: OdometryMessage) -> Odometry:
    return Odometry(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.child_frame_id.lstrip("/"),
        checked_pose_of(message.pose.pose),
        twist_of(message.twist.twist),
        matrix_of(message.pose.covariance),
        matrix_of(message.twist.covariance),
    )


def _fill_driver_odometry(message: OdometryMessage, value: DriverOdometry) -> None:
    fill_header(message, value.stamp, "odom")
    place, turn, twist = message.pose.pose.position, message.pose.pose.orientation, message.twist.twist
    place.x, place.y = value.x, value.y
    turn.x, turn.y, turn.z, turn.w = value.rotation
    twist.linear.x, twist.angular.z = value.forward, value.turn


def _driver_odometry_of(message: OdometryMessage) -> DriverOdometry:
    place, turn, twist = message.pose.pose.position, message.pose.pose.orientation, message.twist.twist
    rotation = (turn.x, turn.y, turn.z, turn.w)
    return DriverOdometry(stamp_of(message.header.stamp), place.x, place.y, rotation, twist.linear.x, twist.angular.z)


def _fill_joints(message: JointState, value: Joints) -> None:
    fill_header(message, value.stamp, "")
    message.name, message.position, message.velocity = value.names, value.angles, value.speeds


def _joints_of(message: JointState) -> Joints:
    return Joints(stamp_of(message.header.stamp), tuple(message.name), tuple(message.position), tuple(message.velocity))


def _fill_joystick(message: Joy, value: Joystick) -> None:
    fill_header(message, value.stamp, "")
    message.axes, message.buttons = value.axes, value.buttons


CODECS = {
    Twist: Codec(TwistMessage, _fill_twist, twist_of),
    StampedTwist: Codec(TwistStamped, _fill_stamped, _stamped_of),
    Odometry: Codec(OdometryMessage, _fill_odometry, _odometry_of),
    DriverOdometry: Codec(OdometryMessage, _fill_driver_odometry, _driver_odometry_of),
    Joints: Codec(JointState, _fill_joints, _joints_of),
    Joystick: Codec(
        Joy, _fill_joystick, lambda joy: Joystick(stamp_of(joy.header.stamp), tuple(joy.axes), tuple(joy.buttons))
    ),
}
