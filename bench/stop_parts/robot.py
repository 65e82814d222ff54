"""One simulated robot with its mux, on a master of its own, and what it really does."""

from __future__ import annotations

import contextlib
import math
import os
import re
import shutil
import signal
import socket
import subprocess
import threading
import time
from pathlib import Path
from typing import Any

from bench.stop_parts.nursery import Child, Nursery
from bench.stop_parts.people import JOYSTICK, KEYBOARD, NAVIGATION, READER, wait_for

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "ubiquity_launches"
MUX = "ur_nodes.motion.cmd_vel_mux_node"
MAP = "ur_nodes.mapping.map_server_node"
TRUTH_RATE = 100  # Hz
_STANDS = (0.01, 0.02)  # m/s, rad/s
_WORLD = "maze"


class Watch:
    """What the robot really does; and tf map -> odom from that, since robots are put elsewhere for each trial."""

    def __init__(self) -> None:
        import rospy
        from nav_msgs.msg import Odometry
        from nav_msgs.srv import SetMap
        from std_msgs.msg import String
        from tf2_msgs.msg import TFMessage

        self._lock = threading.Lock()
        self._truth: list[tuple[float, float, float]] = []
        self._pose = (0.0, (0.0, 0.0, 0.0))
        self.active = ""
        self.place_service = rospy.ServiceProxy("simulator/place", SetMap)
        self._tf = rospy.Publisher("/tf", TFMessage, queue_size=10)
        rospy.Subscriber("base_pose_ground_truth", Odometry, self._on_truth, queue_size=100, tcp_nodelay=True)
        rospy.Subscriber("odom", Odometry, self._on_odometry, queue_size=100, tcp_nodelay=True)
        rospy.Subscriber("cmd_vel_mux/active", String, self._on_active, queue_size=1)

    def _on_truth(self, message: Any) -> None:
        stamp, twist = message.header.stamp.to_sec(), message.twist.twist
        with self._lock:
            self._truth.append((stamp, twist.linear.x, twist.angular.z))
            self._pose = (stamp, _pose_of(message))

    def _on_odometry(self, message: Any) -> None:
        """Tell where odometry's frame is in the map, whenever truth of the same moment is there."""
        import rospy
        from geometry_msgs.msg import TransformStamped
        from tf2_msgs.msg import TFMessage

        with self._lock:
            stamp, (x, y, yaw) = self._pose
        if abs(stamp - message.header.stamp.to_sec()) > 1e-6 or int(stamp * TRUTH_RATE) % 4:
            return
        odom_x, odom_y, odom_yaw = _pose_of(message)
        turn = yaw - odom_yaw
        link = TransformStamped(child_frame_id="odom")
        link.header.frame_id, link.header.stamp = "map", rospy.Time.from_sec(stamp + 0.1)  # as amcl dates it
        place, rotation = link.transform.translation, link.transform.rotation
        place.x = x - math.cos(turn) * odom_x + math.sin(turn) * odom_y
        place.y = y - math.sin(turn) * odom_x - math.cos(turn) * odom_y
        rotation.z, rotation.w = math.sin(turn / 2.0), math.cos(turn / 2.0)
        with contextlib.suppress(rospy.ROSException):  # closed: it is the end
            self._tf.publish(TFMessage([link]))

    def _on_active(self, message: Any) -> None:
        self.active = message.data

    @property
    def now(self) -> tuple[float, float, float]:
        """Time, speed and turning speed."""
        return self._truth[-1] if self._truth else (0.0, 0.0, 0.0)

    def place(self, x: float, y: float, yaw: float) -> None:
        """Put the robot somewhere, and forget the past."""
        from nav_msgs.srv import SetMapRequest

        request = SetMapRequest()
        pose = request.initial_pose.pose.pose
        pose.position.x, pose.position.y = x, y
        pose.orientation.z, pose.orientation.w = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
        self.place_service(request)
        with self._lock:
            self._truth.clear()

    def stands_since(self) -> float:
        """The time of the first moment after which it never moved; infinite while it moves."""
        with self._lock:
            since = math.inf
            for stamp, speed, turn in reversed(self._truth):
                if abs(speed) >= _STANDS[0] or abs(turn) >= _STANDS[1]:
                    break
                since = stamp
            return since


