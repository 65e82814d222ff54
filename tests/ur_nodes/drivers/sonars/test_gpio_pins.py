"""The pins of a GPIO chip through libgpiod, whose lines are played by the test."""

import time
from dataclasses import dataclass, field
from datetime import timedelta
from typing import Any

import gpiod
import pytest
from gpiod.line import Value

from ur_nodes.drivers.sonars.echoes import LONGEST, Listened, SonarPins, SonarPort, find_echo
from ur_nodes.drivers.sonars.sonar_driver_node import open_gpio

SONAR = SonarPins(20, 21)
PULSE = 5_000_000  # ns


@dataclass
class Event:
    line_offset: int
    event_type: Any
    timestamp_ns: int


@dataclass
class Lines:
    """What gpiod.request_lines returns. After a trigger an echo of PULSE follows, unless the sonar is not there."""

    there: bool = True
    level: Value = Value.INACTIVE
    broken: bool = False
    waiting: list[list[Event]] = field(default_factory=list)
    values: list[tuple[int, Value]] = field(default_factory=list)
    released: bool = False

    def wait_edge_events(self, timeout: timedelta) -> bool:
        if not self.waiting:
            time.sleep(timeout.total_seconds())
        return bool(self.waiting)

    def read_edge_events(self) -> list[Event]:
        return self.waiting.pop(0)

    def get_value(self, pin: int) -> Value:
        assert pin == SONAR.echo
        return self.level

    def set_value(self, pin: int, value: Value) -> None:
        if self.broken:
            raise OSError(19, "No such device")
        self.values.append((pin, value))
        if value is Value.INACTIVE and self.there:
            begun, kinds = time.monotonic_ns(), gpiod.EdgeEvent.Type
            self.waiting.append([Event(21, kinds.RISING_EDGE, begun)])
            self.waiting.append([Event(21, kinds.FALLING_EDGE, begun + PULSE)])

    def release(self) -> None:
        self.released = True


@pytest.fixture
def lines() -> Lines:
    return Lines()


def open_port(lines: Lines) -> SonarPort:
    def request(path: str, config: dict[int, Any], **_: Any) -> Any:
        assert (path, sorted(config)) == ("/dev/gpiochip0", [20, 21])
        return lines

    port = open_gpio("/dev/gpiochip0", (SONAR,), request)
    assert not isinstance(port, str)
    return port


def ping(port: SonarPort) -> Listened:
    listened = port.ping(SONAR)
    assert not isinstance(listened, str)
    return listened


def test_ping_triggers_and_returns_the_edges_with_the_times_of_the_kernel(lines: Lines) -> None:
    lines.waiting.append([Event(21, gpiod.EdgeEvent.Type.FALLING_EDGE, 1)])  # of the ping before
    port = open_port(lines)
    listened = ping(port)
    assert lines.values == [(20, Value.ACTIVE), (20, Value.INACTIVE)]
    echo = find_echo(listened.edges, SONAR.echo, listened.triggered)
    assert echo
    assert echo.distance == pytest.approx(0.8575)
    port.close()
    assert lines.released


def test_ping_without_an_echo_ends_after_a_while(lines: Lines) -> None:
    lines.there = False
    listened = ping(open_port(lines))
    assert (listened.edges, listened.busy) == ((), False)
    assert listened.ended - listened.triggered >= LONGEST * 1e9


def test_sonar_whose_echo_is_high_is_not_triggered(lines: Lines) -> None:
    lines.level = Value.ACTIVE
    assert ping(open_port(lines)).busy
    assert lines.values == []


def test_chip_that_is_not_there_and_one_that_is_lost_are_told_apart(lines: Lines) -> None:
    port = open_port(lines)
    lines.broken = True
    assert port.ping(SONAR) == "no such device"


def test_file_that_is_no_chip_is_reported() -> None:
    assert open_gpio("/dev/nonesuch", (SONAR,)) == "no such file or directory"
