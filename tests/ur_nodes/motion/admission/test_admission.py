"""Admission and mux together: what is late never moves the robot, and one client drives at a time."""

from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur_nodes.motion.admission.admission import (
    Admission,
    Refusal,
    admit_plain,
    admit_request,
    admit_stamped,
    challenge,
)
from ur_nodes.motion.challenge.freshness import FRESHNESS, NO_STAMP, IssuedChallenges, Stamp
from ur_nodes.motion.lease.record import start_lease
from ur_nodes.motion.lease.text import Action, LeaseRequest, Terms
from ur_nodes.motion.mux import MuxState, start_mux, step
from ur_nodes.motion.mux_events import MuxSettings, Source, Velocity, VelocityCommand
from ur_nodes.motion.ramp import Axis

KEYBOARD, NAVIGATION = 0, 1
SOURCES = (Source("keyboard", "key_vel", 90, 0.15), Source("navigation", "nav_vel", 10, 0.2))
AXIS = Axis(0.5, 1.0, 4.0)
SETTINGS = MuxSettings(SOURCES, AXIS, AXIS)
AHEAD = Velocity(0.5, 0.0)
PERIOD = 0.02


@dataclass
class AdmittingRobot:
    """Admission and mux, with challenges that are issued on time."""

    admission: Admission = field(
        default_factory=lambda: Admission(
            IssuedChallenges(1), start_lease(), tuple(source.timeout for source in SOURCES)
        )
    )
    mux: MuxState = field(default_factory=lambda: start_mux(SETTINGS))
    now: float = 0.0
    challenge_at: float = 0.0
    issued: list[tuple[float, Stamp]] = field(default_factory=list)
    outputs: list[tuple[float, float]] = field(default_factory=list)
    slow: list[str] = field(default_factory=list)

    def until(self, end: float) -> None:
        while (due := min(self.mux.next_at, self.challenge_at)) <= end:
            self.now = due
            if due == self.challenge_at:
                self.challenge_at += PERIOD
                self.admission, stamp, slow = challenge(self.admission, due, due)
                self.issued.append((due, stamp))
                self.slow += [name for _, name in slow]
            else:
                self.step(None)
        self.now = end

    def step(self, command: VelocityCommand | None) -> None:
        self.mux, output = step(self.mux, command, self.now)
        if output is not None:
            self.outputs.append((self.now, output.forward))

    def stamped(self, stamp: Stamp, client: str = "a", source: int = KEYBOARD, waited: float = 0.0) -> float | Refusal:
        follows, admission = source == NAVIGATION, self.admission
        self.admission, verdict = admit_stamped(
            admission, source, stamp, client, self.now, self.now, motion=True, follows=follows, waited=waited
        )
        if isinstance(verdict, float):
            self.step(VelocityCommand(source, AHEAD, self.now - verdict))
        return verdict

    def plain(self, publisher: str = "/p", source: int = KEYBOARD, sent: float | None = None) -> float | Refusal:
        """`sent` is by a clock that is 100 s ahead."""
        moment = None if sent is None else (round((sent + 100.0) * 1e9), self.now)
        self.admission, verdict = admit_plain(self.admission, source, publisher, self.now, motion=True, sent=moment)
        if isinstance(verdict, float):
            self.step(VelocityCommand(source, AHEAD, self.now - verdict))
        return verdict

    def request(self, client: str, action: Action, stamp: Stamp | None = None) -> bool:
        request = LeaseRequest(client, client, "p", action, answers=stamp or self.newest)
        self.admission, counted = admit_request(self.admission, request, self.now, self.now)
        return counted

    @property
    def newest(self) -> Stamp:
        return self.issued[-1][1]

    @property
    def driver(self) -> str:
        return self.admission.lease.lease.client


@pytest.fixture
def robot() -> AdmittingRobot:
    robot = AdmittingRobot()
    robot.until(0.1)
    return robot


def test_stamped_command_is_as_old_as_its_challenge(robot: AdmittingRobot) -> None:
    at, stamp = robot.issued[-2]
    robot.until(0.13)
    assert robot.stamped(stamp) == pytest.approx(0.13 - at)
    assert robot.driver == "a"


def test_robot_stops_within_the_budget_of_the_challenge_however_late_the_command_arrived(robot: AdmittingRobot) -> None:
    for _ in range(40):
        at, stamp = robot.issued[-1]
        robot.until(robot.now + 0.06)
        robot.stamped(stamp)
    robot.until(robot.now + 1.0)
    moving = [when for when, speed in robot.outputs if speed > 0.0]
    assert len(moving) > 40
    assert moving[-1] - at < SETTINGS.stop_time - SETTINGS.lag