class Robot:
    """Master, nursery, simulator and mux. Make one before threads are started; `close` ends everything."""

    def __init__(self, base: str, variant: str, folder: Path, seed: int, command_age: float | None) -> None:
        """`base` and `variant` by name; `command_age` (s) instead of what the base says, if given."""
        from ur.robot.base import load_base

        self.folder = folder
        package = make_package(folder, command_age)
        self.base = load_base(package, base, variant)
        self.name = f"{base}/{variant}" if variant else base
        port = _free_port()
        os.environ |= {
            "ROS_MASTER_URI": f"http://localhost:{port}",
            "ROS_HOSTNAME": "localhost",
            "UR_LEASE": "take",  # each commander takes over from the one that was lost before it
            "ROS_HOME": str(folder),
            "ROS_LOG_DIR": str(folder / "log"),
        }
        self.nursery = Nursery((MUX, KEYBOARD, JOYSTICK, READER, NAVIGATION, MAP), folder)
        self._running: list[subprocess.Popen[bytes]] = []
        self._log = (folder / "log.txt").open("wb")
        try:
            self._run("/usr/bin/rosmaster", "--core", "-p", str(port))
            wait_for(lambda: _answers(port), "the master")
            import rospy

            rospy.init_node("bench_stop", disable_signals=True)
            self._set_parameters(base)
            self._own = [f"_base:={base}", f"_variant:={variant}", f"_package:={package}"]
            simulator = str(PACKAGE / "n_simulator" / "bin" / "simulator")
            world = PACKAGE / "n_simulator" / "worlds" / f"{_WORLD}.yaml"
            self._simulator = self._run(
                simulator, "__name:=simulator", f"_seed:={seed}", f"_world_file:={world}", *self._own
            )
            map_file = PACKAGE / "n_map_server" / "maps" / f"{_WORLD}.yaml"
            self.nursery.bear(MAP, str(map_file), "__name:=map_server")
            self.watch = Watch()
            wait_for(lambda: self.watch.now[0] > 0.0, f"the simulator; it wrote {folder / 'log.txt'}")
            self.mux = self.start_mux()
        except BaseException:
            self.close()
            raise

    def _set_parameters(self, base: str) -> None:
        """What the launch files load."""
        import rospy
        import yaml

        def load(node: str, directory: str, name: str) -> None:
            path = PACKAGE / directory / "params" / f"{name}.yaml"
            for key, value in yaml.safe_load(path.read_text(encoding="utf-8")).items():
                rospy.set_param(f"/{node}/{key}", value)

        load("cmd_vel_mux", "n_cmd_vel_mux", "sources")
        load("teleop_twist_joy", "n_teleop_twist_joy", "joysticks/xbox")
        load("teleop_twist_joy", "n_teleop_twist_joy", base)
        load("move_base", "n_move_base", base)
        limits = self.base.limits
        rospy.set_param("/teleop_twist_joy/scale_linear_turbo", limits.velocity)
        rospy.set_param("/teleop_twist_joy/scale_angular_turbo", limits.angular_velocity)
        if self.base.lidar is None:
            for costmap in ("global_costmap", "local_costmap"):
                rospy.set_param(f"/move_base/{costmap}/obstacle_layer/observation_sources", "")
        static = _static_transform(self.base)
        if static is not None:
            self._static: Any = rospy.Publisher("/tf_static", type(static), queue_size=1, latch=True)
            self._static.publish(static)

    def start_mux(self) -> Child:
        """Start the mux, and wait until it is there."""
        self.watch.active = ""
        self.mux = self.nursery.bear(MUX, "__name:=cmd_vel_mux", "cmd_vel_out:=cmd_vel", *self._own)
        wait_for(lambda: self.watch.active == "idle", f"the mux; it wrote {self.folder / 'nodes.log'}")
        return self.mux

    def waited(self, *, mux: bool) -> float:
        """How long simulator and `mux` have waited for a processor since they started, all threads together, s."""
        return waited(self._simulator) + (waited(self.mux.pid) if mux else 0.0)

    def _run(self, *command: str) -> int:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log)
        self._running.append(process)
        return process.pid

    def close(self) -> None:
        """End everything."""
        self.nursery.close()
        for process in reversed(self._running):
            process.send_signal(signal.SIGTERM)
        deadline = time.monotonic() + 10.0
        while any(process.poll() is None for process in self._running) and time.monotonic() < deadline:
            time.sleep(0.02)
        for process in self._running:
            process.kill()
            process.wait()
        self._log.close()


def make_package(folder: Path, command_age: float | None) -> Path:
    """The bases, with ground truth at a higher rate; `command_age` (s) instead of what their files say, if given."""
    package = folder / "package"
    shutil.copytree(PACKAGE / "bases", package / "bases")
    for path in (package / "bases").glob("*/base.yaml"):
        text = re.sub(r"(odometry: *\{rate: *)\d+", rf"\g<1>{TRUTH_RATE}", path.read_text(encoding="utf-8"))
        if command_age is not None:
            text = re.sub(r"(command_age: *)[\d.]+", rf"\g<1>{command_age:g}", text)
        path.write_text(text, encoding="utf-8")
    return package


def _static_transform(base: Any) -> Any:
    """The lidar on the base, as robot_state_publisher tells it; None for a base without one."""
    from geometry_msgs.msg import TransformStamped
    from tf2_msgs.msg import TFMessage

    if base.lidar is None:
        return None
    x, y, z, _, _, yaw = base.lidar.pose
    link = TransformStamped(child_frame_id=base.lidar.frame)
    link.header.frame_id = "base_footprint"
    place, rotation = link.transform.translation, link.transform.rotation
    place.x, place.y, place.z = x, y, z
    rotation.z, rotation.w = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
    return TFMessage([link])


def waited(pid: int) -> float:
    """Time on the run queue, by the kernel's schedstat (Documentation/scheduler/sched-stats.rst); 0 once it is dead."""
    total = 0
    for path in Path(f"/proc/{pid}/task").glob("*/schedstat"):
        with contextlib.suppress(OSError):
            total += int(path.read_text().split()[1])
    return total / 1e9


def _pose_of(message: Any) -> tuple[float, float, float]:
    pose = message.pose.pose
    return pose.position.x, pose.position.y, 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return int(probe.getsockname()[1])


def _answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("localhost", port)) == 0
