"""The mux on a bus: who drives, what is too late, and that the robot stops."""

import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.ur_nodes.motion.mux_robot import AHEAD, STILL, LeaseDriver, MuxRobot

from ur.devices.driver_health import RefusedCommands, health_file, parse_drivers, parse_records
from ur.source.diagnostic import UserError
from ur_nodes.motion.cmd_vel_mux_node import start
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.ports.services import Switch, Trigger
from ur_nodes.ports.values import Result, Scan, StampedTwist, Time, Twist
from ur_nodes.web.data.diagnostics import KIND

pytestmark = pytest.mark.usefixtures("home")


def test_fresh_commands_drive_on_time_and_the_robot_stops_after_the_last(home: Path) -> None:
    robot = MuxRobot(home, lambda _topic: 3_000_000)
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    speeds = robot.speeds(1.0)
    assert max(speeds) == pytest.approx(0.3)
    times = [at for at, _ in robot.outputs]
    assert max(after - before for before, after in pairwise(times)) <= 20_000_001
    driver.wanted = None
    assert robot.speeds(1.0)[-3:] == [0.0, 0.0, 0.0]
    at_rest = next(at for at, twist in robot.outputs if twist == STILL)
    assert at_rest - driver.sent_at <= 0.3e9 - 0.11e9  # the rest is the lag of the wheels
    assert robot.speeds(1.0) == []


def test_commands_that_arrive_late_do_not_drive(home: Path) -> None:
    robot = MuxRobot(home, lambda topic: 200_000_000 if topic.endswith("_stamped") else 0)
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    assert not any(robot.speeds(2.0))
    assert any("dropped" in text and "older than 0.15 s" in text for _, text in robot.mux.lines)


def test_age_of_a_command_counts_from_its_challenge(home: Path) -> None:
    robot = MuxRobot(home, lambda topic: 100_000_000 if topic.endswith("_stamped") else 0)
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    assert max(robot.speeds(1.0)) > 0.0
    driver.wanted = None
    robot.speeds(1.0)
    at_rest = next(at for at, twist in robot.outputs if twist == STILL)
    assert at_rest - driver.sent_at <= 0.3e9 - 0.11e9


def test_burst_that_answers_an_old_challenge_does_not_drive(home: Path) -> None:
    robot = MuxRobot(home)
    driver = LeaseDriver(robot.bus, "a")
    driver.lease.acquire()
    robot.bus.run(0.5)
    old = driver.lease.link.newest()
    assert old is not None
    robot.bus.run(0.3)
    late = driver.node.publish("key_vel_stamped", StampedTwist, Quality.EVERY)
    for _ in range(250):
        late.send(StampedTwist(old, "a", AHEAD))
    assert robot.speeds(1.0) == []


def test_challenges_are_never_repeated_and_come_more_often_while_commands_arrive(home: Path) -> None:
    robot = MuxRobot(home)
    got: list[tuple[int, int]] = []
    robot.person.subscribe("cmd_vel_mux/challenge", Time, lambda each: got.append((robot.bus.now, each.stamp)))

    def gaps(seconds: float) -> list[int]:
        del got[:-1]
        robot.bus.run(seconds)
        assert len({stamp for _, stamp in got}) == len(got)
        return [after - before for (before, _), (after, _) in pairwise(got)]

    gaps(2.0)
    assert set(gaps(1.0)) == {50_000_000}
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    first = gaps(0.3)
    assert first[0] <= 50_000_000
    assert max(first[1:]) == 20_000_000
    driver.wanted = None
    assert set(gaps(0.9)) == {20_000_000}
    gaps(0.3)
    assert set(gaps(1.0)) == {50_000_000}


def test_challenges_come_with_outputs_while_there_are_any(home: Path) -> None:
    robot, got = MuxRobot(home), list[int]()
    robot.person.subscribe("cmd_vel_mux/challenge", Time, lambda _: got.append(robot.bus.now))
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    robot.bus.run(1.0)
    del got[:], robot.outputs[:]
    robot.bus.run(1.0)
    assert len(got) == 50
    assert got == [at for at, _ in robot.outputs]


