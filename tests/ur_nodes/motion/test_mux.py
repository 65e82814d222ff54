"""Histories of the mux, replayed: what came when, and what goes out when."""

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur.robot.base import load_base
from ur_nodes.motion.mux import MuxState, start_mux, step
from ur_nodes.motion.mux_events import (
    STILL,
    EmergencyReleased,
    EmergencyStopped,
    Event,
    Lock,
    LockMessage,
    MuxSettings,
    Source,
    SpeedLimited,
    Velocity,
    VelocityCommand,
    slow_to,
)
from ur_nodes.motion.obstacle_stop.guard import Guard, make_guard
from ur_nodes.motion.obstacle_stop.obstacle_stop import make_sight
from ur_nodes.motion.obstacle_stop.sight import SensorRanges, look
from ur_nodes.motion.ramp import Axis

JOYSTICK, KEYBOARD, NAVIGATION = range(3)
SOURCES = (
    Source("joystick", "joy_vel", 100, 0.15, zeros_hold=True),
    Source("keyboard", "key_vel", 90, 0.15),
    Source("navigation", "nav_vel", 10, 0.2),
)
FORWARD, TURN = Axis(0.5, 1.0, 4.0), Axis(1.0, 3.0, 10.0)
SETTINGS = MuxSettings(SOURCES, FORWARD, TURN, locks=(Lock("pause", "pause", 50, 0.0),))
SIDEWAYS = replace(SETTINGS, left=Axis(0.4, 1.0, 4.0))
BUDGET = SETTINGS.stop_time - SETTINGS.lag


@dataclass
class MuxRun:
    """A mux that is stepped when something comes and when it asks for it."""

    state: MuxState
    now: float = 0.0
    sent: list[tuple[float, Velocity, str]] = field(default_factory=list)

    def handle(self, event: Event | None) -> None:
        self.state, output = step(self.state, event, self.now)
        if output is not None:
            self.sent.append((self.now, output, self.state.active_name))

    def until(self, end: float) -> None:
        while self.state.next_at <= end:
            assert self.state.next_at > self.now, "it would never sleep"
            self.now = self.state.next_at
            self.handle(None)
        self.now = end

    def drive(self, source: int, velocity: Velocity, seconds: float, rate: float = 20.0) -> None:
        begin = self.now
        for n in range(round(seconds * rate)):
            self.until(begin + n / rate)
            self.handle(VelocityCommand(source, velocity))
        self.until(begin + seconds)

    @property
    def last(self) -> Velocity:
        return self.sent[-1][1]


@pytest.fixture
def run() -> MuxRun:
    return MuxRun(start_mux(SETTINGS))


AHEAD = Velocity(0.5, 0.0)


def test_mux_is_silent_until_somebody_wants_to_move(run: MuxRun) -> None:
    run.until(1.0)
    run.handle(VelocityCommand(NAVIGATION, STILL))
    run.until(2.0)
    assert run.sent == []
    assert run.state.next_at == math.inf


def test_mux_speeds_up_within_the_limits_and_sends_at_a_steady_rate(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 1.0, rate=30.0)
    times = [at for at, _, _ in run.sent]
    assert times[0] == 0.0  # at once
    assert all(b - a == pytest.approx(0.02) for a, b in pairwise(times))
    assert run.sent[10][1].forward == pytest.approx(0.02 * 11)
    assert run.last == AHEAD


def test_mux_brakes_in_time_when_the_commander_is_lost_then_says_zero_three_times_and_falls_silent(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 1.0)
    last = 0.95
    run.until(3.0)
    moving = [at for at, velocity, _ in run.sent if velocity != STILL]
    assert moving[-1] - last < BUDGET
    zeros = [at for at, velocity, _ in run.sent if velocity == STILL]
    assert len(zeros) == 3
    assert zeros[0] - last <= BUDGET + 1e-9
    assert run.state.next_at == math.inf
    assert run.sent[-1][2] == "idle"