def test_late_and_unknown_answers_are_refused(robot: AdmittingRobot) -> None:
    _, stamp = robot.issued[-1]
    robot.until(0.3)
    assert [robot.stamped(each) for each in (stamp, NO_STAMP, (3, 4))] == ["late"] * 3
    assert robot.driver == ""


def test_commands_of_another_client_are_refused_while_one_drives(robot: AdmittingRobot) -> None:
    robot.stamped(robot.newest, "a")
    assert robot.stamped(robot.newest, "b") == "not the driver"
    assert robot.stamped(robot.newest, "not an id") == "no client"
    robot.request("b", "take")
    assert robot.stamped(robot.newest, "b") == pytest.approx(0.0, abs=PERIOD)
    assert robot.stamped(robot.newest, "a") == "not the driver"
    assert isinstance(robot.stamped(robot.newest, "", NAVIGATION), float)
    assert robot.stamped(robot.newest, "", KEYBOARD) == "not the driver"


def test_refused_command_of_another_client_does_not_renew_the_lease(robot: AdmittingRobot) -> None:
    robot.stamped(robot.newest, "a")
    for _ in range(40):
        robot.until(robot.now + 0.1)
        robot.stamped(robot.newest, "b")
    assert (robot.admission.lease.lease.state, robot.driver) == ("lost", "a")


def test_late_request_does_not_count(robot: AdmittingRobot) -> None:
    _, stamp = robot.issued[-1]
    robot.until(0.9)
    assert robot.request("a", "take", stamp)
    robot.until(1.3)
    assert not robot.request("b", "take", stamp)
    assert robot.driver == "a"


def test_holder_is_lost_in_time_however_late_its_last_request_arrived(robot: AdmittingRobot) -> None:
    sent, stamp = robot.issued[-1]
    robot.until(sent + 0.9)
    assert robot.request("a", "take", stamp)
    states = []
    for late in (-1, 2):
        robot.until(sent + robot.admission.lease.timeout + late * PERIOD)
        states.append(robot.admission.lease.lease.state)
    assert states == ["held", "lost"]


def test_older_message_that_arrives_late_takes_no_time_from_its_sender(robot: AdmittingRobot) -> None:
    old = robot.newest
    robot.until(robot.now + 0.9)
    robot.stamped(robot.newest)
    heard = robot.now
    assert robot.request("a", "renew", old)
    robot.until(heard + robot.admission.lease.timeout - 3 * PERIOD)
    assert robot.admission.lease.lease.state == "held"


def test_command_that_arrived_fresh_counts_with_its_whole_age_after_it_has_waited(robot: AdmittingRobot) -> None:
    at, stamp = robot.issued[-1]
    robot.until(at + FRESHNESS + 0.01)
    assert robot.stamped(stamp, waited=0.005) == "late"
    assert robot.stamped(stamp, waited=0.02) == pytest.approx(robot.now - at)


def test_plain_commands_are_ignored_while_stamped_ones_come_by_the_same_source(robot: AdmittingRobot) -> None:
    verdicts = []
    for _ in range(20):
        robot.until(robot.now + 0.03)
        robot.stamped(robot.newest)
        verdicts.append(robot.plain())
    assert set(verdicts[5:]) == {"displaced"}
    for _ in range(10):
        robot.until(robot.now + 0.03)
        verdicts.append(robot.plain())
    assert verdicts[-1] == 0.0


def test_each_publisher_of_plain_commands_proves_its_own_rhythm(robot: AdmittingRobot) -> None:
    for _ in range(10):
        robot.until(robot.now + 0.03)
        verdict = robot.plain("/a")
    assert verdict == 0.0
    assert robot.plain("/b") == "on probation"
    for n in range(200):
        robot.plain(f"/flood{n}")
    assert len(robot.admission.plain) <= 32


def test_publisher_that_is_too_slow_is_named_once(robot: AdmittingRobot) -> None:
    for _ in range(5):
        robot.plain("/slow")
        robot.until(robot.now + 0.5)
    assert robot.slow == ["/slow"]


def drive_steadily(robot: AdmittingRobot, count: int = 20, delay: float = 0.002) -> None:
    for _ in range(count):
        robot.until(robot.now + 0.05)
        verdict = robot.plain(sent=robot.now - delay)
    assert verdict == pytest.approx(0.0, abs=1e-6)


def test_plain_command_with_a_stamp_is_as_old_as_its_stamp_shows(robot: AdmittingRobot) -> None:
    drive_steadily(robot)
    robot.until(robot.now + 0.05)
    assert robot.plain(sent=robot.now - 0.062) == pytest.approx(0.06, abs=1e-3)


