"""The operation of a simulation on a node: its pace, clock, due outputs, and services."""

from collections.abc import Collection
from typing import TYPE_CHECKING

from ur.source.diagnostic import UserError
from ur_nodes.ports.node import SECOND, Node, Timer
from ur_nodes.ports.services import Place, Silent, Switch, Trigger
from ur_nodes.ports.values import ClockTime, Poses, Result
from ur_nodes.simulator.camera.camera_topics import SimulatedCameraTopics
from ur_nodes.simulator.robot_topics import RobotTopics
from ur_nodes.simulator.schedule import SimulationTick
from ur_nodes.simulator.settings import SimulatorSettings, list_prefixes
from ur_nodes.simulator.simulation import Simulation

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.bench import DeviceBench


class SensorTopics:
    """Publishers for what the base has. Topics without subscribers cost nothing, latched ones aside."""

    def __init__(
        self,
        node: Node,
        simulation: Simulation,
        robot: int,
        prefix: str,
        settings: SimulatorSettings,
        *,
        without: Collection[str] = (),
    ) -> None:
        """`prefix` is put before topics and frames: '' for a single robot, else 'robot_<n>/'.

        `without` are the keys of sensors that others publish.
        """
        self._simulation, self._robot = simulation, robot
        every = simulation.senses[robot].each
        senses = {name: sense for name, sense in every.items() if name not in without}
        sends = {name: sense.advertise(node, prefix, settings.quality) for name, sense in senses.items()}
        self._constant = [send for name, send in sends.items() if not senses[name].rate]
        self._timed = {name: send for name, send in sends.items() if senses[name].rate}

    def send(self, tick: SimulationTick, stamp: int) -> None:
        """Send the readings that are due."""
        for send in self._constant:
            send(tick.time, stamp)
        if not tick.due.isdisjoint(self._timed):
            for name, send in self._timed.items():
                if name in tick.due:
                    send(tick.time, stamp)


class Pacer:
    """Real times of simulated times: `speed` simulated seconds a second; 0 is as fast as possible.

    Times are computed from one anchor, so that errors do not accumulate. After a stall longer than `patience` (s) the
    anchor moves: what was missed is not made up for in a rush.
    """

    def __init__(self, speed: float, time: float, now: float, patience: float = 0.25) -> None:
        self._speed = speed
        self._patience = patience
        self.restart(time, now)

    def restart(self, time: float, now: float) -> None:
        """Set simulated `time` to now (s of a steady clock)."""
        self._time = time
        self._now = now

    def wait(self, time: float, now: float) -> float:
        """Return the time (s) from `now` until simulated `time` is due; 0 if it is due."""
        if self._speed <= 0.0:
            return 0.0
        left = self.due(time) - now
        if left < -self._patience:
            self.restart(time, now)
            return 0.0
        return max(0.0, left)

    def due(self, time: float) -> float:
        """Return the time of the steady clock (s) at which a simulated time is due."""
        return self._now + (time - self._time) / self._speed if self._speed > 0.0 else self._now


_UNSTAMPED = frozenset(("control", "picture"))


