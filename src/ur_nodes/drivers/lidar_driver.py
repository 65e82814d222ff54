"""A driver of a lidar: what it measures to scans."""

import math

from ur.robot.base import Lidar
from ur_nodes.drivers.health import HealthMeter, Report
from ur_nodes.drivers.lidars.lidar import LidarProtocol
from ur_nodes.drivers.lidars.turns import TurnCollector
from ur_nodes.drivers.lines.line import REPORT, Connect, LineSettings, LineUser, describe_loss
from ur_nodes.drivers.readings import DeviceIdentity, MeasuredBeams, Reply
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Scan

_LOOK = 0.5  # s
_BATCH = 0.02  # s; a turn takes 0.1 to 0.2 s
_ASK_AGAIN = 3.0  # s without beams, after which the lidar gets the handshake again: its motor needs a while


class LidarDriver:
    """Publishes a scan for each turn; repeats the handshake when it measures nothing."""

    def __init__(
        self,
        node: Node,
        lidar: Lidar,
        protocol: LidarProtocol,
        connect: Connect,
        offset: float,
        report: Report = lambda _: None,
    ) -> None:
        """`report` gets the health of the lidar."""
        self._node, self._protocol = node, protocol
        self._sweep = TurnCollector(lidar, offset)
        self._scans = node.publish(lidar.topic, Scan)
        self._open = False
        self._known = ""
        self._measured = self._handshaken = -math.inf
        node.every(_LOOK, self._look, steady=True)
        node.on_end(self._end)
        settings = LineSettings(protocol.baud, dtr=protocol.dtr, batch=_BATCH)
        self._rejected = protocol.rejected
        self._line = connect(LineUser(self._opened, self._received, self._lost), settings)
        self._health = HealthMeter(node, self._line.name, protocol.name, report)

    def _look(self) -> None:
        now = self._node.steady()
        if self._open and now - max(self._measured, self._handshaken) > _ASK_AGAIN:
            text = f"no beams of {self._protocol.name}; does it turn, and is this its device (ur devices)?"
            self._node.log.warn(f"{self._line.name}: {text}", every=REPORT)
            self._handshake()

    def _opened(self) -> None:
        self._open, self._known = True, ""
        self._measured = -math.inf
        self._sweep.forget()
        self._node.log.info(f"{self._line.name} is open, expecting {self._protocol.name}")
        self._health.note(open=True, reason="", problem="")
        self._handshake()

    def _handshake(self) -> None:
        self._handshaken = self._node.steady()
        self._line.write(self._protocol.handshake())

    def _lost(self, reason: str) -> None:
        self._open = False
        self._health.note(open=False, reason=reason)
        self._node.log.error(describe_loss(self._line, reason, self._protocol.name))

    def _received(self, data: bytes, stamp: int) -> None:
        frames = 0
        for reading in self._protocol.receive(data):
            if isinstance(reading, MeasuredBeams):
                frames += reading.frames
                self._measured = self._node.steady()
                for scan in self._sweep.add(reading, stamp):
                    self._scans.send(scan)
            elif isinstance(reading, DeviceIdentity):
                if reading.problem:
                    self._health.note(problem=reading.problem)
                    self._node.log.error(f"{self._line.name}: {self._protocol.name}: {reading.problem}", every=REPORT)
                elif reading.text != self._known:
                    self._known = reading.text
                    self._health.note(firmware=reading.text)
                    self._node.log.info(f"{self._line.name}: {self._protocol.name}: {reading.text}")
            elif isinstance(reading, Reply):
                self._line.write(reading.data)
        self._health.count(frames, self._protocol.rejected - self._rejected)
        self._rejected = self._protocol.rejected

    def _end(self) -> None:
        self._open = False
        self._line.write(self._protocol.shutdown())
        self._line.close()
