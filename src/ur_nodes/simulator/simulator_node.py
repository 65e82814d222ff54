"""The simulator as a node: topics, services and the pace of time round `Simulation`."""

from __future__ import annotations

import queue
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future

import rospy
from nav_msgs.srv import SetMap, SetMapRequest, SetMapResponse
from rosgraph_msgs.msg import Clock
from std_srvs.srv import (
    Empty,
    EmptyRequest,
    EmptyResponse,
    SetBool,
    SetBoolRequest,
    SetBoolResponse,
    Trigger,
    TriggerRequest,
    TriggerResponse,
)

from ur.robot.base import load_base
from ur.source.diagnostic import UserError
from ur.source.project import launch_library
from ur.worlds.world_file import World, read_world
from ur_nodes.rosio.geometry import pose_of_message
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.publishers import TransformSender, make_publisher
from ur_nodes.rosio.shell import run_node
from ur_nodes.simulator.camera_node import CameraTopics, read_camera
from ur_nodes.simulator.pacing import Pacer
from ur_nodes.simulator.robot_topics_node import RobotTopics
from ur_nodes.simulator.sensor_topics_node import SensorTopics
from ur_nodes.simulator.settings import Frames, Settings
from ur_nodes.simulator.simulation import Simulation

_ANSWER_WITHIN = 10.0  # s
_LONGEST_WAIT = 0.1  # s, so that the end is noticed


class SimulatorNode:
    """Runs a simulation in a thread of its own. Services are carried out there, between two ticks."""

    def __init__(self, simulation: Simulation, settings: Settings, camera: CameraTopics | None = None) -> None:
        self._camera = camera
        self._watching = False
        self._simulation = simulation
        self._settings = settings
        self._paused = False
        self._requests: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._pacer = Pacer(settings.speed, simulation.time, time.monotonic())
        self._clock = make_publisher("/clock", Clock, settings.queue_size) if settings.publish_clock else None
        self._clock_message = Clock()
        self._next_clock = self._next_joints = 0.0
        self._transforms = TransformSender(settings.queue_size)
        prefixes = list_prefixes(simulation)
        self._robots = [RobotTopics(simulation, n, prefix, settings) for n, prefix in enumerate(prefixes)]
        self._sensors = [SensorTopics(simulation, n, prefix, settings) for n, prefix in enumerate(prefixes)]
        rospy.Service("~pause", SetBool, self._pause)
        rospy.Service("~step", Trigger, self._step)
        rospy.Service("~reset", Empty, self._reset)
        rospy.Service("~place", SetMap, self._place)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="simulation", daemon=True)
        rospy.on_shutdown(self._end)
        if not rospy.is_shutdown():
            self._thread.start()

    def _end(self) -> None:
        """Stop before rospy closes the topics."""
        self._ended.set()
        # The end may come before the beginning.
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join(timeout=1.0)
        if self._camera:
            self._camera.close()

    def _run(self) -> None:
        try:
            while not self._ended.is_set() and not rospy.is_shutdown():
                if self._paused:
                    self._serve(_LONGEST_WAIT)
                    continue
                left = self._pacer.wait(self._simulation.next_time, time.monotonic())
                if left > 0.0 or not self._requests.empty():
                    self._serve(min(left, _LONGEST_WAIT))
                else:
                    self._tick()
        except Exception as problem:  # a thread that ends in silence would look like a stopped robot
            rospy.logfatal("the simulation failed: %r", problem)
            rospy.signal_shutdown("the simulation failed")

    def _serve(self, timeout: float) -> None:
        """Wait for requests for at most `timeout` s and carry them out."""
        try:
            self._requests.get(timeout=timeout)() if timeout > 0.0 else self._requests.get_nowait()()
        except queue.Empty:
            return

    def _tick(self) -> None:
        for robot in self._robots:
            robot.pass_command_on()
        if self._camera:
            self._watch(self._camera)
        tick = self._simulation.advance()
        stamp = self._stamp(tick.time)
        joints = tick.time >= self._next_joints
        placed = tick.odometry or tick.scan or tick.sonars
        stamped = placed or joints or tick.imu or tick.battery
        if self._clock is not None and (stamped or tick.time >= self._next_clock):
            self._next_clock = tick.time + 1.0 / self._settings.clock_rate - 1e-6
            self._clock_message.clock = stamp
            self._clock.publish(self._clock_message)
        if joints:
            self._next_joints = tick.time + 1.0 / self._settings.joint_rate - 1e-6
        if placed:
            self._transforms.send(stamp, *(robot.edge() for robot in self._robots))
        for robot, collisions in zip(self._robots, self._simulation.collisions, strict=True):
            if tick.odometry:
                robot.publish_odometry(stamp)
            if tick.scan:
                robot.publish_scan(stamp)
            if joints:
                robot.publish_joints(stamp)
            robot.publish_collisions(collisions)
        for sensors in self._sensors:
            sensors.publish(tick, stamp)
        if tick.picture and self._camera:
            self._camera.offer(stamp, self._simulation.state())

    def _watch(self, camera: CameraTopics) -> None:
        """Make pictures due only while their topic has subscribers."""
        if camera.wanted != self._watching:
            self._watching = not self._watching
            self._simulation.take_pictures(camera.camera.rate if self._watching else 0.0)

    def _stamp(self, simulated: float) -> rospy.Time:
        """Simulated time when there is a /clock; otherwise the wall time at which the moment was due."""
        if self._settings.publish_clock:
            return rospy.Time.from_sec(simulated)
        late = time.monotonic() - self._pacer.due(simulated)
        return rospy.Time.from_sec(time.time() - late)

    def _ask(self, action: Callable[[], None]) -> None:
        """Have the simulation's thread carry out an action, and wait for it. Raises what the action raises."""
        done: Future[None] = Future()

        def carry_out() -> None:
            try:
                action()
            except Exception as problem:  # it is raised again where it was asked for
                done.set_exception(problem)
            else:
                done.set_result(None)

        self._requests.put(carry_out)
        done.result(timeout=_ANSWER_WITHIN)

    def _pause(self, request: SetBoolRequest) -> SetBoolResponse:
        def pause() -> None:
            self._paused = bool(request.data)
            self._pacer.restart(self._simulation.time, time.monotonic())

        self._ask(pause)
        return SetBoolResponse(success=True, message="paused" if request.data else "running")

    def _step(self, _request: TriggerRequest) -> TriggerResponse:
        if not self._paused:
            return TriggerResponse(success=False, message="not paused, expected ~pause with true before ~step")

        def step() -> None:
            end = self._simulation.time + self._settings.step_period - 1e-6
            while self._simulation.time < end:
                self._pacer.restart(self._simulation.time, time.monotonic())
                self._tick()

        self._ask(step)
        return TriggerResponse(success=True, message=f"simulated time {self._simulation.time:.3f} s")

    def _reset(self, _request: EmptyRequest) -> EmptyResponse:
        self._ask(self._simulation.reset)
        return EmptyResponse()

    def _place(self, request: SetMapRequest) -> SetMapResponse:
        frame = request.initial_pose.header.frame_id.lstrip("/")
        if frame not in ("", self._settings.frames.map):
            raise rospy.ServiceException(f"a pose in frame {frame!r}, expected {self._settings.frames.map!r}")
        pose = pose_of_message(request.initial_pose.pose.pose)
        name = request.map.header.frame_id
        try:
            self._ask(lambda: self._simulation.place(name, (pose.x, pose.y, pose.yaw)))
        except UserError as problem:
            rospy.logwarn("~place: %s", problem)
            raise rospy.ServiceException(str(problem)) from None
        return SetMapResponse(success=True)


