"""Loki's board: the lines of its firmware, and its sonars and wheels behind its stand-in."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from tests.base_contract import load
from tests.ur_nodes.drivers.mutations import StillPlant
from tests.ur_nodes.drivers.rig import DriverRig

from ur_nodes.drivers.boards.loki import LokiFirmware
from ur_nodes.drivers.readings import Counts, DeviceIdentity, SonarEcho
from ur_nodes.drivers.registry import BOARDS
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.values import Battery, Odometry, Range


def make() -> Any:
    return BOARDS["loki"](load("loki", ""))


def test_speeds_are_ticks_in_20_ms_as_upstream_computes_them() -> None:
    # bus_server.py: int(left * ticks_per_meter / pid_rate), with 3560 ticks a turn, wheels of 60 mm and 50 Hz
    per_metre = 3560 / (math.pi * 0.06)
    command = make().drive(0.2, -0.1)
    assert command == b"m %d %d\re\r" % (round(0.2 * per_metre / 50), round(-0.1 * per_metre / 50))
    assert make().stop() == b"\rm 0 0\r"


def test_answers_are_told_apart_by_their_form() -> None:
    board = make()
    assert list(board.receive(b"115200\r\nOK\r\n-12 3560\r\n")) == [
        DeviceIdentity("firmware bus_server"),
        Counts(-12, 3560),
    ]
    assert (
        list(board.receive(b"40000 \r\n41000 0:0:12 1:0:-3\r\n")) == []
    )  # what the wheels did since is in the counters
    assert board.rejected == 0
    assert list(board.receive(b"Invalid Command!\r\nAT+OK\r\n")) == []
    assert board.rejected == 1


def test_distance_belongs_to_the_echo_before_as_in_the_firmware() -> None:
    # Sonar.cpp, update: queue_value_ = mm_distance_get() before echo_delta_ticks_ is that of this echo
    board = make()
    assert list(board.receive(b"90000 2:-10000:0 17:-5000:10001\r\n")) == []
    (echo,) = board.receive(b"100000 2:-20000:500\r\n")
    assert isinstance(echo, SonarEcho)
    assert (echo.number, echo.distance) == (0, 0.5)
    assert echo.age == pytest.approx(0.11)
    assert list(board.receive(b"3000000 2:-20000:700\r\n")) == []  # too old to be of use


def test_counts_that_no_wheel_can_have_turned_count_when_they_come_twice() -> None:
    board = make()
    assert list(board.receive(b"100 100\r\n")) == [Counts(100, 100)]
    assert list(board.receive(b"9100 100\r\n")) == []  # a damaged digit
    assert list(board.receive(b"120 120\r\n")) == [Counts(120, 120)]
    assert list(board.receive(b"0 0\r\n5 5\r\n")) == [Counts(0, 0), Counts(5, 5)]
    assert list(board.receive(b"80000 80000\r\n80010 80010\r\n")) == [Counts(80010, 80010)]
    assert board.rejected == 2


def test_what_a_command_was_cut_off_from_does_not_spoil_the_stop() -> None:
    plant = StillPlant()
    turned: list[tuple[float, float]] = []
    plant.turn_wheels = lambda left, right: turned.append((left, right))  # type: ignore[method-assign]
    firmware = LokiFirmware(plant)  # type: ignore[arg-type]
    board, command = make(), make().drive(0.25, 0.25)
    for size in range(len(command)):
        firmware.receive(command[:size])
        firmware.receive(board.stop())
        assert turned[-1] == (0.0, 0.0)
    firmware.receive(board.handshake())
    assert firmware.gains == (30, 7, 25, 600, 400)


def test_sonars_of_the_board_are_published_with_their_frames_and_true_times() -> None:
    rig = DriverRig("loki")
    assert rig.base.sonars
    ranges = rig.record("sonars", Range)
    batteries, odometry = rig.record("battery_state", Battery), rig.record("odom", Odometry)
    rig.bus.run(4.0)
    assert {each.frame for each in ranges} == {sonar.frame for sonar in rig.base.sonars.at}
    assert len(ranges) == pytest.approx(4 * 80, rel=0.15)
    exact = rig.bench.plant.sonars()
    latest = {each.frame: each.range for each in ranges}
    measured = [min(latest[sonar.frame], 4.1) for sonar in rig.base.sonars.at]
    assert np.median(np.abs(np.array(measured) - np.minimum(exact, 4.1))) < 0.02
    steps = [(b.stamp - a.stamp) / SECOND for a, b in pairwise([each for each in ranges if each.frame == "sonar_4"])]
    assert steps
    assert all(step == pytest.approx(0.2, abs=0.001) for step in steps)  # it measures each of them every 0.2 s
    assert batteries == []
    assert odometry