def test_mux_drives_a_base_sideways_within_its_limits_and_stops_it_in_time() -> None:
    run = MuxRun(start_mux(SIDEWAYS))
    run.drive(KEYBOARD, Velocity(0.0, 0.0, 0.7), 1.0, rate=30.0)
    assert run.last == Velocity(0.0, 0.0, 0.4)
    assert run.sent[10][1].left == pytest.approx(0.02 * 11)
    last = run.now - 1.0 / 30.0
    run.until(3.0)
    assert max(at for at, velocity, _ in run.sent if velocity != STILL) - last < BUDGET


@pytest.mark.parametrize(("settings", "expected"), [(SETTINGS, 0.0), (SIDEWAYS, 0.2)])
def test_speed_limit_holds_sideways_and_a_base_without_such_wheels_stays(
    settings: MuxSettings, expected: float
) -> None:
    run = MuxRun(start_mux(settings, share=0.5))
    run.drive(KEYBOARD, Velocity(0.0, 0.0, -0.4), 1.0)
    assert min((velocity.left for _, velocity, _ in run.sent), default=0.0) == pytest.approx(-expected)
    assert bool(run.sent) is bool(expected)


SPEEDS = st.floats(-2.0, 2.0)


@given(SPEEDS, SPEEDS, SPEEDS, st.floats(0.05, 1.5), st.floats(0.01, 1.0), st.sampled_from([0.0, 0.3, 0.9]))
def test_limit_of_speed_is_of_the_velocity_whichever_way_it_points(
    forward: float, left: float, turn: float, speed: float, share: float, aside: float
) -> None:
    base = replace(SETTINGS, left=Axis(aside, 1.0, 4.0))
    wanted = Velocity(forward, turn, left)
    granted = slow_to(wanted, speed / base.forward.speed, base, speed)
    assert math.hypot(granted.forward, granted.left) <= speed + 1e-9
    slow = slow_to(wanted, share, base)
    if share < 1.0:
        assert math.hypot(slow.forward, slow.left) <= share * max(base.forward.speed, aside) + 1e-9
    for each in (granted, slow):
        assert each.forward * wanted.left == pytest.approx(each.left * wanted.forward, abs=1e-9)  # on its curve
        assert abs(each.forward) <= abs(wanted.forward)


def test_speed_of_the_greatest_axis_is_kept_where_the_limit_permits() -> None:
    assert slow_to(Velocity(0.5, 0.0, 0.0), 0.4, SIDEWAYS, 0.2) == Velocity(0.2, 0.0, 0.0)
    assert slow_to(Velocity(0.1, 0.3, 0.1), 0.4, SIDEWAYS, 0.2) == Velocity(0.1, 0.3, 0.1)


def test_mux_follows_zeros_of_the_active_source_with_the_harder_limit(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 1.0)
    stop = run.now
    run.handle(VelocityCommand(KEYBOARD, STILL))
    run.until(3.0)
    assert next(at for at, velocity, _ in run.sent if velocity == STILL) - stop <= 0.5 / 4.0 + 0.02


def test_higher_priority_takes_over_at_once_and_gives_back_when_it_falls_silent(run: MuxRun) -> None:
    for n in range(40):
        run.until(n * 0.05)
        run.handle(VelocityCommand(NAVIGATION, AHEAD))
        if 10 <= n < 20:
            run.handle(VelocityCommand(JOYSTICK, Velocity(0.0, 0.5)))
    names = [name for _, _, name in run.sent]
    changes = [name for n, name in enumerate(names) if n == 0 or names[n - 1] != name]
    assert changes == ["navigation", "joystick", "navigation"]
    joystick = [at for at, _, name in run.sent if name == "joystick"]
    assert joystick[0] == pytest.approx(0.5, abs=0.021)
    assert joystick[-1] == pytest.approx(0.95 + 0.15, abs=0.021)


def test_source_that_sends_zeros_when_idle_does_not_hold_the_robot(run: MuxRun) -> None:
    for n in range(40):
        run.until(n * 0.05)
        run.handle(VelocityCommand(KEYBOARD, STILL))
        run.handle(VelocityCommand(NAVIGATION, AHEAD))
    assert {name for _, _, name in run.sent} == {"navigation"}
    assert run.last == AHEAD