@pytest.mark.parametrize("phase", [0.0, 0.01, 0.02, 0.03, 0.04])
def test_commander_that_begins_after_a_silence_drives_with_its_first_command(home: Path, phase: float) -> None:
    robot = MuxRobot(home, lambda _topic: 40_000_000)  # a slow network, both ways
    driver = LeaseDriver(robot.bus, "a")
    robot.bus.run(3.0 + phase)
    del robot.outputs[:]
    driver.wanted = AHEAD
    robot.bus.run(0.11)  # at most 0.02 until it sends, and 0.04 to the mux and on to the base
    assert robot.outputs[-1][1].forward > 0.0


@pytest.mark.parametrize(("pause", "count", "drives"), [(0.033, 30, True), (0.0, 250, False), (0.4, 5, False)])
def test_plain_commands_drive_at_a_steady_rate_only(home: Path, pause: float, count: int, drives: bool) -> None:
    robot = MuxRobot(home)
    send = robot.plain("key_vel")
    del robot.outputs[:]
    for _ in range(count):
        send()
        robot.bus.run(pause)
    robot.bus.run(1.0)
    assert (max((twist.forward for _, twist in robot.outputs), default=0.0) > 0.0) is drives


def test_single_plain_command_does_not_drive(home: Path) -> None:
    robot = MuxRobot(home)
    robot.plain("key_vel")()
    assert robot.speeds(1.0) == []


def test_command_that_is_not_finite_does_not_drive_and_is_reported(home: Path) -> None:
    robot = MuxRobot(home)
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = Twist(float("nan"), 0.5)
    assert not any(robot.speeds(1.0))
    (line,) = [text for _, text in robot.mux.lines if "ignored" in text]
    assert "/key_vel_stamped: message of /a ignored: a velocity is nan" in line


def test_one_client_drives_until_another_takes_over_and_each_is_told(home: Path) -> None:
    robot = MuxRobot(home)
    a, b = LeaseDriver(robot.bus, "a"), LeaseDriver(robot.bus, "b")
    a.wanted = AHEAD
    robot.bus.run(0.5)
    assert (a.lease.view().mine, b.lease.view().holder) == (True, "a-host")
    b.wanted = Twist(-0.3, 0.0)
    assert min(robot.speeds(1.0)) > 0.0
    b.lease.take_over()
    robot.bus.run(0.5)
    assert robot.newest("active", str) == "keyboard"
    assert max(robot.speeds(0.5)) < 0.0
    assert a.lease.view().taken_by == "b-host"
    b.wanted = None
    assert robot.speeds(1.0)[-1] == 0.0  # a has lost the lease
    a.lease.ask()
    robot.bus.run(0.5)
    assert b.lease.view().asking == ("a-host",)
    b.lease.grant()
    robot.bus.run(0.5)
    assert (a.lease.view().mine, a.lease.view().taken_by) == (True, "")
    assert max(robot.speeds(0.5)) > 0.0


def test_client_that_vanishes_is_lost_and_the_robot_stops(home: Path) -> None:
    robot = MuxRobot(home)
    a, b = LeaseDriver(robot.bus, "a"), LeaseDriver(robot.bus, "b", "watch")
    a.wanted = AHEAD
    robot.bus.run(1.0)
    a.node.end("killed")
    assert robot.speeds(1.0)[-3:] == [0.0, 0.0, 0.0]
    robot.bus.run(4.0)
    assert (b.lease.view().state, b.lease.view().holder) == ("lost", "a-host")
    b.lease.release(final=False)
    b.wanted = AHEAD
    assert robot.speeds(1.0) == []


def test_lease_is_mirrored_and_free_after_the_end(home: Path) -> None:
    robot = MuxRobot(home)
    a = LeaseDriver(robot.bus, "a")
    a.lease.acquire()
    robot.bus.run(0.5)
    lease = json.loads(robot.bus.facts["lease"])
    assert (lease["state"], lease["client"], lease["name"]) == ("held", "a", "a-host")
    assert list(home.rglob("*.json"))
    robot.mux.end("the test is over")
    assert json.loads(robot.bus.facts["lease"])["state"] == "free"
    assert not list(home.rglob("*.json"))


