"""Talks to a simulator for the tests: a JSON request a line in, a JSON answer a line out."""

from __future__ import annotations

import threading
import time
from typing import Any

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from nav_msgs.srv import SetMap, SetMapRequest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, CameraInfo, CompressedImage, Image, Imu, JointState, LaserScan, Range
from std_msgs.msg import Bool, Int32
from std_srvs.srv import Empty, SetBool, Trigger
from tests.json_client import answer_requests, claim_output
from tf2_msgs.msg import TFMessage

KINDS = {
    "odom": Odometry,
    "base_pose_ground_truth": Odometry,
    "scan": LaserScan,
    "joint_states": JointState,
    "tf": TFMessage,
    "clock": Clock,
    "simulator/collisions": Int32,
    "sonars": Range,
    "imu/data": Imu,
    "battery_state": BatteryState,
    "bumper/front": Bool,
    "bumper/back": Bool,
    "cliff/left": Bool,
    "cliff/right": Bool,
    "raspicam_node/image_raw": Image,
    "raspicam_node/image/compressed": CompressedImage,
    "raspicam_node/camera_info": CameraInfo,
}


class Client:
    def __init__(self) -> None:
        self.arrived = threading.Condition()
        self.heard: dict[str, list[Any]] = {}
        self.publishers: dict[str, rospy.Publisher] = {}

    def listen(self, topics: list[str]) -> None:
        """Hear all that is said on these topics from now on. Fails when nobody speaks on one."""
        for topic in topics:
            self.heard[topic] = []
        kinds = {topic: KINDS[topic.removeprefix("robot_1/")] for topic in topics}
        heard = {topic: rospy.Subscriber(f"/{topic}", kind, self.hear, topic) for topic, kind in kinds.items()}
        end = time.monotonic() + 60.0
        for topic, subscriber in heard.items():
            while not subscriber.get_num_connections():
                assert time.monotonic() < end, f"nobody speaks on {topic}"
                time.sleep(0.01)

    def hear(self, message: Any, topic: str) -> None:
        with self.arrived:
            self.heard[topic].append(message)
            self.arrived.notify_all()

    def collect(self, topic: str, count: int, seconds: float) -> list[Any]:
        """The next `count` messages of a topic."""
        with self.arrived:
            first = len(self.heard[topic])
            full = self.arrived.wait_for(lambda: len(self.heard[topic]) >= first + count, seconds)
            assert full, f"{len(self.heard[topic]) - first} of {count} messages on {topic}"
            return [brief(message) for message in self.heard[topic][first : first + count]]

    def past(self, topic: str, count: int = 0) -> list[Any]:
        """All messages of a topic so far, once there are at least `count`."""
        with self.arrived:
            assert self.arrived.wait_for(lambda: len(self.heard[topic]) >= count, 60.0), topic
            return [brief(message) for message in self.heard[topic]]

    def since(self, topic: str, stamp: float, count: int) -> list[Any]:
        """The messages of a topic later than a stamp, once there are `count` of them."""
        with self.arrived:

            def late() -> list[Any]:
                return [each for each in map(brief, self.heard[topic]) if each["stamp"] > stamp + 1e-6]

            assert self.arrived.wait_for(lambda: len(late()) >= count, 60.0), topic
            return late()

    def command(self, linear: float, angular: float, times: int = 1, topic: str = "cmd_vel") -> None:
        """Publish, at 20 Hz when more than once."""
        if topic not in self.publishers:
            self.publishers[topic] = rospy.Publisher(f"/{topic}", Twist, queue_size=1, tcp_nodelay=True)
            end = time.monotonic() + 60.0
            while not self.publishers[topic].get_num_connections():
                assert time.monotonic() < end, f"nobody listens to {topic}"
                time.sleep(0.01)
        message = Twist()
        message.linear.x, message.angular.z = linear, angular
        for n in range(times):
            if n:
                time.sleep(0.05)
            self.publishers[topic].publish(message)

    def drive_until(self, topic: str, count: int, linear: float, seconds: float) -> None:
        """Send the same command until so many messages have arrived on a topic, or time is up."""
        end = time.monotonic() + seconds
        self.command(linear, 0.0)
        while len(self.heard[topic]) < count:
            assert time.monotonic() < end, f"{len(self.heard[topic])} of {count} messages on {topic}"
            self.command(linear, 0.0)
            with self.arrived:
                self.arrived.wait_for(lambda: len(self.heard[topic]) >= count, 0.03)

    def call(self, service: str, **values: Any) -> Any:
        kinds = {"pause": SetBool, "step": Trigger, "reset": Empty, "place": SetMap}
        name = f"/simulator/{service}"
        rospy.wait_for_service(name, 60.0)
        proxy = rospy.ServiceProxy(name, kinds[service])
        if service == "place":
            request = SetMapRequest()
            request.map.header.frame_id = values.get("name", "")
            request.initial_pose.header.frame_id = values.get("frame", "map")
            place = request.initial_pose.pose.pose
            place.position.x, place.position.y, place.orientation.w = values["x"], values["y"], 1.0
            return getattr(proxy(request), "success", None)
        answer = proxy(*values.values())
        return [getattr(answer, "success", None), getattr(answer, "message", None)]


