"""The driver of sonars on pins, behind a board of them: their ranges, times, faults and turns."""

import math
import random
from typing import Any

import pytest
from tests.base_contract import load
from tests.ur_nodes.drivers.sonars.echo_board import EchoBoard, distances

from ur.devices.driver_health import DriverHealth
from ur_nodes.drivers.registry import SONARS
from ur_nodes.drivers.sonars.echoes import PinEdge, find_echo
from ur_nodes.drivers.sonars.sonar_driver import SonarDriver
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.values import Range

PINS = SONARS["magni_sonars"]()
DEVICE = "/dev/gpiochip0"
AT = dict(zip((each.echo for each in PINS), (0.5, 1.0, 2.0, 3.0, 0.03), strict=True))


class Sonars:
    """The driver of a Magni's sonars on a bus, and a board of them."""

    def __init__(self, at: dict[int, float] | None = None) -> None:
        self.bus = Bus()
        self.board = EchoBoard(self.bus, distances(at or AT))
        self.ranges: list[Range] = []
        self.health: list[DriverHealth] = []
        self.bus.node("world").subscribe("sonars", Range, self.ranges.append)
        self.node: MemoryNode = self.bus.node("sonar_driver")
        sonars = load("magni", "").sonars
        assert sonars
        self.bus.durations[DEVICE] = 0.02
        SonarDriver(self.node, sonars, PINS, (DEVICE, self.board.open), self.health.append)

    @property
    def lines(self) -> list[str]:
        return [text for _, text in self.node.lines]


def test_pins_are_those_of_the_order_of_upstreams_frames() -> None:
    # pi_sonar.cpp: sonars.push_back(Sonar(20, 21, 0, nh)) ... Sonar(19, 26, 4, nh)
    assert [(each.trigger, each.echo) for each in PINS] == [(20, 21), (12, 16), (23, 24), (27, 22), (19, 26)]


def test_pulse_of_upstreams_scale_is_the_distance_and_its_middle_the_time() -> None:
    # pi_sonar.cpp: range = elapsed microseconds * 0.0001715
    edges = [PinEdge(21, True, 1_000_000), PinEdge(21, False, 11_000_000)]
    echo = find_echo(edges, 21, 0)
    assert echo
    assert echo.distance == pytest.approx(10_000 * 0.0001715)
    assert echo.time == 6_000_000
    assert find_echo(edges, 16, 0) is None
    assert find_echo(edges, 21, 2_000_000) is None  # it began before the trigger


@pytest.mark.parametrize(
    "edges",
    [
        [(True, 500), (False, 520), (True, 1000), (False, 11000)],  # a spike before
        [(False, 400), (True, 1000), (False, 11000)],  # the end of the one before
        [(True, 900), (True, 1000), (False, 11000)],  # a falling edge was lost
    ],
)
def test_first_whole_pulse_counts(edges: list[tuple[bool, int]]) -> None:
    echo = find_echo([PinEdge(21, up, at * 1000) for up, at in edges], 21, 0)
    assert echo
    assert echo.distance == pytest.approx(1.715)


def test_no_edges_of_any_order_raise_and_no_pulse_is_shorter_than_a_centimetre() -> None:
    source = random.Random(3)
    for _ in range(3000):
        edges = [
            PinEdge(source.choice((21, 16)), source.random() < 0.5, source.randrange(50_000_000))
            for _ in range(source.randrange(12))
        ]
        echo = find_echo(edges, 21, source.randrange(50_000_000))
        assert echo is None or echo.distance > 0.01


def test_sonars_take_turns_and_their_ranges_have_frames_limits_and_times() -> None:
    sonars = Sonars()
    sonars.bus.run(2.0)
    triggers = [each.trigger for each in PINS]
    assert sonars.board.pinged == (triggers * 9)[: len(sonars.board.pinged)]
    assert len(sonars.board.pinged) == 40
    latest = {each.frame: each for each in sonars.ranges}
    assert [round(latest[f"sonar_{n}"].range, 3) for n in range(4)] == [0.5, 1.0, 2.0, 3.0]
    assert latest["sonar_4"].range == -math.inf  # nearer than range_min
    assert (latest["sonar_0"].range_min, latest["sonar_0"].range_max) == (0.05, 4.0)
    assert latest["sonar_0"].field_of_view == pytest.approx(0.436, abs=0.001)
    # The sound was at the wall in the middle of the pulse; on this bus its end is the moment of the ping.
    for each in (each for each in sonars.ranges if each.frame == "sonar_3"):
        assert (each.stamp / 1e9 + 3.0 / 343.0 + 0.01) % 0.05 == pytest.approx(0.01, abs=0.001)


def test_nothing_in_reach_is_infinite() -> None:
    sonars = Sonars(dict.fromkeys(AT, 9.0))
    sonars.bus.run(1.0)
    assert {each.range for each in sonars.ranges} == {math.inf}


def test_chip_that_is_not_there_is_named_with_what_to_do_and_opened_again() -> None:
    sonars = Sonars()
    sonars.bus.run(1.0)
    sonars.board.plugged = False
    sonars.bus.run(5.0)
    (line,) = [each for each in sonars.lines if "no such device" in each]
    assert line.startswith("/dev/gpiochip0: no such device; expected the GPIO chip of a Raspberry Pi")
    assert "gpio or dialout" in line
    assert not sonars.health[-1].open
    count = len(sonars.ranges)
    sonars.board.plugged = True
    sonars.bus.run(12.0)
    assert len(sonars.ranges) > count + 15
    assert sonars.health[-1].open
    assert sonars.health[-1].frames == pytest.approx(20.0, abs=2.0)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"silent": frozenset({22})}, "no echo of sonar_3, at the pins 27 and 22; is it plugged in?"),
        ({"silent": frozenset(AT)}, "no echo of any sonar; is their board plugged in?"),
        ({"stuck": frozenset({24})}, "the echo pin 24 of sonar_2 stays high; check the sonar and its cable"),
    ],
)
def test_sonar_that_does_not_answer_is_named(change: dict[str, Any], text: str) -> None:
    sonars = Sonars()
    for name, value in change.items():
        setattr(sonars.board, name, value)
    sonars.bus.run(8.0)
    assert f"{DEVICE}: {text}" in sonars.lines


@pytest.mark.parametrize("seed", range(5))
def test_spikes_and_lost_edges_give_no_wrong_range(seed: int) -> None:
    sonars = Sonars()
    sonars.board.random, sonars.board.noise, sonars.board.cut = random.Random(seed), 0.3, 0.2
    sonars.bus.run(5.0)
    wanted = {f"sonar_{n}": each for n, each in enumerate((0.5, 1.0, 2.0, 3.0))}
    measured = [each for each in sonars.ranges if each.frame in wanted]
    assert len(measured) > 40
    assert all(each.range == pytest.approx(wanted[each.frame], abs=0.06) for each in measured)


def test_pins_are_given_back_at_the_end_also_in_the_middle_of_a_ping() -> None:
    for moment in (1.0, 1.06):
        sonars = Sonars()
        sonars.bus.run(moment)
        sonars.node.end("the test ends it")
        sonars.bus.run(0.2)
        assert sonars.board.closed == 1
