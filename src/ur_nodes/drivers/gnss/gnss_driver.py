"""A driver of a receiver of satellite navigation: its places to messages."""

from __future__ import annotations

import math

from ur_nodes.drivers.gnss.ublox import MeasuredPlace, Ublox
from ur_nodes.drivers.health import HealthMeter, Report
from ur_nodes.drivers.lines.line import REPORT, Connect, LineSettings, LineUser, describe_loss
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import GeoFix

_LOOK = 1.0  # s
_ASK_AGAIN = 3.0  # s without a message, after which the receiver is asked again: it forgets when it loses its power


class GnssDriver:
    """Publishes a fix for each message, also while the receiver does not know where it is."""

    def __init__(
        self, node: Node, frame: str, receiver: Ublox, connect: Connect, report: Report = lambda _: None
    ) -> None:
        """`frame` is that of its antenna; `report` gets its health."""
        self._node, self._frame, self._receiver = node, frame, receiver
        self._fixes = node.publish("fix", GeoFix)
        self._open = self._fixed = False
        self._answered = self._asked = -math.inf
        self._rejected = 0
        node.every(_LOOK, self._look, steady=True)
        node.on_end(self._end)
        self._line = connect(LineUser(self._opened, self._received, self._lost), LineSettings(receiver.baud))
        self._health = HealthMeter(node, self._line.name, receiver.name, report)

    def _look(self) -> None:
        now = self._node.steady()
        if self._open and now - max(self._answered, self._asked) > _ASK_AGAIN:
            text = f"no message of a {self._receiver.name}; is this its device, and its speed (ur devices)?"
            self._node.log.warn(f"{self._line.name}: {text}", every=REPORT)
            self._ask()

    def _opened(self) -> None:
        self._open, self._fixed = True, False
        self._node.log.info(f"{self._line.name} is open, expecting a {self._receiver.name}")
        self._health.note(open=True, reason="")
        self._ask()

    def _ask(self) -> None:
        self._asked = self._node.steady()
        self._line.write(self._receiver.greet())

    def _lost(self, reason: str) -> None:
        self._open = False
        self._health.note(open=False, reason=reason)
        self._node.log.error(describe_loss(self._line, reason, f"a {self._receiver.name}"))

    def _received(self, data: bytes, stamp: int) -> None:
        places = list(self._receiver.take(data))
        for place in places:
            self._send(place, stamp)
        self._health.count(len(places), self._receiver.rejected - self._rejected)
        self._rejected = self._receiver.rejected
        if places:
            self._answered = self._node.steady()

    def _send(self, place: MeasuredPlace, stamp: int) -> None:
        if place.fixed is not self._fixed:
            self._fixed = place.fixed
            state = "knows where it is" if place.fixed else "does not know where it is: does it see the sky?"
            self._node.log.info(f"{self._line.name}: the {self._receiver.name} {state} ({place.satellites} satellites)")
        ground, height = place.accuracy
        at = (place.latitude, place.longitude, place.altitude) if place.fixed else (math.nan, math.nan, math.nan)
        self._fixes.send(
            GeoFix(stamp, self._frame, *at, (ground**2, height**2), place.fixed, place.fixed and place.corrected)
        )

    def _end(self) -> None:
        self._open = False
        self._line.close()