class Operation:
    """Advances a simulation when its ticks are due. Commands and services come between two ticks."""

    def __init__(
        self,
        node: Node,
        simulation: Simulation,
        settings: SimulatorSettings,
        camera: SimulatedCameraTopics | None = None,
        bench: "DeviceBench | None" = None,
    ) -> None:
        """With a `bench` the robot is moved and read through its devices, and has no topics that they cover."""
        self._node = node
        self._simulation = simulation
        self._settings = settings
        self._camera, self._bench = camera, bench
        self._taking_pictures = self._paused = False
        self._next: Timer | None = None
        self._pacer = Pacer(settings.speed, simulation.time, node.steady())
        self._clock = node.publish("/clock", ClockTime, settings.quality) if settings.publish_clock else None
        self._next_clock = self._next_joints = 0.0
        self._transforms = node.publish("/tf", tuple, settings.quality)
        self._people = node.publish("~people", Poses, settings.quality) if simulation.has_people else None
        prefixes = list_prefixes(simulation)
        covered = bench.covers if bench else frozenset[str]()
        self._robots = [
            RobotTopics(node, simulation, n, prefix, settings, real=bench is not None)
            for n, prefix in enumerate(prefixes)
        ]
        self._sensors = [
            SensorTopics(node, simulation, n, prefix, settings, without=covered) for n, prefix in enumerate(prefixes)
        ]
        if bench:
            node.on_end(bench.close)
        node.serve("~pause", Switch, self._pause)
        node.serve("~step", Trigger, self._step)
        node.serve("~reset", Silent, self._reset)
        node.serve("~place", Place, self._place)

    def begin(self) -> None:
        """Schedule the next tick."""
        if self._next:
            self._next.cancel()
        left = self._pacer.wait(self._simulation.next_time, self._node.steady())
        self._next = self._node.after(left, self._go_on, steady=True)

    def _go_on(self) -> None:
        self._tick()
        self.begin()

    def _tick(self) -> None:
        tick = self._simulation.advance()
        if self._bench:
            self._bench.step()
        stamp = self._stamp(tick.time)
        joints = tick.time >= self._next_joints
        placed = tick.moved
        stamped = placed or joints or not tick.due <= _UNSTAMPED
        if self._clock and (stamped or tick.time >= self._next_clock):
            self._next_clock = tick.time + 1.0 / self._settings.clock_rate - 1e-6
            self._clock.send(ClockTime(stamp))
        if joints:
            self._next_joints = tick.time + 1.0 / self._settings.joint_rate - 1e-6
        if placed and not self._bench and self._transforms.subscribers():
            self._transforms.send(tuple(robot.transform(stamp) for robot in self._robots))
        self._send_robots(tick, stamp, joints=joints)
        if "odometry" in tick.due:
            if self._people and self._people.subscribers():
                self._people.send(Poses(stamp, self._settings.frames.map, self._simulation.people))
            if self._camera:
                self._watch(self._camera)
        for sensors in self._sensors:
            sensors.send(tick, stamp)
        if "picture" in tick.due and self._camera:
            self._camera.publish(stamp, self._simulation.state())

    def _send_robots(self, tick: SimulationTick, stamp: int, *, joints: bool) -> None:
        simulation = self._simulation
        for robot, collisions, strikes in zip(self._robots, simulation.collisions, simulation.strikes, strict=True):
            if "odometry" in tick.due:
                robot.send_odometry(stamp)
            robot.send_scan(stamp, due="scan" in tick.due)
            if joints:
                robot.send_joints(stamp)
            robot.send_collisions(collisions, strikes)

    def _watch(self, camera: SimulatedCameraTopics) -> None:
        """Schedule pictures only while their topics have subscribers."""
        if camera.wanted != self._taking_pictures:
            self._taking_pictures = not self._taking_pictures
            self._simulation.enable_pictures(camera.camera.rate if self._taking_pictures else 0.0)

    def _stamp(self, simulated: float) -> int:
        """Simulated time (ns) when it is the clock; otherwise the nodes' time at which the moment was due."""
        if self._clock:
            seconds = int(simulated)
            return seconds * SECOND + int((simulated - seconds) * SECOND)
        late = self._node.steady() - self._pacer.due(simulated)
        return self._node.now() - round(late * SECOND)

    def _pause(self, request: Switch) -> Result:
        self._paused = request.on
        self._pacer.restart(self._simulation.time, self._node.steady())
        if not self._paused:
            self.begin()
        elif self._next:
            self._next.cancel()
        return Result(success=True, text="paused" if request.on else "running")

    def _step(self, _request: Trigger) -> Result:
        if not self._paused:
            return Result(success=False, text="not paused, expected ~pause with true before ~step")
        end = self._simulation.time + self._settings.step_period - 1e-6
        while self._simulation.time < end:
            self._pacer.restart(self._simulation.time, self._node.steady())
            self._tick()
        return Result(success=True, text=f"simulated time {self._simulation.time:.3f} s")

    def _reset(self, _request: Silent) -> Result:
        self._simulation.reset()
        if not self._paused:
            self.begin()  # what is due next has changed
        return Result(success=True)

    def _place(self, request: Place) -> Result:
        if request.frame not in ("", self._settings.frames.map):
            text = f"a pose in frame {request.frame!r}, expected {self._settings.frames.map!r}"
            return Result(success=False, text=text)
        try:
            self._simulation.set_pose(request.name, request.pose)
        except UserError as problem:
            self._node.log.warn(f"~place: {problem}")
            return Result(success=False, text=str(problem))
        return Result(success=True)