def test_source_whose_zeros_hold_makes_the_robot_stand(run: MuxRun) -> None:
    run.drive(NAVIGATION, AHEAD, 1.0)
    for n in range(20):
        run.until(1.0 + n * 0.05)
        run.handle(VelocityCommand(NAVIGATION, AHEAD))
        run.handle(VelocityCommand(JOYSTICK, STILL))
    assert (run.sent[-1][1], run.sent[-1][2]) == (STILL, "joystick")


def test_emergency_stop_brakes_at_once_and_shuts_everybody_out(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 1.01)
    run.handle(EmergencyStopped())
    assert run.sent[-1][0] == pytest.approx(1.01)  # not at the next period
    assert run.last.forward < 0.5
    run.drive(JOYSTICK, AHEAD, 1.0)
    standing = next(at for at, velocity, _ in run.sent if velocity == STILL)
    assert standing - 1.01 <= 0.5 / 4.0 + 0.02
    assert all(velocity == STILL for at, velocity, _ in run.sent if at > standing)


def test_release_does_not_set_the_robot_in_motion_until_the_source_has_paused(run: MuxRun) -> None:
    run.handle(EmergencyStopped())
    run.drive(NAVIGATION, AHEAD, 0.5)
    run.handle(EmergencyReleased())
    run.drive(NAVIGATION, AHEAD, 1.0)
    assert all(velocity == STILL for _, velocity, _ in run.sent)
    run.handle(VelocityCommand(NAVIGATION, STILL))  # an explicit pause
    run.drive(NAVIGATION, AHEAD, 1.0)
    assert run.last == AHEAD
    run.handle(EmergencyStopped())
    run.drive(KEYBOARD, AHEAD, 0.5)
    run.handle(EmergencyReleased())
    run.until(run.now + 0.5)  # a pause by silence
    run.drive(KEYBOARD, AHEAD, 1.0)
    assert run.last == AHEAD


def test_emergency_stop_survives_a_start(run: MuxRun) -> None:
    run.state = start_mux(SETTINGS, stopped=True)
    run.drive(KEYBOARD, AHEAD, 1.0)
    assert run.sent == []


def test_lock_shuts_out_lower_priorities_only(run: MuxRun) -> None:
    run.handle(LockMessage(0, True))
    run.drive(NAVIGATION, AHEAD, 0.5)
    assert run.sent == []
    run.drive(KEYBOARD, AHEAD, 0.5)
    assert run.sent[-1][2] == "keyboard"
    run.handle(LockMessage(0, False))
    run.until(2.0)
    run.drive(NAVIGATION, AHEAD, 0.5)
    assert run.sent[-1][2] == "navigation"


def test_lock_that_has_to_be_repeated_locks_when_it_is_silent() -> None:
    run = MuxRun(start_mux(replace(SETTINGS, locks=(Lock("watchdog", "w", 255, 0.5),))))
    run.drive(KEYBOARD, AHEAD, 0.5)
    assert run.sent == []
    run.handle(LockMessage(0, False))
    run.drive(KEYBOARD, AHEAD, 0.4)
    assert run.last.forward > 0.3
    run.drive(KEYBOARD, AHEAD, 1.0)
    assert run.last == STILL


@pytest.mark.parametrize("bad", [Velocity(math.nan, 0.0), Velocity(0.0, math.inf), Velocity(-math.inf, math.nan)])
def test_command_that_is_not_finite_means_stand_still(run: MuxRun, bad: Velocity) -> None:
    run.drive(KEYBOARD, AHEAD, 1.0)
    run.drive(KEYBOARD, bad, 0.14)
    assert run.last == STILL


def test_time_that_goes_back_makes_all_commands_old(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 1.0)
    run.now = 0.2
    run.handle(None)
    before = len(run.sent)
    run.until(1.0)
    forward = [velocity.forward for _, velocity, _ in run.sent[before - 1 :]]
    assert forward == sorted(forward, reverse=True)
    assert forward[-1] == 0.0
    assert len(forward) < 20


