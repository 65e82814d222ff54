"""A driver of a base: commands to its board, and what the board reports to topics."""

import math
from collections.abc import Callable

from ur.robot.base import Base
from ur_nodes.drivers.base_topics import BaseTopics
from ur_nodes.drivers.boards.board import MotorBoard
from ur_nodes.drivers.health import HealthMeter, Report
from ur_nodes.drivers.lines.line import REPORT, Connect, LineSettings, LineUser, describe_loss
from ur_nodes.drivers.odometer import CounterOdometry
from ur_nodes.drivers.readings import (
    Contacts,
    Counts,
    DeviceIdentity,
    MeasuredBeams,
    Motors,
    Power,
    Reading,
    SonarEcho,
)
from ur_nodes.motion.wheel_drive import WheelDrive
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.values import Twist

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
            self._report_silence()
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

    def _report_silence(self) -> None:
        expected = f"no answer of {self._board.name}; is it switched on, and is this its device (ur devices)?"
        self._node.log.warn(f"{self._line.name}: {expected}", every=REPORT)

    def _received(self, data: bytes, stamp: int) -> None:
        late = (self._node.now() - stamp) / SECOND
        frames = 0
        for reading in self._board.receive(data):
            self._take(reading, stamp, self._node.steady() - late)
            frames += isinstance(reading, Counts)
        self._health.count(frames, self._board.rejected - self._rejected)
        self._rejected = self._board.rejected

    def _take(self, reading: Reading, stamp: int, time: float) -> None:
        if isinstance(reading, Counts):
            self._on_counts(reading, stamp, time)
        elif isinstance(reading, Power):
            self._topics.battery = reading
            self._health.note(voltage=_amount(reading.voltage), empty=reading.voltage < self._empty)
        elif isinstance(reading, Contacts):
            self._topics.send_contacts(reading)
        elif isinstance(reading, MeasuredBeams):
            self._topics.send_beams(reading, stamp)
        elif isinstance(reading, SonarEcho):
            self._topics.send_echo(reading, stamp)
        elif isinstance(reading, Motors):
            self._on_motors(reading)
        elif isinstance(reading, DeviceIdentity):
            self._on_identity(reading)
        self._answered = time

    def _on_counts(self, counts: Counts, stamp: int, time: float) -> None:
        first = not self._odometer.begun
        motion = self._odometer.update(counts, time)
        if motion is not None:
            self._bad_counts = max(0, self._bad_counts - 1)
            self._topics.send_motion(motion, stamp)
        elif not first:
            self._bad_counts = min(_WORST, self._bad_counts + _BAD)
            text = "wheel counts jumped, and are left out; a reset of the board, or noise on its line?"
            self._node.log.warn(f"{self._line.name}: {text}", every=REPORT)
        self._counted = time

    def _on_motors(self, motors: Motors) -> None:
        reason = "" if motors.ready else motors.reason
        if reason and reason != self._problem:
            self._drive.halt()
            self._node.log.warn(f"{self._line.name}: {self._board.name} does not drive: {reason}")
        elif self._problem and not reason:
            self._node.log.info(f"{self._line.name}: {self._board.name} drives again")
        self._problem = reason
        self._health.note(held=reason)

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


def _amount(value: float) -> float:
    """A value that is measured; 0.0 for no number."""
    return value if 0.0 <= value < 1000.0 else 0.0