def test_stream_of_a_publisher_that_cannot_be_told_apart_proves_its_own_rhythm(robot: AdmittingRobot) -> None:
    drive_steadily(robot)
    for delay, expected in ((0.0, "on probation"), (2.0, "held back")):
        moment = (round((robot.now + 100.0 - delay) * 1e9), robot.now)
        _, verdict = admit_plain(robot.admission, KEYBOARD, "/p", robot.now, motion=True, sent=moment, stream="2")
        assert verdict == expected


def test_time_that_a_command_waits_for_the_mux_counts(robot: AdmittingRobot) -> None:
    drive_steadily(robot)
    moment = (round((robot.now + 100.0) * 1e9), robot.now)
    _, verdict = admit_plain(robot.admission, KEYBOARD, "/p", robot.now + 0.08, motion=True, sent=moment)
    assert verdict == pytest.approx(0.08, abs=5e-3)


def test_command_that_was_held_back_is_refused_however_steadily_more_of_them_arrive(robot: AdmittingRobot) -> None:
    drive_steadily(robot)
    robot.until(robot.now + 5.0)
    began = robot.now
    verdicts = set()
    for _ in range(100):
        robot.until(robot.now + 0.05)
        verdicts.add(robot.plain(sent=robot.now - 2.0))
    assert verdicts == {"held back"}
    assert all(speed == 0.0 for at, speed in robot.outputs if at > began)


def test_commands_of_a_new_publisher_that_a_network_held_back_do_not_drive_while_its_queue_empties(
    robot: AdmittingRobot,
) -> None:
    for n in range(100):
        robot.until(robot.now + 0.04)
        assert robot.plain("/new", sent=n * 0.05) == "on probation"
        assert not robot.outputs


def test_publisher_whose_clock_is_set_ahead_drives_again_after_its_proof(robot: AdmittingRobot) -> None:
    drive_steadily(robot)
    verdicts = []
    for _ in range(6):
        robot.until(robot.now + 0.05)
        verdicts.append(robot.plain(sent=robot.now + 60.0))
    assert verdicts[:4] == ["on probation"] * 4
    assert isinstance(verdicts[-1], float)


def test_program_that_is_started_again_drives_whatever_its_clock_shows(robot: AdmittingRobot) -> None:
    drive_steadily(robot)
    for _ in range(6):
        robot.until(robot.now + 0.05)
        verdict = robot.plain("/p#again", sent=robot.now - 3600.0)
    assert verdict == 0.0


kinds = st.sampled_from(["stamped", "plain", "take", "acquire", "renew"])
delays = st.floats(FRESHNESS + 0.001, 30.0)
bursts = st.lists(st.tuples(st.floats(0.0, 30.0), st.integers(1, 40), kinds, delays), max_size=12)


@given(bursts)
@settings(max_examples=150, deadline=None)
def test_no_sequence_of_late_commands_moves_the_robot(bursts: list[tuple[float, int, str, float]]) -> None:
    """Each burst arrives after a silence, its commands together, all written `delay` s before."""
    robot = AdmittingRobot()
    robot.until(0.1)
    for silence, count, kind, delay in bursts:
        robot.until(robot.now + max(0.25, silence / 10.0))
        written_at = robot.now - delay
        stamp = next((stamp for at, stamp in reversed(robot.issued) if at <= written_at), NO_STAMP)
        for n in range(count):
            robot.until(robot.now + 0.0005)
            if kind == "stamped":
                assert robot.stamped(stamp) == "late"
            elif kind == "plain":
                robot.plain(f"/p{n % 2}")
            else:
                robot.request("b", "take" if kind == "take" else "acquire", stamp)
    robot.until(robot.now + 1.0)
    assert robot.outputs == []


clients = st.sampled_from(["a", "b", "c"])
moves = st.lists(
    st.tuples(st.floats(0.0, 0.1), clients, st.sampled_from(["drive", "take", "acquire", "release", "ask", "grant"])),
    max_size=60,
)


@given(moves)
@settings(max_examples=150, deadline=None)
def test_one_client_drives_at_a_time(moves: list[tuple[float, str, str]]) -> None:
    robot = AdmittingRobot()
    robot.until(0.1)
    for pause, client, action in moves:
        robot.until(robot.now + pause)
        before = robot.driver
        if action == "drive":
            admitted = isinstance(robot.stamped(robot.newest, client), float)
            assert admitted == (before in ("", client))
            assert robot.driver == (before or client)
        else:
            robot.request(client, action)  # type: ignore[arg-type]