velocities = st.builds(Velocity, st.floats(-1.0, 1.0), st.floats(-2.0, 2.0)) | st.just(STILL) | st.just(AHEAD)
events = st.one_of(
    st.none(),
    st.builds(VelocityCommand, st.integers(0, 2), velocities),
    st.builds(VelocityCommand, st.integers(0, 2), velocities),
    st.builds(LockMessage, st.just(0), st.booleans()),
    st.sampled_from([EmergencyStopped(), EmergencyReleased(), EmergencyReleased()]),
)
histories = st.lists(st.tuples(st.floats(0.0, 0.12) | st.just(0.05), events), max_size=60)


@given(histories)
@settings(max_examples=150, deadline=None)
def test_output_obeys_the_limits_and_never_outlives_its_commands(history: list[tuple[float, Event | None]]) -> None:
    run = MuxRun(start_mux(SETTINGS))
    newest = -math.inf
    checked = 0

    def check() -> None:
        nonlocal checked
        for (before_at, before, _), (at, after, _) in pairwise([(-math.inf, STILL, ""), *run.sent][checked:]):
            check_change(before, after, min(at - before_at, SETTINGS.period))
            # Even just before the next output the robot could still be stopped in time.
            left = max(0.0, BUDGET - (at - newest))
            assert abs(before.forward) <= FORWARD.slow_down * left + 1e-9
            assert abs(before.turn) <= TURN.slow_down * left + 1e-9
        checked = len(run.sent)

    for pause, event in history:
        run.until(run.now + pause)
        check()
        if isinstance(event, VelocityCommand) and not event.velocity.still:
            newest = run.now
        run.handle(event)
        check()
    run.until(run.now + 0.6)
    check()
    assert run.state.output == STILL
    assert run.state.next_at == math.inf


def check_change(before: Velocity, after: Velocity, seconds: float) -> None:
    for axis, old, new in ((FORWARD, before.forward, after.forward), (TURN, before.turn, after.turn)):
        assert abs(new) <= axis.speed
        assert abs(new) - abs(old) <= axis.speed_up * seconds + 1e-9
        assert abs(new - old) <= axis.slow_down * seconds + 1e-9


def test_command_that_is_delayed_between_admission_and_mux_does_not_move_the_base() -> None:
    run = MuxRun(start_mux(SETTINGS), now=1.0)
    run.handle(VelocityCommand(KEYBOARD, AHEAD, at=0.6))
    run.until(3.0)
    assert all(velocity.still for _, velocity, _ in run.sent)


def test_speed_limit_slows_every_source_on_the_same_curve_until_it_is_lifted(run: MuxRun) -> None:
    run.handle(SpeedLimited(0.4))
    run.drive(KEYBOARD, Velocity(0.5, 0.5), 1.0, rate=30.0)
    assert (run.last.forward, run.last.turn) == pytest.approx((0.2, 0.2))
    run.drive(JOYSTICK, Velocity(0.0, -9.0), 1.0, rate=30.0)
    assert run.last.turn == pytest.approx(-0.4)
    run.handle(SpeedLimited(math.nan))
    run.drive(KEYBOARD, Velocity(0.1, 0.1), 1.0, rate=30.0)
    assert (run.last.forward, run.last.turn) == pytest.approx((0.1, 0.1)), "slower commands are followed as they are"
    run.handle(SpeedLimited(7.0))
    run.drive(KEYBOARD, Velocity(7.0, 0.0), 1.5, rate=30.0)
    assert run.last.forward == pytest.approx(FORWARD.speed), "never above the limit of the base"


def test_speed_limit_that_is_lowered_while_driving_brakes_within_the_limits(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 1.0, rate=30.0)
    run.handle(SpeedLimited(0.2))
    run.drive(KEYBOARD, AHEAD, 1.0, rate=30.0)
    assert run.last.forward == pytest.approx(0.1)
    for (before, first, _), (after, second, _) in pairwise(run.sent):
        assert first.forward - second.forward <= FORWARD.slow_down * (after - before) + 1e-9
    assert start_mux(SETTINGS, share=0.2).share == 0.2