def start() -> None:
    """Read the parameters, load world and base, and run. Raises UserError."""
    own = Parameters()
    base = load_base(own.text("package", str(launch_library())), own.text("base", "stage"), own.text("variant", ""))
    world = read_world(own.text("world_file", str(launch_library() / "n_simulator/worlds/maze.yaml")))
    x, y, yaw = world.start
    speed = own.number("speed", 1.0, minimum=0.0)
    simulated_clock = rospy.get_param("/use_sim_time", False) is True
    simulation = Simulation(
        world,
        base,
        robots=own.integer("robots", 1, minimum=1),
        seed=own.integer("seed", 0, minimum=0),
        start=(own.number("x", x), own.number("y", y), own.number("yaw", yaw)),
        charge=own.number("battery_charge", 1.0, minimum=0.0, maximum=1.0),
    )
    frames = Frames(
        own.text("map_frame", "map"), own.text("odom_frame", "odom"), own.text("base_frame", "base_footprint")
    )
    settings = Settings(
        speed=speed,
        publish_clock=own.boolean("publish_clock", simulated_clock) or speed != 1.0,
        clock_rate=own.number("clock_rate", 50.0, minimum=1.0, maximum=1000.0),
        joint_rate=own.number("joint_rate", 10.0, minimum=0.1, maximum=1000.0),
        step_period=own.number("step_period", 0.1, minimum=0.001, maximum=60.0),
        frames=frames,
    )
    if settings.publish_clock and not simulated_clock:
        rospy.logwarn("/clock is published but /use_sim_time is not true: other nodes go by another clock")
    SimulatorNode(simulation, settings, make_camera(own, world, simulation, speed))


def make_camera(own: Parameters, world: World, simulation: Simulation, speed: float) -> CameraTopics | None:
    """The topics of the base's camera, if it has one. Raises UserError: a parameter is not what is expected."""
    if simulation.base.raspicam is None:
        return None
    camera = read_camera(own, simulation.base.raspicam)
    quality = own.integer("jpeg_quality", 80, minimum=1)
    return CameraTopics(world, simulation.base, camera, list_prefixes(simulation), speed == 0.0, min(quality, 95))


def list_prefixes(simulation: Simulation) -> list[str]:
    """Return the prefix of the topics and frames of each robot: '' where there is only one."""
    return [f"robot_{n}/" if simulation.robots > 1 else "" for n in range(simulation.robots)]


if __name__ == "__main__":
    sys.exit(run_node("simulator", start))
