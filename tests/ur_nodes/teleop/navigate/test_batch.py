import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import pytest
from tests.ur_nodes.teleop.recordings import no_recordings

from ur_nodes.client.driver_text import clock_time
from ur_nodes.client.mux import MuxView
from ur_nodes.client.patrol_text import PatrolRoute, PatrolStop
from ur_nodes.client.snapshot import GoalReport, LastGoalState, Silence
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.lease.view import LeaseView
from ur_nodes.teleop.navigate.batch import (
    BatchContext,
    BatchTimeouts,
    InterruptedBatchError,
    run_batch,
    wait_until_ready,
)


@dataclass
class BatchWorld:
    """Time that passes only while the batch sleeps; `happens` is called with it."""

    happens: Callable[[float], None] = lambda _: None
    now: float = 0.0
    interrupted_at: float = math.inf
    out: list[str] = field(default_factory=list)
    err: list[str] = field(default_factory=list)

    def sleep(self, seconds: float) -> bool:
        self.now += seconds
        self.happens(self.now)
        return self.now >= self.interrupted_at

    def around(self) -> BatchContext:
        return BatchContext(self.out.append, self.err.append, lambda: self.now, self.sleep, no_recordings())


def arriving(navigator: Any) -> Callable[[float], None]:
    def happens(_now: float) -> None:
        if not navigator.seen.goal.over:
            navigator.move(navigator.seen.goal.pose)
            navigator.end(LastGoalState.REACHED)

    return happens


def run(
    lines: list[str], navigator: Any, store: WaypointStore, world: BatchWorld, limits: BatchTimeouts | None = None
) -> int:
    return run_batch(lines, navigator, store, limits or BatchTimeouts(), world.around())


def test_goal_that_is_reached_says_how_well(navigator: Any, store: WaypointStore) -> None:
    def happens(now: float) -> None:
        if now > 12.29 and not navigator.seen.goal.over:
            navigator.move(Pose2(2.0, 2.96, math.radians(91.2)))
            navigator.end(LastGoalState.REACHED)

    world = BatchWorld(happens)
    assert run(["g 2 3 90\n"], navigator, store, world) == 0
    assert world.out == ["g 2 3 90: reached, 0.04 m and 1.2 degrees off, 12.3 s"]


def test_goal_without_an_angle_asks_for_no_heading_and_its_result_names_none(
    navigator: Any, store: WaypointStore
) -> None:
    world = BatchWorld(arriving(navigator))
    assert run(["g 2 3"], navigator, store, world) == 0
    assert navigator.any_heading
    assert world.out == ["g 2 3: reached, 0.00 m off, 0.1 s"]
    run(["g 2 3 90"], navigator, store, world)
    assert not navigator.any_heading


