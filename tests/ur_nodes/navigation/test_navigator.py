import math
from dataclasses import replace

import numpy as np
import pytest
from tests.ur_nodes.navigation.closed_loop import LIMITS, MAGNI, STAGE, ClosedLoop, Drive, two_rooms

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.navigator import Navigator
from ur_nodes.navigation.navigator_step import (
    Ending,
    NavigatorInputs,
    NavigatorOutputs,
    NavigatorPhase,
    NavigatorSettings,
    PlanAnswer,
)
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.recovery import SEQUENCE, Behaviour
from ur_nodes.navigation.steering.rollout import RolloutState
from ur_nodes.navigation.steering.speed_profile import AT_REST, SpeedLimits, limit_speeds

STRAIGHT = np.stack((np.arange(0.0, 3.01, 0.05), np.zeros(61)), axis=-1)
HOME = Pose2(0.0, 0.0, 0.0)


def check(drive: Drive, goal: Pose2, limits: SpeedLimits = LIMITS) -> None:
    assert drive.ending is Ending.REACHED, drive.text
    assert not drive.touched
    assert math.hypot(drive.pose.x - goal.x, drive.pose.y - goal.y) <= 0.1
    assert abs(wrap_angle(drive.pose.yaw - goal.yaw)) <= math.radians(5.0)
    assert drive.speeds[:, 0].max() <= limits.speed + 1e-9
    assert abs(drive.speeds[:, 1]).max() <= limits.turn + 1e-9
    assert abs(np.diff(drive.speeds[:-1, 0])).max() <= 0.1 * limits.acceleration + 1e-9
    assert abs(np.diff(drive.speeds[:-1, 1])).max() <= 0.1 * limits.turn_acceleration + 1e-9


@pytest.mark.parametrize("outline", [STAGE, MAGNI], ids=["stage", "magni"])
@pytest.mark.parametrize("goal", [Pose2(3.0, -1.0, 1.57), Pose2(3.5, 1.2, 3.0), Pose2(-0.9, 1.3, -0.5)])
def test_navigator_reaches_goals_through_a_door(outline: tuple[tuple[float, float], ...], goal: Pose2) -> None:
    drive = ClosedLoop(two_rooms(), outline=outline).drive(goal)
    check(drive, goal)
    assert drive.logged == ()


def test_navigator_drives_fast_and_straight_in_the_open() -> None:
    grid = Grid(np.zeros((200, 200), np.int8), 0.05, Pose2(-2.0, -5.0, 0.0))
    drive = ClosedLoop(grid).drive(Pose2(6.0, 1.0, 0.0))
    check(drive, Pose2(6.0, 1.0, 0.0))
    assert drive.length < 1.01 * math.hypot(6.0, 1.0)
    assert drive.seconds < 1.15 * drive.length / 0.5


@pytest.mark.parametrize("yaw", [1.2, -1.6, 2.6])
def test_navigator_makes_part_of_its_turns_while_it_drives(yaw: float) -> None:
    grid = Grid(np.zeros((200, 200), np.int8), 0.05, Pose2(-2.0, -5.0, 0.0))
    goal = Pose2(5.0, 0.5, yaw)
    drive = ClosedLoop(grid, pose=Pose2(0.0, 0.0, -yaw)).drive(goal)
    check(drive, goal)
    assert drive.plans == 1
    assert math.hypot(drive.pose.x - goal.x, drive.pose.y - goal.y) < 0.02
    assert drive.length < 1.12 * math.hypot(5.0, 0.5)
    on_the_spot = 2.0 * abs(yaw)  # s, at 1 rad/s
    assert drive.seconds < drive.length / 0.5 + on_the_spot - 0.5


def test_navigator_keeps_out_of_a_zone_that_no_sensor_sees() -> None:
    grid = Grid(np.zeros((200, 200), np.int8), 0.05, Pose2(-2.0, -5.0, 0.0))
    zone = Grid(np.full((40, 20), 100, np.int8), 0.05, Pose2(2.0, -0.7, 0.0))  # across the straight line
    drive = ClosedLoop(grid, keep_out=zone).drive(Pose2(6.0, 0.0, 0.0))
    check(drive, Pose2(6.0, 0.0, 0.0))
    x, y = drive.trace[:, 0], drive.trace[:, 1]
    assert abs(y).max() > 0.8, "round it"
    inside = (x > 2.0) & (x < 3.0) & (y > -0.7) & (y < 1.3)
    assert not inside.any()
    near = (x > 1.85) & (x < 3.15) & (y > -0.84) & (y < 1.44)
    assert not near.any(), "nor with its outline"