@pytest.mark.parametrize("mirrored", [True, False])
def test_announced_lease_outlives_a_mux_that_is_killed(home: Path, mirrored: bool) -> None:
    robot = MuxRobot(home)
    a, b = LeaseDriver(robot.bus, "a"), LeaseDriver(robot.bus, "b", "watch")
    a.lease.acquire()
    robot.bus.run(0.5)
    assert b.lease.view().holder == "a-host"
    if not mirrored:
        del robot.bus.facts["lease"]
    a.lease.release(final=True)
    a.node.end("killed")
    robot.kill()
    robot.start()
    robot.bus.run(0.5)
    state = b.lease.view().state
    assert state in ("lost", "free")
    a = LeaseDriver(robot.bus, "a")
    a.lease.acquire()
    robot.bus.run(0.5)
    assert (a.lease.view().mine, a.lease.view().state) == (True, "held")


def test_lock_is_released_by_a_repeated_false_only(home: Path) -> None:
    robot = MuxRobot(home, locks=[{"name": "pause", "topic": "pause_driving", "timeout": 0.0, "priority": 255}])
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    pause = robot.person.publish("pause_driving", bool, Quality.EVERY)
    pause.send(True)
    robot.bus.run(1.0)
    assert not any(robot.speeds(0.5))
    pause.send(False)
    assert not any(robot.speeds(0.5))
    for _ in range(6):
        pause.send(False)
        robot.bus.run(0.05)
    assert max(robot.speeds(0.5)) > 0.0


def test_emergency_stop_outlives_the_mux_and_only_a_pause_after_release_lets_drive_again(home: Path) -> None:
    robot = MuxRobot(home)
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    robot.bus.run(0.5)
    assert robot.ask("stop") == Result(True, "stopped")
    assert robot.bus.parameters["/cmd_vel_mux/emergency_stop"] is True
    assert robot.speeds(0.5)[-1] == 0.0
    robot.kill()
    robot.start()
    assert robot.newest("stopped", bool) is True
    assert not any(robot.speeds(1.0))
    assert robot.ask("release") == Result(True, "released; keyboard may drive after a pause")
    assert not any(robot.speeds(0.5))
    driver.wanted = STILL
    robot.bus.run(0.1)
    driver.wanted = AHEAD
    assert max(robot.speeds(0.5)) > 0.0


def test_speed_limit_outlives_the_mux(home: Path) -> None:
    robot = MuxRobot(home)
    robot.person.publish("cmd_vel_mux/speed_limit", float).send(50.0)
    robot.bus.run(0.1)
    robot.kill()
    robot.start()
    assert robot.newest("speed_limit_in_force", float) == 50.0
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = Twist(5.0, 0.0)
    top = max(robot.speeds(3.0))
    robot.person.publish("cmd_vel_mux/speed_limit", float).send(0.0)
    assert max(robot.speeds(3.0)) == pytest.approx(2.0 * top)
    robot.person.publish("cmd_vel_mux/speed_limit", float).send(3.0)
    robot.bus.run(0.1)
    assert robot.newest("speed_limit_in_force", float) == 100.0
    assert any("speed limit of 3 percent ignored" in text for _, text in robot.mux.lines)


def test_new_subscriber_gets_a_stop_while_nothing_drives(home: Path) -> None:
    robot = MuxRobot(home)
    got: list[Twist] = []
    robot.bus.node("driver").subscribe("cmd_vel_out", Twist, got.append, Quality.EVERY)
    robot.bus.run(0.1)
    assert got == [STILL]
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    robot.bus.run(1.0)
    late: list[Twist] = []
    robot.bus.node("late_driver").subscribe("cmd_vel_out", Twist, late.append, Quality.EVERY)
    robot.bus.run(0.1)
    assert STILL not in late


def test_mux_that_ends_while_it_drives_sends_a_stop(home: Path) -> None:
    robot = MuxRobot(home)
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    robot.bus.run(0.5)
    del robot.outputs[:]
    robot.mux.end("the test is over")
    robot.bus.run(0.1)
    assert [twist for _, twist in robot.outputs] == [STILL] * 3


def test_disk_master_and_terminal_that_hang_delay_neither_outputs_nor_challenges_nor_a_stop(home: Path) -> None:
    robot = MuxRobot(home)
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    robot.bus.run(0.5)
    hanging: list[object] = []
    robot.mux.work = lambda job, callback, queue="": hanging.append((job, callback, queue))  # type: ignore[method-assign]
    other = LeaseDriver(robot.bus, "b")
    robot.bus.run(0.5)
    other.lease.take_over()  # the disk hangs
    robot.person.publish("cmd_vel_mux/speed_limit", float).send(90.0)  # the master hangs
    other.wanted = Twist(-0.3, 0.0)
    robot.bus.run(0.5)
    assert driver.lease.view().mine  # a takeover is in force before it is announced
    assert min(robot.speeds(1.0)) == pytest.approx(-0.3)
    assert max(after - before for before, after in pairwise(at for at, _ in robot.outputs)) <= 20_000_001
    got: list[Result] = []
    robot.person.call("cmd_vel_mux/stop", Trigger(), got.append)
    assert robot.speeds(0.5)[-1] == 0.0
    assert got == []  # it is answered when it is kept
    assert hanging


