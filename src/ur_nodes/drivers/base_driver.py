"""A driver of a base: commands to its board, and what the board reports to the topics that the base's file names."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from ur.robot.base import Base, Bumpers, Cliffs
from ur_nodes.drivers.base_states import WHEEL_JOINTS
from ur_nodes.drivers.boards.board import MotorBoard
from ur_nodes.drivers.health import HealthMeter, Report
from ur_nodes.drivers.lidars.turns import TurnCollector
from ur_nodes.drivers.lines.line import REPORT, Connect, LineSettings, LineUser, describe_loss
from ur_nodes.drivers.readings import Contacts, Counts, DeviceIdentity, MeasuredBeams, Motors, Power, Reading, SonarEcho
from ur_nodes.drivers.sonars.echoes import make_range
from ur_nodes.geometry.dead_reckoning import SPEED_COVARIANCE, DeadReckoning, covariance_matrix
from ur_nodes.geometry.pose import Pose3, quaternion_of_yaw
from ur_nodes.motion.ramp import WheelDrive
from ur_nodes.ports.node import SECOND, Node, Publisher
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Joints, Odometry, Range, Scan, Transform, Twist

SLACK = 0.1  # s: readings arrive late, and two at once
_BEYOND = 2.0  # times the fastest speed of a rim


@dataclass(frozen=True, slots=True)
class Motion:
    """The motion between two readings: m/s and rad/s of the base, rad/s of the wheels."""

    forward: float
    turn: float
    wheel_speeds: tuple[float, float]


class CounterOdometry:
    """Sums up readings of the counters; `angles` are those of the wheels since the first one, rad."""

    def __init__(self, base: Base, counts_per_turn: float) -> None:
        errors, limits = base.odometry, base.limits
        self._radius = base.wheels.radius
        self._turn = 2.0 * math.pi / counts_per_turn
        rim = limits.velocity + limits.angular_velocity * base.wheels.separation / 2.0
        self._fastest = _BEYOND * rim / self._radius  # rad/s
        self._last: tuple[Counts, float] | None = None
        self.reckoning = DeadReckoning(base.wheels.separation, errors.wheel_noise**2 + errors.radius_error**2)
        self.angles = (0.0, 0.0)

    @property
    def begun(self) -> bool:
        """There was a reading since the beginning, or since the device was away."""
        return self._last is not None

    def forget(self) -> None:
        """The device was away: its next reading is a new beginning, and the pose stays."""
        self._last = None

    def update(self, counts: Counts, time: float) -> Motion | None:
        """Take a reading at a time (s).

        Returns None, and moves nothing, for the first one and for one that no wheel can have turned: a counter that was
        set back, or a damaged reading. The next one counts from it.
        """
        last, self._last = self._last, (counts, time)
        if last is None:
            return None
        passed = time - last[1]
        left = _difference(counts.left, last[0].left, counts.bits) * self._turn
        right = _difference(counts.right, last[0].right, counts.bits) * self._turn
        if max(abs(left), abs(right)) > self._fastest * (max(passed, 0.0) + SLACK):
            return None
        self.angles = (self.angles[0] + left, self.angles[1] + right)
        distance, turn = self.reckoning.move(left * self._radius, right * self._radius)
        if passed <= 0.0:
            return Motion(0.0, 0.0, (0.0, 0.0))
        return Motion(distance / passed, turn / passed, (left / passed, right / passed))


def _difference(now: int, before: int, bits: int) -> int:
    """The shortest way from one reading of a counter that wraps to the next."""
    half = 1 << (bits - 1)
    return (now - before + half) % (2 * half) - half


_BATTERY_PERIOD = 1.0  # s
_WARN_EVERY = 60.0  # s


class BaseTopics:
    """Publishers of a base. Set `battery` to what was measured last; it is sent once a second."""

    def __init__(self, node: Node, base: Base, odometer: CounterOdometry) -> None:
        self._node, self._odometer = node, odometer
        self._period = SECOND / base.odometry.rate
        self._next = 0
        self._odom = node.publish("odom", Odometry)
        self._joints = node.publish("joint_states", Joints)
        self._frames = node.publish("/tf", tuple, Quality.EVERY)
        self.battery: Power | None = None
        self._properties = base.battery
        self._battery = node.publish(base.battery.topic, Battery) if base.battery else None
        self._contacts: dict[tuple[str, str], Publisher[bool]] = {}
        parts: list[tuple[str, Bumpers | Cliffs | None]] = [("bumper", base.bumpers), ("cliff", base.cliffs)]
        for kind, part in parts:
            for name, topic in zip((each.name for each in part.at), part.topics(), strict=True) if part else ():
                self._contacts[kind, name] = node.publish(topic, bool, Quality.LATCHED)
        own_lidar = base.lidar if not any(each.part == "lidar" for each in base.drivers) else None
        self._turns = TurnCollector(own_lidar) if own_lidar else None
        self._scans = node.publish(own_lidar.topic, Scan) if own_lidar else None
        self._sonars = base.sonars if not any(each.part == "sonars" for each in base.drivers) else None
        self._echoes = node.publish(self._sonars.topic, Range, Quality.EVERY) if self._sonars else None
        self._reported: dict[tuple[str, str], bool] = {}
        node.every(_BATTERY_PERIOD, self._beat)

    def forget(self) -> None:
        """The device is away: what it measured is no longer known."""
        self.battery = None
        self._reported.clear()

    def send_motion(self, motion: Motion, stamp: int) -> None:
        """Send odometry, joints and the transform, at most as often as the base file says."""
        if stamp < self._next and stamp > self._next - 10 * self._period:
            return
        self._next = max(self._next + round(self._period), stamp - round(self._period / 2.0))
        reckoning = self._odometer.reckoning
        covariance = covariance_matrix(reckoning.covariance)
        x, y, yaw = reckoning.pose
        self._frames.send((Transform(stamp, "odom", "base_footprint", Pose3(x, y, 0.0, *quaternion_of_yaw(yaw))),))
        twist = Twist(motion.forward, motion.turn)
        self._odom.send(Odometry(stamp, "odom", "base_footprint", reckoning.pose, twist, covariance, SPEED_COVARIANCE))
        self._joints.send(Joints(stamp, WHEEL_JOINTS, self._odometer.angles, motion.wheel_speeds))

    def send_contacts(self, contacts: Contacts) -> None:
        """Send the bumpers or cliff sensors that have changed, of those that the base file names."""
        for name, state in contacts.states:
            key = (contacts.kind, name)
            if key in self._contacts and self._reported.get(key) is not state:
                self._reported[key] = state
                self._contacts[key].send(state)

    def send_beams(self, beams: MeasuredBeams, stamp: int) -> None:
        """Send the scans that beams complete, where the base has a lidar without a driver of its own."""
        if self._scans and self._turns:
            for scan in self._turns.add(beams, stamp):
                self._scans.send(scan)

    def send_echo(self, echo: SonarEcho, stamp: int) -> None:
        """Send a range, where the base has sonars without a driver of their own."""
        if self._echoes and self._sonars and echo.number < len(self._sonars.at):
            measured = stamp - round(echo.age * SECOND)
            self._echoes.send(make_range(self._sonars, self._sonars.at[echo.number].frame, echo.distance, measured))

    def _beat(self) -> None:
        battery, now = self._properties, self.battery
        if self._battery is None or battery is None or now is None:
            return
        capacity = battery.design_capacity if math.isnan(now.capacity) or now.capacity <= 0.0 else now.capacity
        if math.isnan(now.charge):
            span = battery.voltage_full - battery.voltage_empty
            fraction = min(1.0, max(0.0, (now.voltage - battery.voltage_empty) / span))
        else:
            fraction = min(1.0, max(0.0, now.charge / capacity))
        stamp, amounts = self._node.now(), (now.voltage, now.current, now.charge, capacity)
        self._battery.send(Battery(stamp, *amounts, fraction, now.charging, battery.technology))
        if now.voltage < battery.voltage_empty:
            self._node.log.warn(f"the battery is empty ({now.voltage:.1f} V); charge it", every=_WARN_EVERY)


COMMAND_AGE = 0.15  # s after the last command, at which the motors stop, without a ramp
BLIND = 0.4  # s without counts, after which the base does not drive
_ASK_AGAIN = 1.0  # s without an answer, after which the board gets the handshake again
_BAD, _TOO_BAD, _WORST = 3, 6, 15  # an implausible reading adds to what a plausible one takes 1 from; the motors stop


class BaseDriver:
    """Moves the base within its limits while commands are fresh, its board answers and its counts make sense."""

    def __init__(
        self,
        node: Node,
        base: Base,
        board: MotorBoard,
        connect: Connect,
        report: Report = lambda _: None,
        orphaned: Callable[[], bool] = lambda: False,
    ) -> None:
        """`report` gets the health of the board; the base does not drive while `orphaned`: its host was killed."""
        self._node, self._board, self._orphaned = node, board, orphaned
        self._drive = WheelDrive(base, board.period)
        self._radius = base.wheels.radius
        self._odometer = CounterOdometry(base, board.counts_per_turn)
        self._topics = BaseTopics(node, base, self._odometer)
        self._commanded = self._counted = self._answered = self._handshaken = -math.inf
        self._open = self._known = False
        self._bad_counts = 0
        self._problem = ""  # why it does not drive now
        self._unfit = ""  # why it never does, by its own account
        node.subscribe("cmd_vel", Twist, self._command)
        node.every(board.period, self._beat, steady=True)
        node.on_end(self._end)
        user = LineUser(self._opened, self._received, self._lost)
        self._empty = base.battery.voltage_empty if base.battery else 0.0
        self._rejected = board.rejected
        self._line = connect(user, LineSettings(board.baud, board.stop(), shutdown=board.shutdown()))
        self._health = HealthMeter(node, self._line.name, board.name, report)

    def _command(self, command: Twist) -> None:
        self._commanded = self._node.steady()
        self._drive.command(command.forward, command.turn, self._commanded)

    def _beat(self) -> None:
        """Send the speeds of this period; nothing while the line is closed."""
        now = self._node.steady()
        if not self._open:
            return
        if now - max(self._answered, self._handshaken) > _ASK_AGAIN:
            expected = f"no answer of {self._board.name}; is it switched on, and is this its device (ur devices)?"
            self._node.log.warn(f"{self._line.name}: {expected}", every=REPORT)
            self._handshake(now)
        speeds = self._drive.update(now)
        reason = self._obstacle(now)
        if now - self._commanded > COMMAND_AGE or reason:
            self._drive.halt()
            speeds = (0.0, 0.0)
        left, right = (speed * self._radius for speed in speeds)
        self._line.write(self._board.drive(left, right), moving=speeds != (0.0, 0.0))
        if reason and now - self._commanded <= COMMAND_AGE:
            self._node.log.warn(f"{self._line.name}: the base does not drive: {reason}", every=REPORT)

    def _obstacle(self, now: float) -> str:
        """Return why the base may not drive now; '' where it may."""
        if self._orphaned():  # SIGTERM says so, too, but may take longer than a period
            return "the process that started this driver was killed"
        if self._bad_counts >= _TOO_BAD:
            return "its wheel counters jump; check the encoders and their cables"
        if now - self._counted > BLIND:
            return f"no wheel counts for {BLIND:g} s"
        return self._unfit or self._problem

    def _opened(self) -> None:
        self._open, self._known, self._problem, self._unfit = True, False, "", ""
        self._answered = -math.inf
        self._drive.halt()
        self._odometer.forget()
        self._node.log.info(f"{self._line.name} is open, expecting {self._board.name}")
        self._health.note(open=True, reason="", problem="", held="", voltage=0.0)
        self._line.write(self._board.stop())
        self._handshake(self._node.steady())

    def _handshake(self, now: float) -> None:
        self._handshaken = now
        self._line.write(self._board.handshake())

    def _lost(self, reason: str) -> None:
        self._open = False
        self._drive.halt()
        self._topics.forget()
        self._health.note(open=False, reason=reason)
        self._node.log.error(describe_loss(self._line, reason, self._board.name))

    def _received(self, data: bytes, stamp: int) -> None:
        late = (self._node.now() - stamp) / SECOND
        frames = 0
        for reading in self._board.receive(data):
            self._on_reading(reading, stamp, self._node.steady() - late)
            frames += isinstance(reading, Counts)
        self._health.count(frames, self._board.rejected - self._rejected)
        self._rejected = self._board.rejected

    def _on_reading(self, reading: Reading, stamp: int, time: float) -> None:
        if isinstance(reading, Counts):
            first = not self._odometer.begun
            motion = self._odometer.update(reading, time)
            if motion is not None:
                self._bad_counts = max(0, self._bad_counts - 1)
                self._topics.send_motion(motion, stamp)
            elif not first:
                self._bad_counts = min(_WORST, self._bad_counts + _BAD)
                text = "wheel counts jumped, and are left out; a reset of the board, or noise on its line?"
                self._node.log.warn(f"{self._line.name}: {text}", every=REPORT)
            self._counted = time
        elif isinstance(reading, Power):
            self._topics.battery = reading
            measured = reading.voltage if 0.0 <= reading.voltage < 1000.0 else 0.0
            self._health.note(voltage=measured, empty=reading.voltage < self._empty)
        elif isinstance(reading, Contacts):
            self._topics.send_contacts(reading)
        elif isinstance(reading, MeasuredBeams):
            self._topics.send_beams(reading, stamp)
        elif isinstance(reading, SonarEcho):
            self._topics.send_echo(reading, stamp)
        elif isinstance(reading, Motors):
            reason = "" if reading.ready else reading.reason
            if reason and reason != self._problem:
                self._drive.halt()
                self._node.log.warn(f"{self._line.name}: {self._board.name} does not drive: {reason}")
            elif self._problem and not reason:
                self._node.log.info(f"{self._line.name}: {self._board.name} drives again")
            self._problem = reason
            self._health.note(held=reason)
        elif isinstance(reading, DeviceIdentity):
            self._on_identity(reading)
        self._answered = time

    def _on_identity(self, identity: DeviceIdentity) -> None:
        if identity.problem:
            self._unfit = identity.problem
            self._health.note(problem=identity.problem)
            self._node.log.error(f"{self._line.name}: {self._board.name}: {identity.problem}", every=REPORT)
        elif not self._known:
            self._node.log.info(f"{self._line.name}: {self._board.name}: {identity.text}")
            self._health.note(firmware=identity.text)
        self._known = True

    def _end(self) -> None:
        self._open = False
        self._line.write(self._board.stop())
        self._line.write(self._board.shutdown())
        self._line.close()