def test_navigator_slows_down_before_a_speed_zone_and_goes_on_after_it() -> None:
    grid = Grid(np.zeros((200, 200), np.int8), 0.05, Pose2(-2.0, -5.0, 0.0))
    zone = Grid(np.full((40, 40), 30, np.int8), 0.05, Pose2(2.0, -1.0, 0.0))
    drive = ClosedLoop(grid, speed_mask=zone).drive(Pose2(6.0, 0.0, 0.0))
    check(drive, Pose2(6.0, 0.0, 0.0))
    x, speed = drive.trace[1:, 0], drive.speeds[1:, 0]
    assert speed[(x > 2.05) & (x < 4.0)].max() <= 0.3 * LIMITS.speed + 0.01
    assert speed[x < 1.5].max() > 0.45
    assert speed[x > 4.2].max() > 0.45


def test_navigator_plans_with_the_speed_that_the_mux_allows_and_brakes_gently_to_it() -> None:
    grid = Grid(np.zeros((200, 200), np.int8), 0.05, Pose2(-2.0, -5.0, 0.0))
    drive = ClosedLoop(grid, share=lambda pose: 0.3 if 2.0 < pose.x < 4.0 else 1.0).drive(Pose2(6.0, 0.0, 1.0))
    check(drive, Pose2(6.0, 0.0, 1.0))
    x, speed = drive.trace[1:, 0], drive.speeds[1:, 0]
    assert speed[(x > 2.5) & (x < 3.9)].max() <= 0.3 * LIMITS.speed + 1e-9
    assert speed[x < 1.9].max() > 0.45
    assert speed[x > 4.5].max() > 0.45
    limited = ClosedLoop(grid, share=lambda _: 0.3).drive(Pose2(1.0, 0.0, 3.0))
    check(limited, Pose2(1.0, 0.0, 3.0), limit_speeds(LIMITS, 0.3))


def test_navigator_stands_a_localisation_that_trembles() -> None:
    drive = ClosedLoop(two_rooms(), error=0.02).drive(Pose2(3.0, -1.0, 1.57))
    check(drive, Pose2(3.0, -1.0, 1.57))


def test_navigator_drives_round_obstacles_that_the_map_does_not_show() -> None:
    goal = Pose2(3.0, 1.0, 0.0)
    drive = ClosedLoop(two_rooms()).drive(goal, obstacles=[(0.75, 0.35, 0.3), (2.4, 0.95, 0.3)])
    check(drive, goal)
    assert drive.plans >= 2, "the second obstacle is seen on the way"


def test_navigator_gives_up_at_a_door_that_is_shut_after_trying_everything() -> None:
    loop = ClosedLoop(two_rooms(), settings=NavigatorSettings(planner_patience=1.0, controller_patience=1.0))
    drive = loop.drive(Pose2(3.0, 0.0, 0.0), obstacles=[(1.5, 0.85, 1.0)])
    assert drive.ending is Ending.FAILED
    assert not drive.touched
    assert "nothing wide enough" in drive.text
    assert "after clearing, turning and backing off" in drive.text
    assert len([line for line in drive.logged if "recovering" in line]) == len(SEQUENCE)


@pytest.mark.parametrize(
    ("goal", "reason"),
    [
        (Pose2(1.5, -1.0, 0.0), "in a wall"),
        (Pose2(30.0, 0.0, 0.0), "outside the map"),
        (Pose2(1.35, -1.0, 0.0), "so near"),
    ],
)
def test_navigator_refuses_impossible_goals_at_once_and_says_why(goal: Pose2, reason: str) -> None:
    drive = ClosedLoop(two_rooms()).drive(goal)
    assert drive.ending is Ending.FAILED
    assert reason in drive.text
    assert drive.seconds < 1.0
    assert drive.length == 0.0


@pytest.mark.parametrize("any_heading", [False, True])
def test_goal_without_a_heading_is_reached_where_there_is_no_room_to_turn(any_heading: bool) -> None:
    goal = Pose2(-1.28, -0.5, 0.8)
    loop = ClosedLoop(two_rooms(), pose=Pose2(0.5, 0.0, 0.0), outline=MAGNI)
    drive = loop.drive(goal, any_heading=any_heading)
    if not any_heading:
        assert drive.text.startswith("no room to turn at the goal")
        return
    assert drive.ending is Ending.REACHED, drive.text
    assert not drive.touched
    assert math.hypot(drive.pose.x - goal.x, drive.pose.y - goal.y) <= 0.1
    assert not drive.speeds[-1].any()


def test_navigator_leaves_a_place_where_it_cannot_turn() -> None:
    loop = ClosedLoop(two_rooms(), pose=Pose2(-1.24, 0.0, 2.2), outline=MAGNI)
    drive = loop.drive(Pose2(0.5, 0.0, 0.0))
    assert drive.ending is Ending.REACHED, drive.text