def test_goal_that_fails_gives_the_reason_and_exit_code_1(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld(lambda _: navigator.end(LastGoalState.FAILED, "the goal is in a wall"))
    assert run(["g 0 5"], navigator, store, world) == 1
    assert world.out == ["g 0 5: failed after 0.1 s: the goal is in a wall"]


def test_patrol_is_started_with_the_poses_of_its_waypoints_and_left_to_the_robot(
    navigator: Any, store: WaypointStore
) -> None:
    store.remember("sofa", Pose2(1.0, 2.0, 0.0))
    store.remember("hall", Pose2(3.0, 0.0, 0.0))
    world = BatchWorld(lambda _: None)
    assert run(["patrol loop sofa hall", "patrol pause"], navigator, store, world) == 0
    assert world.out == ["patrol loop sofa hall: started", "patrol pause: paused"]
    (start, pause) = navigator.patrols
    assert start == (
        "start",
        PatrolRoute((PatrolStop("sofa", 1.0, 2.0, 0.0), PatrolStop("hall", 3.0, 0.0, 0.0)), loop=True),
    )
    assert pause[0] == "pause"
    navigator.patrol_problem = "laptop drives since 14:02"
    assert run(["patrol resume"], navigator, store, world) == 1
    assert world.out[-1] == "patrol resume: refused: laptop drives since 14:02"
    assert run(["patrol nowhere"], navigator, store, world) == 1
    assert "unknown waypoint 'nowhere'" in world.err[-1]


def test_goals_are_driven_one_after_another(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld(arriving(navigator))
    assert run(["g 1 0", "", "# a comment", "g 1 1"], navigator, store, world) == 0
    assert navigator.goals == [Pose2(1.0, 0.0, 0.0), Pose2(1.0, 1.0, math.pi / 2)]
    assert len(world.out) == 2


def test_malformed_line_is_reported_and_the_rest_still_done(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld(arriving(navigator))
    assert run(["g 2 x", "m nowhere", "g 1 0 0"], navigator, store, world) == 1
    assert world.err[0] == "error: g 2 x: 'x' is not a number, expected: g X Y [ANGLE]"
    assert "m nowhere: unknown waypoint 'nowhere'" in world.err[1]
    assert len(navigator.goals) == 1


def test_waypoints_are_remembered_listed_reached_and_dropped(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld(arriving(navigator))
    navigator.move(Pose2(1.0, 2.0, math.pi))
    assert run(["l", "w here", "g 0 0 0", "m here", "l", "d here"], navigator, store, world) == 0
    assert navigator.goals[-1] == pytest.approx(Pose2(1.0, 2.0, math.pi))
    assert world.out[0] == "l: no waypoints yet"
    assert world.out[1] == "w here: saved at 1.00 2.00 180"
    assert "here: 1.00 2.00 180" in world.out
    assert world.out[-1] == "d here: deleted"


def test_other_commands(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld()
    assert run(["i 1 2 90", "global", "s", "?", "q", "g 1 1"], navigator, store, world) == 0
    assert navigator.poses == [Pose2(1.0, 2.0, math.pi / 2)]
    assert (navigator.searches, navigator.stops) == (1, 1)
    assert not navigator.goals
    assert "g X Y [ANGLE]" in world.out[-1]


def test_emergency_ends_the_goal_and_lasts_until_the_release(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld()
    navigator.go(Pose2(1.0, 1.0, 0.0))
    assert run(["e", "r"], navigator, store, world) == 0
    assert world.out == ["e: emergency stop", "r: released"]
    assert navigator.asked == ["stop", "release"]
    assert navigator.stops == 1


def test_emergency_that_the_mux_does_not_answer_fails(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld()
    navigator.ask_mux = lambda request: setattr(navigator, "seen", replace(navigator.seen, mux=MuxView(asked=request)))
    assert run(["e"], navigator, store, world) == 1
    navigator.ask_mux = lambda _: setattr(navigator, "seen", replace(navigator.seen, mux=MuxView(problem="no mux")))
    assert run(["e"], navigator, store, world) == 1
    assert world.out == ["e: no answer within 5 s", "e: no mux"]


def test_goal_over_the_limit_is_cancelled(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld()
    assert run(["g 1 1"], navigator, store, world, BatchTimeouts(goal=5.0)) == 1
    assert "not reached after 5 s" in world.out[0]
    assert navigator.stops == 1


def test_goal_that_is_replaced_by_somebody_else_fails(navigator: Any, store: WaypointStore) -> None:
    def happens(_: float) -> None:
        navigator.seen = replace(navigator.seen, goal=GoalReport(7, Pose2(0, 0, 0), LastGoalState.DRIVING))

    world = BatchWorld(happens)
    assert run(["g 1 1"], navigator, store, world) == 1
    assert "another goal took its place" in world.out[0]


def test_interruption_cancels_the_goal(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld(interrupted_at=1.0)
    with pytest.raises(InterruptedBatchError):
        run(["g 1 1"], navigator, store, world)
    assert navigator.stops == 1


def test_waiting_ends_when_everything_is_there(navigator: Any) -> None:
    navigator.seen = replace(navigator.seen, missing=("the map (topic /map)",))

    def happens(now: float) -> None:
        if now > 3:
            navigator.seen = replace(navigator.seen, missing=())

    assert wait_until_ready(navigator, BatchTimeouts(), BatchWorld(happens).around()) is None


def test_waiting_has_a_limit_and_says_what_is_missing(navigator: Any) -> None:
    navigator.seen = replace(navigator.seen, missing=("the map (topic /map)", "navigation (action /move_base)"))
    world = BatchWorld()
    missing = wait_until_ready(navigator, BatchTimeouts(start=30.0), world.around())
    assert missing == "the map (topic /map) and navigation (action /move_base)"
    assert world.now == pytest.approx(30.0, abs=0.2)


def test_held_goal_is_noted_once_and_reported_by_its_end(navigator: Any, store: WaypointStore) -> None:
    def happens(now: float) -> None:
        if 1.0 < now < 2.0:
            navigator.end(LastGoalState.HELD, "held: no word from laptop for 3 s")
        elif 2.0 <= now < 3.0:
            navigator.end(LastGoalState.DRIVING)
        elif now >= 3.0:
            navigator.move(Pose2(1.0, 0.0, 0.0))
            navigator.end(LastGoalState.REACHED)

    world = BatchWorld(happens)
    assert run(["g 1 0"], navigator, store, world) == 0
    assert world.err == ["note: g 1 0: held: no word from laptop for 3 s", "note: g 1 0: driving"]
    assert world.out[0].startswith("g 1 0: reached")


def test_lost_link_leaves_the_goal_open_and_is_given_up_as_unknown(navigator: Any, store: WaypointStore) -> None:
    def happens(now: float) -> None:
        navigator.seen = replace(navigator.seen, silence=Silence("the robot", now))
        navigator.end(LastGoalState.UNKNOWN)

    world = BatchWorld(happens)
    assert run(["g 1 0"], navigator, store, world, BatchTimeouts(start=30.0)) == 1
    assert world.err == ["note: g 1 0: no word from the robot for 0.1 s; the goal is unknown until it answers"]
    assert world.out == ["g 1 0: unknown after 30.0 s: no word from the robot for 30.0 s"]


def test_goal_that_was_taken_over_or_came_late_says_so(navigator: Any, store: WaypointStore) -> None:
    world = BatchWorld(lambda _: navigator.end(LastGoalState.STOPPED, "laptop2 took over"))
    assert run(["g 0 5"], navigator, store, world) == 1
    assert world.out == ["g 0 5: stopped after 0.1 s: laptop2 took over"]
    late = "the goal arrived late (3.2 s), send it again"
    world = BatchWorld(lambda _: navigator.end(LastGoalState.FAILED, late))
    assert run(["g 0 4"], navigator, store, world) == 1
    assert world.out == [f"g 0 4: failed after 0.1 s: {late}"]


def test_nothing_is_sent_while_another_client_drives_until_this_one_does(navigator: Any, store: WaypointStore) -> None:
    other = LeaseView("held", "laptop2", since=100.0)
    navigator.seen = replace(navigator.seen, lease=other)

    def happens(now: float) -> None:
        if navigator.requests:
            navigator.seen = replace(navigator.seen, lease=replace(other, mine=True))
        arriving(navigator)(now)

    world = BatchWorld(happens)
    assert run(["g 1 0", "i 1 1 0", "take", "g 1 0", "give"], navigator, store, world) == 1
    drives = f"laptop2 drives since {clock_time(100.0)}; 'drive' takes over, 'ask' asks for it"
    assert world.out[:2] == [f"g 1 0: not sent: {drives}", "take: drives now"]
    assert world.err == [f"error: i 1 1 0: not done: {drives}"]
    assert world.out[2].startswith("g 1 0: reached")
    assert world.out[3].startswith("give: not done within 5 s")


def test_goal_waits_for_a_silent_robot_before_it_is_sent(navigator: Any, store: WaypointStore) -> None:
    navigator.seen = replace(navigator.seen, silence=Silence("the robot", 2.0))

    def happens(now: float) -> None:
        if now > 3.0:
            navigator.seen = replace(navigator.seen, silence=None)
            arriving(navigator)(now)

    world = BatchWorld(happens)
    assert run(["g 1 0"], navigator, store, world) == 0
    navigator.seen = replace(navigator.seen, silence=Silence("the robot", 2.0))
    silent = BatchWorld()
    assert run(["g 1 0"], navigator, store, silent, BatchTimeouts(start=5.0)) == 1
    assert silent.out == ["g 1 0: not sent: no word from the robot for 2.0 s"]


def test_interrupt_says_whether_the_goal_was_cancelled(navigator: Any, store: WaypointStore) -> None:
    with pytest.raises(InterruptedBatchError, match="the goal was cancelled"):
        run(["g 1 0"], navigator, store, BatchWorld(interrupted_at=1.0))
    navigator.stop = lambda: None
    navigator.seen = replace(navigator.seen, goal=GoalReport())

    def happens(_now: float) -> None:
        navigator.seen = replace(navigator.seen, silence=Silence("the robot", 4.0))

    with pytest.raises(InterruptedBatchError, match="may not be cancelled: no word from the robot for 4"):
        run(["g 1 0"], navigator, store, BatchWorld(happens, interrupted_at=1.0))