def brief(message: Any) -> dict[str, Any]:
    """The values that tests look at."""
    if isinstance(message, TFMessage):
        transform = message.transforms[0]
        frames = [transform.header.frame_id, transform.child_frame_id]
        return {"stamp": transform.header.stamp.to_sec(), "frames": frames, "x": transform.transform.translation.x}
    if isinstance(message, Clock):
        return {"stamp": message.clock.to_sec()}
    if isinstance(message, Int32):
        return {"count": message.data}
    if isinstance(message, Bool):
        return {"pressed": message.data}
    values = {"stamp": message.header.stamp.to_sec(), "frame": message.header.frame_id}
    if isinstance(message, LaserScan):
        return values | {"ranges": [str(each) for each in message.ranges], "min": message.angle_min}
    if isinstance(message, Image):
        return values | {"size": [message.width, message.height, message.step, len(message.data)]}
    if isinstance(message, CompressedImage):
        return values | {"format": message.format, "begin": message.data[:2].hex()}
    if isinstance(message, CameraInfo):
        return values | {"size": [message.width, message.height], "K": list(message.K)}
    if isinstance(message, JointState):
        return values | {
            "names": message.name,
            "positions": list(message.position),
            "velocities": list(message.velocity),
        }
    if isinstance(message, (Range, Imu, BatteryState)):
        return values | brief_reading(message)
    pose, twist = message.pose, message.twist.twist
    return values | {
        "child": message.child_frame_id,
        "x": pose.pose.position.x,
        "v": twist.linear.x,
        "covariance": list(pose.covariance),
    }


def brief_reading(message: Any) -> dict[str, Any]:
    """The same of what a sensor says."""
    if isinstance(message, Range):
        limits = [message.field_of_view, message.min_range, message.max_range]
        return {"range": str(message.range), "limits": limits, "kind": message.radiation_type}
    if isinstance(message, Imu):
        turning, force, q = message.angular_velocity, message.linear_acceleration, message.orientation
        return {
            "turning": [turning.x, turning.y, turning.z],
            "force": [force.x, force.y, force.z],
            "orientation": [q.x, q.y, q.z, q.w],
            "variance": [message.angular_velocity_covariance[0], message.linear_acceleration_covariance[8]],
        }
    names = ("voltage", "current", "charge", "percentage", "design_capacity", "present")
    return {name: getattr(message, name) for name in names}


def main() -> None:
    answers = claim_output()
    rospy.init_node("client", anonymous=True, disable_signals=True)
    answer_requests(answers, Client())
    rospy.signal_shutdown("done")


if __name__ == "__main__":
    main()