@pytest.mark.parametrize("goal", [Pose2(2.6, -0.9, 0.0), Pose2(0.4, 0.9, 3.0)])
def test_robot_that_cannot_turn_on_the_spot_keeps_to_its_narrowest_bend(goal: Pose2) -> None:
    car = ((0.45, 0.2), (-0.15, 0.2), (-0.15, -0.2), (0.45, -0.2))
    loop = ClosedLoop(two_rooms(), pose=Pose2(-0.6, 0.0, 1.57), outline=car, limits=replace(LIMITS, radius=0.6))
    drive = loop.drive(goal)
    assert (drive.ending, drive.touched) == (Ending.REACHED, False), drive.text
    assert math.dist(drive.pose[:2], goal[:2]) < 0.12
    assert abs(wrap_angle(drive.pose.yaw - goal.yaw)) < 0.15
    assert (abs(drive.speeds[:, 1]) <= abs(drive.speeds[:, 0]) / 0.6 + 1e-9).all()


# Histories: one navigator, inputs written down, outputs looked at.


class NavigatorHistory:
    def __init__(self, **settings: float | bool) -> None:
        self.now = 0.0
        self.navigator = Navigator(
            NavigatorSettings(**settings),  # type: ignore[arg-type] # a test's shorthand for a few of its fields
            LIMITS,
            footprint_of_outline(STAGE, 0.05),
        )
        self.motion: RolloutState | None = RolloutState(HOME, 0.0, 0.0)
        self.local = Costmap(np.zeros((80, 80), np.uint8), 0.05, Pose2(-2.0, -2.0, 0.0))

    def step(
        self,
        answer: PlanAnswer | None = None,
        trouble: str = "",
        *,
        blocked: bool = False,
        contact: str = "",
        beside: bool = False,
    ) -> NavigatorOutputs:
        self.now += 0.1
        local = LocalObstacles(self.local)
        return self.navigator.step(
            NavigatorInputs(
                self.now, self.motion, HOME, local, answer, trouble, blocked, contact=contact, beside=beside
            )
        )

    def start(self) -> NavigatorOutputs:
        self.navigator.start(Pose2(3.0, 0.0, 0.0), self.now)
        return self.step()


def test_navigator_is_silent_without_a_goal() -> None:
    out = NavigatorHistory().step()
    assert (out.command, out.plan, out.ending) == (None, False, None)


def test_navigator_asks_for_a_plan_once_and_then_drives() -> None:
    history = NavigatorHistory()
    assert history.start().plan
    assert not history.step().plan
    out = history.step(PlanAnswer(STRAIGHT))
    assert history.navigator.phase is NavigatorPhase.DRIVING
    assert out.command is not None
    assert out.command[0] == pytest.approx(0.1)


def test_navigator_asks_anew_when_the_way_is_blocked_and_not_more_than_once_a_second() -> None:
    history = NavigatorHistory()
    history.start()
    history.step(PlanAnswer(STRAIGHT))
    history.now += 1.0
    asked = 0
    for _ in range(20):
        out = history.step(PlanAnswer(STRAIGHT), blocked=True)
        asked += out.plan
    assert 1 <= asked <= 3


def test_navigator_stops_in_trouble_says_why_and_goes_on_after_it() -> None:
    history = NavigatorHistory()
    history.start()
    history.step(PlanAnswer(STRAIGHT))
    out = history.step(trouble="no scan on /scan for 1.0 s")
    assert out.command == AT_REST
    assert "no scan on /scan" in out.log
    assert history.step(trouble="no scan on /scan for 1.1 s").log == "", "once is enough"
    out = history.step()
    assert out.command is not None
    assert out.command[0] > 0.0


def test_navigator_gives_up_when_trouble_lasts() -> None:
    history = NavigatorHistory(trouble_patience=2.0)
    history.start()
    endings = [history.step(trouble="no scan on /scan for a while") for _ in range(25)]
    last = next(out for out in endings if out.ending is not None)
    assert last.ending is Ending.FAILED
    assert last.text == "no scan on /scan for a while"
    assert history.navigator.phase is NavigatorPhase.IDLE


def test_navigator_tries_each_recovery_in_order_before_it_gives_up() -> None:
    history = NavigatorHistory(planner_patience=0.5)
    history.start()
    tried: list[str] = []
    cleared: list[Behaviour] = []
    for _ in range(1500):
        out = history.step(PlanAnswer(None, "no path: something stands there"))
        if history.motion and out.command:
            x, y, yaw = history.motion.pose
            v, w, _ = out.command
            history.motion = RolloutState(
                Pose2(x + 0.1 * v * math.cos(yaw), y + 0.1 * v * math.sin(yaw), yaw + 0.1 * w), v, w
            )
        if out.log:
            tried.append(out.log.split("recovering: ")[1])
        if out.clear:
            cleared.append(out.clear)
        if out.ending:
            break
    assert tried == [behaviour.value for behaviour in SEQUENCE]
    assert cleared == [Behaviour.CLEAR_FAR, Behaviour.CLEAR_ALL]
    assert out.ending is Ending.FAILED
    assert out.text.startswith("no path: something stands there")