@given(st.lists(st.tuples(st.floats(0.001, 0.2), st.floats(0.3, 30.0)), max_size=60))
@settings(max_examples=150, deadline=None)
def test_no_rhythm_of_late_stamped_commands_moves_the_robot(commands: list[tuple[float, float]]) -> None:
    """Each is sent `delay` s before it arrives, by a publisher that has driven before."""
    robot = AdmittingRobot()
    robot.until(0.1)
    drive_steadily(robot)
    robot.until(robot.now + 1.0)
    began = robot.now
    for gap, delay in commands:
        robot.until(robot.now + gap)
        assert robot.plain(sent=robot.now - delay) == "held back"
    assert all(speed == 0.0 for at, speed in robot.outputs if at > began)


def first_motion(arrivals: list[tuple[float, float]]) -> float | None:
    """Return when the robot begins to move, by commands of a new publisher: each was sent, and arrived."""
    robot = AdmittingRobot()
    robot.until(0.1)
    for sent, arrived in arrivals:
        robot.until(0.1 + arrived)
        robot.plain("/new", sent=0.1 + sent)
    return next((at - 0.1 for at, speed in robot.outputs if speed > 0.0), None)


jitters = st.lists(st.floats(0.0, 0.012), min_size=20, max_size=20)


@given(jitters, st.floats(0.0, 0.4), st.floats(0.05, 0.06))
@settings(max_examples=150, deadline=None)
def test_stream_of_20_hz_moves_the_robot_within_half_a_second_though_threads_pause(
    jitters: list[float], pause: float, length: float
) -> None:
    """A thread that receives pauses once: what comes meanwhile arrives together at the end of the pause."""
    arrivals = []
    for n, jitter in enumerate(jitters):
        at = n * 0.05 + jitter
        arrivals.append((n * 0.05, pause + length + n * 1e-5 if pause <= at < pause + length else at))
    moved = first_motion(arrivals)
    assert moved is not None
    assert moved - arrivals[0][1] <= 0.5


@given(
    st.floats(0.02, 0.1),
    st.floats(0.5, 5.0),
    st.lists(st.floats(0.0, 0.004) | st.floats(0.0, 0.6), min_size=4, max_size=60),
)
@settings(max_examples=150, deadline=None)
def test_commands_of_a_new_publisher_that_were_held_back_move_nothing(
    period: float, held: float, gaps: list[float]
) -> None:
    """They arrive in clusters, and between them at most at 0.6 of the period: a queue that empties."""
    now, arrivals = held, []
    for n, gap in enumerate(gaps):
        now += gap if gap <= 0.004 else gap * period
        if now - n * period < 0.15:
            break
        arrivals.append((n * period, now))
    assert first_motion(arrivals) is None


def test_clusters_out_of_a_backlog_that_stays_move_nothing(robot: AdmittingRobot) -> None:
    for n in range(40):
        robot.until(0.1 + n // 2 * 0.1 + n % 2 * 0.001)
        assert robot.plain("/new", sent=n * 0.05 - 2.0) == "on probation"


def drive_on_terms(robot: AdmittingRobot, terms: Terms | None, silent_from: float) -> None:
    """Navigation drives for a client that renews the lease on its terms until it falls silent."""
    while robot.now < 2.0:
        stamp = robot.issued[-1][1] if robot.issued else NO_STAMP
        if robot.now < silent_from:
            request = LeaseRequest("assistant", "laptop", "assistant", "acquire", answers=stamp, terms=terms)
            robot.admission, _ = admit_request(robot.admission, request, robot.now, robot.now)
        robot.admission, verdict = admit_stamped(
            robot.admission, NAVIGATION, stamp, "", robot.now, robot.now, motion=True, follows=True
        )
        if isinstance(verdict, float):
            robot.step(VelocityCommand(NAVIGATION, AHEAD, robot.now - verdict))
        robot.until(robot.now + 0.04)


def test_robot_is_at_rest_soon_after_a_client_that_drives_on_terms_falls_silent() -> None:
    robot = AdmittingRobot()
    drive_on_terms(robot, Terms(0.3, FRESHNESS), silent_from=1.0)
    assert max(speed for _, speed in robot.outputs) == pytest.approx(0.5)
    assert max((at for at, speed in robot.outputs if speed > 0.0), default=0.0) < 1.0 + 0.3


def test_navigation_goes_on_without_terms_while_its_client_is_silent() -> None:
    robot = AdmittingRobot()
    drive_on_terms(robot, None, silent_from=1.0)
    assert robot.outputs[-1][1] == pytest.approx(0.5)