def make_guard_before_a_wall(clear: float) -> Guard:
    """The guard of stage, whose lidar has just seen a wall so far (m) ahead of it."""
    base = load_base(Path(__file__).parents[3] / "ubiquity_launches", "stage", "")
    sight = make_sight(base)
    angles = np.arange(-60, 61) * math.pi / 180.0
    scan = SensorRanges((clear + 0.1) / np.cos(angles), (0.12, 12.0), 0.0, float(angles[0]), math.pi / 180.0)
    return make_guard(look(sight, sight.sensors[0], scan), base.limits, 0.11)


def test_commands_of_people_stop_before_what_is_seen_and_those_of_navigation_do_not() -> None:
    sources = (SOURCES[KEYBOARD], replace(SOURCES[NAVIGATION], avoids_obstacles=True))
    run = MuxRun(start_mux(replace(SETTINGS, sources=sources)))
    run.state = run.state._replace(guard=make_guard_before_a_wall(0.02))
    run.drive(0, AHEAD, 0.4, rate=30.0)
    assert run.last == STILL
    assert run.state.verdict is not None
    assert run.state.verdict.cause is not None
    run.drive(0, Velocity(-0.5, 0.0), 0.2, rate=30.0)
    assert run.last.forward < -0.1
    run.until(run.now + 1.0)
    assert run.state.verdict is None
    run.drive(1, AHEAD, 0.6, rate=30.0)
    assert run.last == AHEAD


def test_guard_that_is_switched_off_or_on_counts_at_once_and_brakes_within_the_limits(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 1.0, rate=30.0)
    run.state = run.state._replace(guard=make_guard_before_a_wall(0.02))
    begin = len(run.sent) - 1
    run.drive(KEYBOARD, AHEAD, 0.4, rate=30.0)
    assert run.last == STILL
    for (before, fast, _), (after, slow, _) in pairwise(run.sent[begin:]):
        assert fast.forward - slow.forward <= FORWARD.slow_down * (after - before) + 1e-9
    run.state = run.state._replace(guard=None)
    run.drive(KEYBOARD, AHEAD, 1.0, rate=30.0)
    assert run.last == AHEAD


def test_robot_stops_in_time_before_an_obstacle_when_commands_end() -> None:
    run = MuxRun(start_mux(SETTINGS))
    run.state = run.state._replace(guard=make_guard_before_a_wall(0.3))
    run.drive(KEYBOARD, AHEAD, 0.5, rate=30.0)
    ended = run.sent[-1][0]
    run.until(run.now + 1.0)
    assert all(output == STILL for at, output, _ in run.sent if at > ended + BUDGET)


def test_mux_that_was_suspended_while_it_drove_moves_the_robot_no_further(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 2.0)
    assert run.last == AHEAD
    run.now += 2.0
    count = len(run.sent)
    run.handle(None)
    run.until(run.now + 1.0)
    after = [velocity for _, velocity, _ in run.sent[count:]]
    assert after
    assert set(after) == {STILL}


def test_commands_at_the_time_of_an_output_come_before_it(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 1.0)
    run.now, count = run.state.next_at, len(run.sent)
    for forward in (0.0, 0.4):
        run.handle(VelocityCommand(KEYBOARD, Velocity(forward, 0.0)))
    assert len(run.sent) == count
    run.handle(None)
    assert len(run.sent) == count + 1
    assert 0.4 <= run.last.forward < AHEAD.forward


def test_mux_that_was_suspended_goes_on_from_zero_for_fresh_commands(run: MuxRun) -> None:
    run.drive(KEYBOARD, AHEAD, 2.0)
    run.now += 2.0
    count = len(run.sent)
    run.handle(VelocityCommand(KEYBOARD, AHEAD))
    run.drive(KEYBOARD, AHEAD, 2.0)
    after = [velocity.forward for _, velocity, _ in run.sent[count:]]
    assert after[0] <= FORWARD.speed_up * SETTINGS.period
    assert after[-1] == AHEAD.forward
