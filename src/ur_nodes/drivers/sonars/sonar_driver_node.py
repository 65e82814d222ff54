"""The driver of sonars on the pins of a Raspberry Pi, as a node: the board that the base file names."""

import sys
import time
from collections.abc import Callable, Iterable
from datetime import timedelta
from functools import partial

import gpiod
from gpiod.line import Bias, Direction, Value
from gpiod.line import Edge as Detection

from ur.source.diagnostic import user_error
from ur_nodes.drivers.health import report_to_file
from ur_nodes.drivers.lines.line import explain_error
from ur_nodes.drivers.registry import SONARS, find_device, read_base
from ur_nodes.drivers.sonars.echoes import LONGEST, Listened, PinEdge, SonarPins, SonarPort, find_echo
from ur_nodes.drivers.sonars.sonar_driver import SonarDriver
from ur_nodes.ports.node import Node
from ur_nodes.run import run

_PULSE = 10e-6  # s
_EVENTS = 64  # edges that the kernel keeps
_MOST = 500  # edges of one echo; more are noise

RequestLines = Callable[..., gpiod.LineRequest]


class GpioPort:
    """See SonarPort. Raises OSError where the chip or a pin cannot be had."""

    def __init__(self, path: str, sonars: Iterable[SonarPins], request: RequestLines) -> None:
        trigger = gpiod.LineSettings(direction=Direction.OUTPUT, output_value=Value.INACTIVE)
        echo = gpiod.LineSettings(direction=Direction.INPUT, edge_detection=Detection.BOTH, bias=Bias.PULL_DOWN)
        pins: dict[Iterable[int | str] | int | str, gpiod.LineSettings | None] = {}
        for each in sonars:
            pins |= {each.trigger: trigger, each.echo: echo}
        self._lines = request(path, config=pins, consumer="ur sonars", event_buffer_size=_EVENTS)

    def ping(self, sonar: SonarPins) -> Listened | str:
        try:
            return self._ping(sonar)
        except OSError as problem:
            return explain_error(problem)

    def _ping(self, sonar: SonarPins) -> Listened:
        if self._lines.wait_edge_events(timedelta()):
            self._lines.read_edge_events()  # of a sonar before, too late
        busy = self._lines.get_value(sonar.echo) is Value.ACTIVE
        if not busy:
            self._lines.set_value(sonar.trigger, Value.ACTIVE)
            time.sleep(_PULSE)
        triggered = time.monotonic_ns()
        if not busy:
            self._lines.set_value(sonar.trigger, Value.INACTIVE)
        edges: list[PinEdge] = []
        while (left := LONGEST - (time.monotonic_ns() - triggered) / 1e9) > 0.0 and len(edges) < _MOST:
            if self._lines.wait_edge_events(timedelta(seconds=left)):
                edges += map(_edge, self._lines.read_edge_events())
            if find_echo(edges, sonar.echo, triggered):
                break
        return Listened(tuple(edges), triggered, time.monotonic_ns(), busy)

    def close(self) -> None:
        self._lines.release()


def _edge(event: gpiod.EdgeEvent) -> PinEdge:
    return PinEdge(event.line_offset, event.event_type is gpiod.EdgeEvent.Type.RISING_EDGE, event.timestamp_ns)


def open_gpio(path: str, sonars: Iterable[SonarPins], request: RequestLines = gpiod.request_lines) -> SonarPort | str:
    """Open the chip; or why it cannot be."""
    try:
        return GpioPort(path, sonars, request)
    except OSError as problem:
        return explain_error(problem)


def start(node: Node) -> None:
    """Read the parameters and open the pins. Raises UserError."""
    base = read_base(node.parameters)
    driver = next((each for each in base.drivers if each.part == "sonars"), None)
    kind = node.parameters.text("sonars", "") or (driver.protocol if driver else "")
    if kind not in SONARS:
        node.parameters.fail("sonars", kind, f"one of {', '.join(SONARS)}", SONARS)
    pins = SONARS[kind]()
    if base.sonars is None or len(base.sonars.at) != len(pins):
        there = len(base.sonars.at) if base.sonars else 0
        raise user_error(f"base {base.name!r} has {there} sonars, expected the {len(pins)} of {kind}", rule="no-sonars")
    path = find_device(node.parameters, driver)
    SonarDriver(node, base.sonars, pins, (path, partial(open_gpio, path, pins)), report_to_file(node))


if __name__ == "__main__":
    sys.exit(run("sonar_driver", start))