def test_lost_client_is_announced_while_the_disk_hangs_and_nothing_older_afterwards(home: Path) -> None:
    robot = MuxRobot(home)
    a, b = LeaseDriver(robot.bus, "a"), LeaseDriver(robot.bus, "b", "watch")
    robot.bus.run(0.5)
    hanging: list[Callable[[], None]] = []
    work = robot.mux.work

    def hang(job: Callable[[], Any], callback: Callable[[Any], None], queue: str = "") -> None:
        hanging.append(lambda: work(job, callback, queue))

    robot.mux.work = hang  # type: ignore[method-assign]
    a.lease.acquire()
    robot.bus.run(0.5)
    assert b.lease.view().state == "free"
    a.node.end("killed")
    robot.bus.run(3.0)
    assert (b.lease.view().state, b.lease.view().holder) == ("lost", "a-host")
    heard: list[str] = []
    b.node.subscribe("cmd_vel_mux/lease", str, heard.append, Quality.LATCHED_EVERY)
    robot.mux.work = work  # type: ignore[method-assign]
    for each in hanging:
        each()
    robot.bus.run(0.5)
    assert {json.loads(text)["state"] for text in heard} == {"lost"}
    assert "lost" in next(home.rglob("*.json")).read_text()


def test_stop_is_answered_when_the_master_is_gone(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = MuxRobot(home)

    def fail(*_: object) -> None:
        raise OSError("connection refused")

    monkeypatch.setattr(robot.mux.parameters, "keep", fail)
    answer = robot.ask("stop")
    assert answer.success
    assert answer.text == "stopped, but a mux that is started again will not know it: connection refused"
    assert robot.newest("stopped", bool) is True


def scan_of(robot: MuxRobot, distance: float) -> Scan:
    ranges = np.full(360, distance, np.float32)
    return Scan(robot.bus.now, "laser", -np.pi, np.pi / 180.0, 0.05, 8.0, ranges)


def test_robot_stops_before_an_obstacle_and_the_choice_outlives_the_mux(home: Path) -> None:
    robot = MuxRobot(home)
    lidar = robot.bus.node("lidar").publish("scan", Scan)
    robot.base.every(0.1, lambda: lidar.send(scan_of(robot, 0.6)))
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = AHEAD
    assert max(robot.speeds(1.0)) == pytest.approx(0.3)
    assert json.loads(robot.newest("obstacle_stop", str))["state"] == "off"
    assert robot.ask("set_obstacle_stop", Switch(on=True)) == Result(True, "on")
    robot.kill()
    robot.start()
    robot.base.every(0.1, lambda: lidar.send(scan_of(robot, 0.2)))
    assert not any(robot.speeds(1.0)[-10:])
    report = json.loads(robot.newest("obstacle_stop", str))
    assert report["state"] == "stopped"
    assert "obstacle" in report["text"]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"base": "stagge"}, "unknown base 'stagge'"),
        ({"topics": None}, "parameter /cmd_vel_mux/topics: None, expected a list"),
        ({"topics": "key_vel"}, "parameter /cmd_vel_mux/topics: 'key_vel', expected a list of mappings"),
        ({"rate": 500}, "expected a number from 10 to 100"),
    ],
)
def test_parameters_that_it_cannot_use_are_named(home: Path, parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message):
        MuxRobot(home, **parameters)


def test_real_base_is_not_driven_by_simulated_time(home: Path) -> None:
    robot = MuxRobot(home, real_base=True)  # in real time
    robot.kill()
    robot.mux = robot.bus.node("cmd_vel_mux")
    assert robot.mux.facts.simulated_time
    with pytest.raises(UserError, match="use_sim_time is true, expected false"):
        start(robot.mux)


