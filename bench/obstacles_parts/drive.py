"""One drive by hand in lock step: simulated base, mux and obstacle stop in one process, without nodes or real time.

Messages take a while as between nodes: commands and `cmd_vel` 10 ms, readings of sensors and odometry 20 ms.
"""

import heapq
import itertools
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ur.robot.base import BRAKE_AFTER, Base
from ur.worlds.world_file import WorldModel
from ur_nodes.geometry.hull import Floats
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.mux import MuxState, start_mux, step
from ur_nodes.motion.mux_events import Event, MuxSettings, Source, Velocity, VelocityCommand
from ur_nodes.motion.obstacle_stop.guard import make_guard
from ur_nodes.motion.obstacle_stop.obstacle_stop import contact_points, make_sight
from ur_nodes.motion.obstacle_stop.sensors import RangeSensor
from ur_nodes.motion.obstacle_stop.sight import MEMORY, Odometer, SensorRanges, Sight, look, move, touch
from ur_nodes.motion.ramp import axes_of
from ur_nodes.simulator.schedule import SimulationTick
from ur_nodes.simulator.sensors.bumpers import BumperSense
from ur_nodes.simulator.sensors.sonars import SonarSense
from ur_nodes.simulator.simulation import Simulation
from ur_nodes.simulator.turning_lidar import TurningLidar, direction_of

_COMMAND_DELAY, _SENSOR_DELAY = 0.01, 0.02  # s
_COMMANDS = 30.0  # Hz
_CLEAR = 0.05  # m from the outline: what a sensor saw there could be stopped before

Driver = Callable[[float, Pose2], Velocity]