def test_navigator_backs_off_first_where_there_is_no_room_to_turn() -> None:
    history = NavigatorHistory(controller_patience=0.5)
    history.local.costs[44:46] = LETHAL  # a wall 0.2 m to the left
    history.start()
    history.step(PlanAnswer(-STRAIGHT))
    outs = [history.step() for _ in range(10)]
    assert [out.log.split("recovering: ")[1] for out in outs if out.log] == [Behaviour.BACK_OFF.value]


def test_obstacles_that_the_scan_shows_are_no_people_who_will_leave() -> None:
    history = NavigatorHistory(controller_patience=0.5)
    history.navigator.start(Pose2(0.0, 0.0, 1.5), history.now)
    history.step()
    walls = np.array([(x, side * 0.21) for side in (1, -1) for x in np.arange(-0.5, 0.5, 0.04)])
    around = LocalObstacles(history.local, points=walls)
    outs, answer = [], PlanAnswer(np.array(((0.0, 0.0), (0.001, 0.0))))
    for number in range(20):
        given = answer if number == 0 else None
        history.now += 0.1
        outs.append(history.navigator.step(NavigatorInputs(history.now, history.motion, HOME, around, given)))
    assert "no room to turn at the goal" in "".join(out.log for out in outs)


def test_navigator_without_recovery_gives_up_at_once() -> None:
    history = NavigatorHistory(planner_patience=0.5, recovery_enabled=False)
    history.start()
    outs = [history.step(PlanAnswer(None, "no path: it is shut")) for _ in range(10)]
    assert [out.text for out in outs if out.ending] == ["no path: it is shut"]


def test_navigator_notices_that_the_robot_does_not_move() -> None:
    history = NavigatorHistory(progress_timeout=2.0)
    history.start()
    history.step(PlanAnswer(STRAIGHT))
    outs = [history.step() for _ in range(30)]
    assert any("recovering" in out.log for out in outs)


@pytest.mark.parametrize(("beside", "does"), [(True, "; backing off"), (False, "; recovering: ")])
def test_stuck_robot_blames_what_no_lidar_sees_only_beside_what_it_touched(beside: bool, does: str) -> None:
    history = NavigatorHistory()
    history.start()
    history.step(PlanAnswer(STRAIGHT))
    assert "pressed; backing off" in history.step(contact="pressed").log
    logs = [history.step(PlanAnswer(STRAIGHT), beside=beside).log for _ in range(150)]
    first = next(filter(None, logs))
    assert does in first
    assert ("lidar does not see" in first) == beside


def test_robot_that_finds_no_path_does_not_blame_what_it_touched() -> None:
    history = NavigatorHistory()
    history.start()
    history.step(contact="pressed")
    shut = PlanAnswer(None, "no path: a person stands at the goal")
    first = next(filter(None, (history.step(shut, beside=True).log for _ in range(150))))
    assert first.startswith("no path: a person stands at the goal; recovering: ")


def test_contacts_before_a_goal_was_held_count_after_it() -> None:
    history = NavigatorHistory()
    history.navigator.start(Pose2(3.0, 0.0, 0.0), history.now, contacts=2)
    history.step(PlanAnswer(STRAIGHT))
    out = history.step(contact="pressed")
    assert out.ending is Ending.FAILED
    assert out.text.endswith("pressed, for the 3rd time")


def test_navigator_takes_a_new_goal_over_without_a_jerk() -> None:
    history = NavigatorHistory()
    history.start()
    out = history.step(PlanAnswer(STRAIGHT))
    for _ in range(6):
        out = history.step()
    assert out.command is not None
    before = out.command[0]
    history.navigator.start(Pose2(0.0, 2.0, 0.0), history.now)
    after = history.step().command
    assert after is not None
    assert 0.0 < before - after[0] <= 0.1 + 1e-9


def test_navigator_stops_for_what_appears_right_before_it() -> None:
    grid = Grid(np.zeros((120, 200), np.int8), 0.05, Pose2(-2.0, -3.0, 0.0))
    loop = ClosedLoop(grid)
    loop.drive(Pose2(6.0, 0.0, 0.0), seconds=4.0)
    assert loop.command[0] > 0.45, "it drives at full speed"
    for offset in (-0.6, -0.3, 0.0, 0.3, 0.6):
        loop.add_obstacle(loop.pose.x + 0.2 + 0.35 + 0.15, offset, 0.3)
    drive = loop.drive(Pose2(6.0, 0.0, 0.0))
    check(drive, Pose2(6.0, 0.0, 0.0))