def test_programs_that_send_to_the_base_itself_drive_through_the_mux_by_either_type(home: Path) -> None:
    robot = MuxRobot(home, takes_over="cmd_vel")
    for kind, command in ((Twist, AHEAD), (StampedTwist, StampedTwist(0, "", AHEAD))):
        program = robot.bus.node(f"their_{kind.__name__}")
        publisher = program.publish("cmd_vel", kind)
        timer = robot.person.every(0.05, lambda: publisher.send(command))  # noqa: B023 - cancelled below
        assert max(robot.speeds(1.0)) > 0.29
        assert robot.newest("active", str) == "program"
        timer.cancel()
        program.end("its user ended it")
        assert robot.speeds(1.0)[-1] == 0.0


def test_program_that_is_too_slow_reads_why_the_robot_does_not_move(home: Path) -> None:
    robot = MuxRobot(home, takes_over="cmd_vel", schemas={KIND: "DiagnosticStatus[] status"})
    shown: list[RawMessage] = []
    robot.person.raw.subscribe("/diagnostics", shown.append, Quality.EVERY)
    publisher = robot.bus.node("joy_bridge").publish("cmd_vel", Twist)
    timer = robot.person.every(1.0, lambda: publisher.send(AHEAD))
    assert not any(robot.speeds(5.0))
    line = "cmd_vel: /joy_bridge publishes Twist at 1 Hz; the robot drives at 10 Hz or more"
    help_ = "publish at 10 Hz or more: `ros2 topic pub -r 20 /cmd_vel ...`"
    assert [text for _, text in robot.mux.lines if "Hz" in text] == [f"{line}; help: {help_}"]
    (status,) = json.loads(shown[-1].data)["status"]
    assert status == {"level": 1, "name": "/cmd_vel_mux: commands", "message": f"{line}; {help_}"}
    file = health_file("/cmd_vel_mux")
    assert parse_records(f"1 {file.read_text()}", RefusedCommands) == (RefusedCommands(line, help_),)
    assert parse_drivers(f"1 {file.read_text()}") == ()
    timer.cancel()
    robot.bus.run(12.0)
    assert json.loads(shown[-1].data)["status"][0]["level"] == 0
    robot.mux.end("its user ended it")
    assert not file.exists()


def test_program_that_answers_no_challenge_reads_why_the_robot_does_not_move(home: Path) -> None:
    robot = MuxRobot(home)
    publisher = robot.bus.node("stamper").publish("key_vel_stamped", StampedTwist)
    robot.person.every(0.05, lambda: publisher.send(StampedTwist(robot.bus.now, "", AHEAD)))
    assert not any(robot.speeds(2.0))
    (text, *_) = (text for _, text in robot.mux.lines if "dropped" in text)
    assert "of /stamper on key_vel_stamped" in text
    assert text.endswith("help: publish Twist on key_vel at 10 Hz or more")


def test_program_of_another_type_drives_though_one_that_was_killed_is_still_in_the_graph(home: Path) -> None:
    robot = MuxRobot(home, takes_over="cmd_vel")
    robot.bus.node("killed").publish("cmd_vel", Twist)
    robot.bus.run(2.0)
    publisher = robot.bus.node("program").publish("cmd_vel", StampedTwist)
    robot.person.every(0.05, lambda: publisher.send(StampedTwist(0, "", AHEAD)))
    assert max(robot.speeds(1.0)) > 0.29


def test_mux_does_not_take_over_the_topic_that_it_sends_to(home: Path) -> None:
    with pytest.raises(UserError, match="takes_over: 'cmd_vel_out', expected another topic than that of the base"):
        MuxRobot(home, takes_over="cmd_vel_out")
    with pytest.raises(UserError, match="takes_over: 'key_vel', expected a topic that is none of the sources"):
        MuxRobot(home, takes_over="key_vel")


def test_mux_without_sources_is_the_obstacle_stop_of_one_program(home: Path) -> None:
    robot = MuxRobot(home)
    robot.kill()
    del robot.bus.parameters["/cmd_vel_mux/topics"]
    robot.start()
    program = robot.bus.node("nav2")
    publisher = program.publish("cmd_vel_nav2", StampedTwist)
    robot.person.every(0.05, lambda: publisher.send(StampedTwist(0, "", AHEAD)))
    assert max(robot.speeds(1.0)) <= 0.2  # nothing has been seen yet
    assert "no scan" in robot.newest("obstacle_stop", str)
