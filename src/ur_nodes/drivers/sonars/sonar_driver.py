"""A driver of sonars on pins: they take turns, and each echo becomes a range."""

from collections.abc import Callable, Iterable
from functools import partial

from ur.robot.base import Sonars
from ur_nodes.drivers.health import HealthMeter, Report
from ur_nodes.drivers.lines.line import REPORT, PolledDevice, PolledUser
from ur_nodes.drivers.sonars.echoes import Listened, SonarPins, SonarPort, find_echo, make_range
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Range

PERIOD = 0.05  # s between two sonars, as pi_sonar: the echoes of the one before have died away
_MISSES = 12  # turns without an echo, after which a sonar is reported
_HELP = (
    "expected the GPIO chip of a Raspberry Pi; is this user in its group (gpio or dialout),"
    " and does no other program use its pins (pigpiod)? It is opened again by itself"
)


class SonarDriver:
    """Triggers one sonar after the other, and publishes what its echo says."""

    def __init__(
        self,
        node: Node,
        sonars: Sonars,
        pins: Iterable[SonarPins],
        device: tuple[str, Callable[[], SonarPort | str]],
        report: Report = lambda _: None,
    ) -> None:
        """`device` is its file and what opens it; `report` gets its health."""
        self._node, self._sonars, self._name = node, sonars, device[0]
        self._pairs = list(zip((each.frame for each in sonars.at), pins, strict=True))
        self._ranges = node.publish(sonars.topic, Range, Quality.EVERY)
        self._misses = dict.fromkeys((frame for frame, _ in self._pairs), 0)
        self._turn = 0
        self._health = HealthMeter(node, self._name, f"{len(self._pairs)} sonars", report)
        self._device = PolledDevice(node, *device, PolledUser(self._opened, self._lost))
        node.every(PERIOD, self._beat, steady=True)

    def _opened(self) -> None:
        self._node.log.info(f"{self._name} is open, with {len(self._pairs)} sonars")
        self._health.note(open=True, reason="")

    def _lost(self, reason: str) -> None:
        self._health.note(open=False, reason=reason)
        self._node.log.error(f"{self._name}: {reason}; {_HELP}")

    def _beat(self) -> None:
        frame, pins = self._pairs[self._turn]
        self._device.ask(lambda port: port.ping(pins), partial(self._on_echo, frame, pins))

    def _on_echo(self, frame: str, pins: SonarPins, listened: Listened, now: int) -> None:
        self._turn = (self._turn + 1) % len(self._pairs)
        echo = None if listened.busy else find_echo(listened.edges, pins.echo, listened.triggered)
        if echo:
            stamp = now - (listened.ended - echo.time)
            self._ranges.send(make_range(self._sonars, frame, echo.distance, stamp))
        self._health.count(int(echo is not None), int(echo is None))
        self._misses[frame] = 0 if echo else self._misses[frame] + 1
        if self._misses[frame] >= _MISSES:
            if all(misses >= _MISSES - 1 for misses in self._misses.values()):
                text = "no echo of any sonar; is their board plugged in?"
            elif listened.busy:
                text = f"the echo pin {pins.echo} of {frame} stays high; check the sonar and its cable"
            else:
                text = f"no echo of {frame}, at the pins {pins.trigger} and {pins.echo}; is it plugged in?"
            self._node.log.warn(f"{self._name}: {text}", every=REPORT)