@dataclass
class Drive:
    """A robot in a world, driven by `driver`, which gives a command at a time (s) and a true pose of the robot.

    After `run`: `contacts` that the sensors could see coming and `unseen` ones, the `way` in m, the CPU `seconds` of
    the decisions, how often there was one, and the `sight` of the obstacle stop.
    """

    base: Base
    world: WorldModel
    driver: Driver
    guarded: bool = True
    seed: int = 0
    contacts: list[str] = field(default_factory=list)
    unseen: list[str] = field(default_factory=list)
    way: float = 0.0
    seconds: float = 0.0
    decisions: int = 0
    readings: float = 0.0  # s of CPU time

    def __post_init__(self) -> None:
        self.simulation = Simulation(self.world, self.base, seed=self.seed)
        self._head = TurningLidar(self.simulation) if direction_of(self.base) else None
        forward, turn = axes_of(self.base.limits)
        sources = (Source("keyboard", "key_vel", 90, 0.15),)
        limits = self.base.limits
        settings = MuxSettings(sources, forward, turn, lag=limits.lag, brake_after=BRAKE_AFTER if limits.fast else None)
        self._state: MuxState = start_mux(settings)
        self.sight: Sight = make_sight(self.base)
        self._queue: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = itertools.count()
        self._past: list[tuple[float, Pose2, tuple[tuple[RangeSensor, float], ...]]] = []
        self._pressed: dict[str, bool] = {}
        self._collisions = 0
        if self.guarded:
            guard = make_guard(self.sight, self.base.limits, self.base.limits.lag)
            self._state = self._state._replace(guard=guard)

    def run(self, seconds: float, until: Callable[[Pose2], bool] = lambda _: False) -> float:
        """Drive for so long, or until a pose is reached; return the time (s)."""
        begin = self.simulation.time
        command_at = begin + 0.5
        before = self.simulation.pose(0)
        while self.simulation.time - begin < seconds:
            posted = self._queue[0][0] if self._queue else math.inf
            now = min(self.simulation.next_time, self._state.next_at, command_at, posted)
            if posted <= now:
                heapq.heappop(self._queue)[2]()
            elif command_at <= now:
                command_at += 1.0 / _COMMANDS
                wanted = self.driver(now - begin, self.simulation.pose(0))
                self._post(now + _COMMAND_DELAY, partial(self._step, VelocityCommand(0, wanted, now)))
            elif self._state.next_at <= now:
                self._step(None)
            else:
                tick = self.simulation.advance()
                self._sense(tick)
                pose = self.simulation.pose(0)
                self.way += math.dist(pose[:2], before[:2])
                before = pose
                if until(pose):
                    break
        return self.simulation.time - begin

    def _post(self, at: float, action: Callable[[], None]) -> None:
        heapq.heappush(self._queue, (at, next(self._numbers), action))

    @property
    def _now(self) -> float:
        return max(self.simulation.time, self._state.now)

    def _step(self, event: Event | None) -> None:
        now = max(self._state.now, self._state.next_at if event is None else self.simulation.time)
        began = time.thread_time()
        self._state, output = step(self._state, event, now)
        if output is not None:
            self.seconds += time.thread_time() - began
            self.decisions += 1
            self._post(now + _COMMAND_DELAY, lambda: self.simulation.command(0, output.forward, output.turn))

    def _sense(self, tick: SimulationTick) -> None:
        base, at = self.base, tick.time
        if "odometry" in tick.due:
            odometry = self.simulation.odometry(0)
            forward, turn, left = odometry.velocity
            reading = Odometer(odometry.pose, forward, turn, at, left)
            self._post(at + _SENSOR_DELAY, lambda: self._take(move(self.sight, reading)))
        seen = []
        ranges = self._head.measure(due="scan" in tick.due) if self._head else None
        if "scan" in tick.due and base.lidar and (ranges is not None or not self._head):
            step = (base.lidar.angle_max - base.lidar.angle_min) / (base.lidar.samples - 1)
            limits = base.lidar.range_min, base.lidar.range_max
            if self._head and ranges is not None:
                turn = self._head.increment * (base.lidar.samples - 1)
                scan = SensorRanges(ranges, limits, self._head.first, base.lidar.angle_min, step, turn)
            else:
                scan = SensorRanges(self.simulation.scan(0), limits, at, base.lidar.angle_min, step)
            seen.append((self.sight.sensors[0], math.inf))
            self._look(self.sight.sensors[0], scan, at)
        if "sonars" in tick.due and base.sonars:
            sonars = self.sight.sensors[1 if base.lidar else 0 :]
            limits = base.sonars.range_min, base.sonars.range_max
            for sensor, value in zip(sonars, self.simulation.senses[0].find(SonarSense).ranges(), strict=True):
                seen.append((sensor, float(value)))
                self._look(sensor, SensorRanges(np.array([value]), limits, at, cone=base.sonars.field_of_view), at)
        if seen:
            self._past.append((at, self.simulation.pose(0), tuple(seen)))
            self._past = [each for each in self._past if at - each[0] < MEMORY]
        pressed = self.simulation.senses[0].find(BumperSense).pressed(at) if base.bumpers else {}
        for name, state in pressed.items():
            if self._pressed.get(name, False) is not state:
                points = contact_points(base, self.sight.hull, ("bumper", name)) if state else None
                self._post(at + _SENSOR_DELAY, partial(self._touch, name, points))
        self._pressed = pressed
        if self.simulation.collisions[0] > self._collisions:
            self._collisions = self.simulation.collisions[0]
            self._judge(at)

    def _look(self, sensor: RangeSensor, reading: SensorRanges, at: float) -> None:
        def take() -> None:
            began = time.thread_time()
            sight = look(self.sight, sensor, reading)
            self.readings += time.thread_time() - began
            self._take(sight)

        self._post(at + _SENSOR_DELAY, take)

    def _touch(self, name: str, points: Floats | None) -> None:
        self._take(touch(self.sight, ("bumper", name), points))

    def _take(self, sight: Sight) -> None:
        self.sight = sight
        if self._state.guard is not None:
            self._state = self._state._replace(guard=replace(self._state.guard, sight=sight))

    def _judge(self, at: float) -> None:
        """Note a contact as seen when a sensor had its place in view lately, while that was clear of the outline."""
        pose = self.simulation.pose(0)
        touches = self.simulation._physics.touches(0)  # noqa: SLF001 - the bench looks behind the scene
        points: NDArray[np.float64] = pose.transform_points(np.concatenate(touches)) if touches else np.empty((0, 2))
        text = f"{at:.2f} s: {np.round(pose.inverse().transform_points(points), 2).tolist()} in the base's frame"
        (self.contacts if self._in_view(points) else self.unseen).append(text)

    def _in_view(self, points: NDArray[np.float64]) -> bool:
        for _, pose, sensors in self._past:
            local = pose.inverse().transform_points(points)
            clear = self.sight.hull.distances(local) > _CLEAR if len(local) else np.empty(0, bool)
            for sensor, value in sensors:
                near = np.hypot(*(local - sensor.mount.offset[:2]).T) <= value + 0.1
                if (sensor.sees(local) & clear & near).any():
                    return True
        return False
