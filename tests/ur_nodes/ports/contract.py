"""What every backend of `ur_nodes.ports` promises: checks that are given two nodes and a way to let time pass.

Run as a program (NAME ...) it makes checks on ROS 1, and prints one line of JSON: the failures by the names of checks.
"""

from __future__ import annotations

import json
import math
import sys
import threading
import time
import traceback
from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

import numpy as np
import pytest

from ur.source.diagnostic import UserError
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.ports import values
from ur_nodes.ports.actions import Goal, GoalHandle, GoalId, GoalState
from ur_nodes.ports.node import Node, Sender
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, AskPath, Place, Silent, Switch, Trigger, UseMap
from ur_nodes.ports.values import Result, Transform, Twist

STAMP = 1_700_000_000_123_456_789
_POSES = np.array([(1.0, 2.0, 0.5), (-1.0, 0.0, -3.0)])
_TARGET = values.PlacedPose(STAMP, "map", Pose2(1.0, 2.0, 0.5))
_GRID = Grid(np.array([[0, 100, -1], [7, 0, 0]], np.int8), 0.05, Pose2(-1.0, 2.0, 0.0))

_STATES = {0: "pending", 1: "active", 2: "cancelled", 3: "succeeded", 4: "aborted", 6: "active", 8: "cancelled"}
"""actionlib_msgs/GoalStatus as `ports.actions.GoalState`."""

VALUES: tuple[object, ...] = (
    "some text",
    True,
    0.25,
    -7,
    values.Number(0.1),
    values.Signal(),
    values.Time(STAMP),
    values.ClockTime(STAMP),
    Twist(0.5, -0.25, 0.125, 0.0625, -0.5, 1.5),
    values.StampedTwist(STAMP, "client", Twist(0.5, 0.0)),
    values.Odometry(STAMP, "odom", "base", Pose2(1.0, 2.0, 0.5), Twist(0.5, 0.25), np.eye(3) * 0.5, np.eye(3) * 0.25),
    values.DriverOdometry(STAMP, 1.0, 2.0, (0.0, 0.0, 0.5, 0.5), 0.5, 0.25),
    values.Scan(STAMP, "laser", -1.5, 0.25, 0.125, 8.0, np.array([1.0, np.inf, np.nan], np.float32)),
    values.Range(STAMP, "sonar", 1.5, 0.25, 0.125, 4.0),
    values.Imu(STAMP, "imu", (0.0, 0.0, 0.0, 1.0), (0.5, 0.0, 0.0), (0.0, 0.0, 9.75), 0.5, 0.25, 0.125),
    values.Battery(STAMP, 12.5, -1.5, 2.5, 4.0, 0.625, technology="nimh"),
    values.Joints(STAMP, ("left", "right"), (0.5, -0.5), (1.0, 2.0)),
    values.Joystick(STAMP, (0.5, -1.0), (0, 1)),
    values.PlacedPose(STAMP, "map", Pose2(1.0, 2.0, 0.5)),
    values.PoseEstimate(STAMP, "map", Pose2(1.0, 2.0, 0.5), np.arange(9.0).reshape(3, 3)),
    values.Poses(STAMP, "map", _POSES),
    values.Path(STAMP, "map", _POSES),
    GoalId("a goal", STAMP),
    values.Outline(STAMP, "map", np.array([(0.5, 0.25), (1.0, 2.0)])),
    values.Map(STAMP, "map", _GRID),
    values.MapInfo(STAMP, 0.0625, 3, 2, Pose2(1.0, 2.0, 0.5)),
    values.MapUpdate(STAMP, "map", 1, 2, np.array([[1, 2], [3, 4]], np.int8)),
    values.Markers(
        STAMP,
        "map",
        (
            values.Marker("one", 1, "cube", Pose2(1.0, 2.0, 0.0).in_space(), (0.5, 0.5, 0.25), (1.0, 0.5, 0.25, 1.0)),
            values.Marker(
                "one", 2, "text", Pose2(1.0, 2.0, 0.0).in_space(), (0.0, 0.0, 0.5), (1.0, 1.0, 1.0, 1.0), "7"
            ),
            values.Marker(
                *("two", 1, "points", Pose2(0.0, 0.0, 0.0).in_space(), (0.125, 0.125, 0.0), (0.0, 0.0, 1.0, 1.0), ""),
                np.array([(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)]),
            ),
        ),
    ),
    values.Picture(STAMP, "camera", 2, 1, "rgb8", 6, b"\x01\x02\x03\x04\x05\x06"),
    values.Calibration(STAMP, "camera", 4, 2, "plumb_bob", (0.5,) * 5, (2.0,) * 9, (1.0,) * 9, (4.0,) * 12),
    values.PackedPicture(STAMP, "camera", "jpeg", b"\xff\xd8"),
    (Transform(STAMP, "odom", "base", Pose3(1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0)),) * 2,
)


class Stage(Protocol):
    """Two nodes (one and the same, where a process has only one), and time. `begin` lets their callbacks come."""

    one: Node
    other: Node

    def begin(self) -> None:
        """Start."""

    def until(self, condition: Callable[[], bool]) -> None:
        """Let time pass until a condition is true; fails after a while."""

    def client(self, action: str) -> GoalClient:
        """A client of goals that is connected, after `begin`."""


class GoalClient(Protocol):
    """The other end of `serve_goals`, as clients of the backend have it."""

    def send(self, target: values.PlacedPose) -> str:
        """Send a goal; returns its id."""

    def cancel(self, id: str) -> None:
        """Cancel it; '' for all."""

    def cancel_sent_before(self, id: str) -> None:
        """Cancel all goals that were sent before this one, and it."""

    def state(self, id: str) -> tuple[str, str]:
        """The state and its text, as last heard: `ports.actions.GoalState`."""

    def report(self) -> values.PlacedPose | None:
        """The last pose that was heard."""


class Follower:
    """A node that sends goals: the ids of those that are open, and the ends that it heard of."""

    def __init__(self) -> None:
        self.open: set[str] = set()
        self.ends: list[GoalState] = []

    def take_states(self, states: tuple[GoalState, ...]) -> None:
        self.open = {each.id for each in states if each.open}

    def take_goal_end(self, state: GoalState) -> None:
        self.ends.append(state)


class Takers:
    """A node that takes goals, and what it got."""

    def __init__(self) -> None:
        self.got: list[GoalHandle] = []
        self.cancelled: list[str] = []

    def take_goal(self, handle: GoalHandle) -> None:
        self.got.append(handle)

    def take_cancel(self, handle: GoalHandle) -> None:
        self.cancelled.append(handle.goal.id)
        handle.cancel("as you wish")

    def has_cancelled(self, count: int) -> bool:
        return len(self.cancelled) == count


def check_value_of_each_kind_arrives_as_it_was_sent(stage: Stage) -> None:
    got: dict[int, object] = {}
    publishers = []
    for index, value in enumerate(VALUES):
        kind: type[Any] = type(value)
        stage.other.subscribe(f"values/{index}", kind, partial(got.__setitem__, index))
        publishers.append(stage.one.publish(f"values/{index}", kind, Quality.LATCHED))
    stage.begin()
    for publisher, value in zip(publishers, VALUES, strict=True):
        publisher.send(value)
    stage.until(lambda: len(got) == len(VALUES))
    for index, value in enumerate(VALUES):
        assert type(got[index]) is type(value)
        assert _fields(got[index]) == _fields(value)


def check_each_counts_in_order_where_every_one_counts(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("every", int, Quality.EVERY)
    stage.other.subscribe("every", int, got.append, Quality.EVERY)
    stage.begin()
    stage.until(lambda: publisher.listeners() == 1)
    for number in range(50):
        publisher.send(number)
    stage.until(lambda: len(got) == 50)
    assert got == list(range(50))


def check_none_is_lost_where_sending_waits(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("lossless", int, Quality.LOSSLESS)
    stage.other.subscribe("lossless", int, got.append, Quality.LOSSLESS)
    stage.begin()
    stage.until(lambda: publisher.listeners() == 1)
    for number in range(500):
        publisher.send(number)
    stage.until(lambda: len(got) == 500)
    assert got == list(range(500))


def check_newest_replaces_those_that_wait(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("newest", int)
    stage.other.subscribe("newest", int, got.append)
    stage.begin()
    stage.until(lambda: publisher.listeners() == 1)
    for number in range(1000):  # no callback comes between them
        publisher.send(number)
    stage.until(lambda: 999 in got)
    assert got == sorted(got)
    assert len(got) < 1000


def check_latched_topic_gives_its_last_value_to_who_comes_later(stage: Stage) -> None:
    got: list[tuple[str, Sender | None]] = []
    publisher = stage.one.publish("kept", str, Quality.LATCHED)
    publisher.send("old")
    publisher.send("new")
    stage.other.subscribe_from("kept", str, lambda value, sender: got.append((value, sender)))
    stage.begin()
    stage.until(lambda: bool(got))
    assert [value for value, _ in got] == ["new"]
    sender = got[0][1]
    assert sender is not None
    assert sender.name == stage.one.name


def check_who_begins_to_listen_is_greeted(stage: Stage) -> None:
    got: list[float] = []
    stage.one.publish("greeted", float, greet=lambda: 0.5)
    stage.other.subscribe("greeted", float, got.append)
    stage.begin()
    stage.until(lambda: bool(got))
    assert set(got) == {0.5}


def check_closed_subscription_hears_nothing(stage: Stage) -> None:
    got: list[int] = []
    publisher = stage.one.publish("closed", int, Quality.EVERY)
    heard: list[int] = []
    closed = stage.other.subscribe("closed", int, heard.append, Quality.EVERY)
    closed.close()
    stage.other.subscribe("closed", int, got.append, Quality.EVERY)
    stage.begin()
    stage.until(lambda: publisher.listeners() == 1)
    publisher.send(3)
    stage.until(lambda: got == [3])
    assert heard == []


def check_service_answers_with_result_and_text(stage: Stage) -> None:
    got: list[Result] = []
    stage.other.serve("light", Switch, lambda request: Result(request.on, "on" if request.on else "there is no light"))
    stage.begin()
    stage.one.call("light", Switch(on=True), got.append)
    stage.until(lambda: len(got) == 1)
    stage.one.call("light", Switch(on=False), got.append)
    stage.until(lambda: len(got) == 2)
    assert got == [Result(True, "on"), Result(False, "there is no light")]


def check_each_request_arrives_as_it_was_made(stage: Stage) -> None:
    placed = values.PlacedPose(STAMP, "map", Pose2(1.0, 2.0, 0.5))
    path = values.Path(STAMP, "map", _POSES)
    map_of = values.Map(STAMP, "map", _GRID)
    asked: tuple[tuple[object, object], ...] = (
        (Trigger(), None),
        (Silent(), None),
        (AskMap(), map_of),
        (UseMap(map_of, STAMP, "map", Pose2(0.5, 0.25, 0.125), np.arange(9.0).reshape(3, 3)), None),
        (Place("box", "map", Pose2(1.0, 2.0, 0.5)), None),
        (AskPath(placed, placed, 0.25), path),
    )
    requests: list[object] = []
    results: list[Result] = []

    def answer(value: object, request: object) -> Result:
        requests.append(request)
        return Result(success=True, value=value)

    for request, value in asked:
        kind: type[Any] = type(request)
        stage.other.serve(f"ask_{kind.__name__}", kind, partial(answer, value))
    stage.begin()
    for number, (request, value) in enumerate(asked, 1):
        stage.one.call(f"ask_{type(request).__name__}", request, results.append)
        stage.until(lambda count=number: len(results) == count)  # type: ignore[misc]  # mypy infers no default
        assert results[-1].success, results[-1].text
        assert _fields(requests[-1]) == _fields(request)
        assert _fields(results[-1].value) == _fields(value)


def check_failure_of_a_silent_service_reaches_its_client(stage: Stage) -> None:
    got: list[Result] = []
    stage.other.serve("scatter", Silent, lambda _request: Result(False, "there is no map"))
    stage.begin()
    stage.one.call("scatter", Silent(), got.append)
    stage.until(lambda: bool(got))
    assert not got[0].success
    assert "there is no map" in got[0].text


def check_goal_is_accepted_reported_and_succeeds(stage: Stage) -> None:
    takers = Takers()
    server = stage.other.serve_goals("drive", takers)
    stage.begin()
    client = stage.client("drive")
    id = client.send(_TARGET)
    stage.until(lambda: bool(takers.got))
    handle = takers.got[0]
    assert handle.goal.id == id
    assert handle.goal.target.frame == "map"
    assert handle.goal.target.pose == pytest.approx(_TARGET.pose)
    handle.accept()
    handle.note("on my way")
    server.publish_status()
    stage.until(lambda: client.state(id) == ("active", "on my way"))
    handle.report(_TARGET)
    stage.until(lambda: client.report() is not None)
    assert client.report() == _TARGET
    handle.succeed("there")
    stage.until(lambda: client.state(id) == ("succeeded", "there"))


def check_goal_is_refused_aborted_or_cancelled_with_a_text(stage: Stage) -> None:
    takers = Takers()
    stage.other.serve_goals("drive_ends", takers)
    stage.begin()
    client = stage.client("drive_ends")
    ids = [client.send(_TARGET) for _ in range(3)]
    stage.until(lambda: len(takers.got) == 3)
    refused, aborted, cancelled = takers.got
    refused.refuse("not now")
    aborted.accept()
    aborted.abort("no way")
    cancelled.accept()
    cancelled.cancel("replaced")
    ends = [("aborted", "not now"), ("aborted", "no way"), ("cancelled", "replaced")]
    stage.until(lambda: [client.state(id) for id in ids] == ends)


def check_goals_are_cancelled_by_id_by_time_and_all(stage: Stage) -> None:
    takers = Takers()
    stage.other.serve_goals("drive_cancel", takers)
    stage.begin()
    client = stage.client("drive_cancel")
    ids = []
    for _ in range(5):
        ids.append(client.send(_TARGET))
        stage.until(lambda: len(takers.got) == len(ids))
        takers.got[-1].accept()
    takers.got[0].succeed("before anybody cancels")
    for cancel, count in (
        (partial(client.cancel, ids[2]), 1),
        (partial(client.cancel_sent_before, ids[3]), 3),
        (partial(client.cancel, ""), 4),
    ):
        cancel()
        stage.until(partial(takers.has_cancelled, count))
    assert takers.cancelled == [ids[2], ids[1], ids[3], ids[4]]
    stage.until(lambda: client.state(ids[4]) == ("cancelled", "as you wish"))


def check_follower_sends_goals_and_hears_of_those_of_others(stage: Stage) -> None:
    takers, follower = Takers(), Follower()
    stage.other.serve_goals("drive_on", takers)
    goals = stage.one.follow_goals("drive_on", follower)
    stage.begin()
    others = stage.client("drive_on")
    stage.until(lambda: goals.servers() == 1)
    goals.send(Goal("mine", _TARGET))
    theirs = others.send(_TARGET)
    stage.until(lambda: len(takers.got) == 2)
    for handle in takers.got:
        handle.accept()
    stage.until(lambda: follower.open == {"mine", theirs})
    goals.cancel("mine")
    stage.until(lambda: GoalState("mine", "cancelled", "as you wish") in follower.ends)
    next(each for each in takers.got if each.goal.id == theirs).succeed("there")
    stage.until(lambda: GoalState(theirs, "succeeded", "there") in follower.ends)
    assert len(follower.ends) == 2


def check_target_that_is_no_pose_arrives_as_nan(stage: Stage) -> None:
    takers = Takers()
    stage.other.serve_goals("drive_nan", takers)
    stage.begin()
    client = stage.client("drive_nan")
    client.send(values.PlacedPose(STAMP, "map", Pose2(math.nan, 0.0, 0.0)))
    stage.until(lambda: bool(takers.got))
    assert math.isnan(takers.got[0].goal.target.pose.x)


def check_missing_service_is_a_result(stage: Stage) -> None:
    got: list[Result] = []
    stage.begin()
    stage.one.call("nobody/serves_this", Trigger(), got.append, 0.3)
    stage.until(lambda: bool(got))
    assert not got[0].success
    assert "nobody/serves_this" in got[0].text


def check_callbacks_of_a_node_share_one_thread(stage: Stage) -> None:
    threads: set[int] = set()
    done: list[object] = []

    def note(value: object) -> None:
        threads.add(threading.get_ident())
        done.append(value)

    def answer(_request: Trigger) -> Result:
        note("service")
        return Result(success=True)

    publisher = stage.one.publish("threads", str, Quality.LATCHED)
    stage.one.subscribe("threads", str, note)
    stage.one.serve("threads", Trigger, answer)
    stage.begin()
    timer = stage.one.every(0.01, lambda: note("beat") if "beat" not in done else None)
    stage.one.work(lambda: "job", note)
    stage.one.call("threads", Trigger(), lambda _result: note("result"))
    publisher.send("value")
    stage.until(lambda: {"service", "beat", "job", "result", "value"} <= set(done))
    timer.cancel()
    assert len(threads) == 1


def check_beats_repeat_until_they_are_cancelled(stage: Stage) -> None:
    beats: list[int] = []
    others: list[int] = []
    timer = stage.one.every(0.01, lambda: beats.append(stage.one.now()))
    stage.begin()
    stage.until(lambda: len(beats) >= 5)
    timer.cancel()
    stage.one.every(0.01, lambda: others.append(0))
    stage.until(lambda: len(others) >= 2)
    count = len(beats)
    stage.until(lambda: len(others) >= 6)
    assert len(beats) <= count + 1
    assert beats == sorted(beats)


def check_later_call_comes_once_unless_it_is_cancelled(stage: Stage) -> None:
    calls: list[str] = []
    stage.one.after(0.01, lambda: calls.append("once"))
    stage.one.after(0.01, lambda: calls.append("steady"), steady=True)
    stage.one.after(0.01, lambda: calls.append("cancelled")).cancel()
    stage.begin()
    stage.one.after(0.05, lambda: calls.append("last"))
    stage.until(lambda: "last" in calls)
    assert calls == ["once", "steady", "last"]


def check_answer_may_come_later(stage: Stage) -> None:
    got: list[Result] = []
    stage.other.serve_later(
        "slow", Trigger, lambda _request, give: stage.other.work(lambda: Result(True, "done"), give, "writes")
    )
    stage.other.serve_later("never", Trigger, lambda _request, _give: None)
    stage.begin()
    stage.one.call("never", Trigger(), got.append, 0.3)
    stage.one.call("slow", Trigger(), got.append)
    stage.until(lambda: len(got) == 2)
    assert got[0] == Result(True, "done")
    assert not got[1].success
    assert "never" in got[1].text


def check_jobs_of_the_end_are_done(stage: Stage) -> None:
    if stage.one is stage.other:
        return  # the test's own process would end with it
    done: list[str] = []
    node = stage.one
    node.on_end(lambda: node.work(lambda: "drawn", lambda word: node.work(lambda: f"{word}, written", done.append)))
    stage.begin()
    node.end("the test is over")
    stage.until(lambda: done == ["drawn, written"])


def check_calls_without_delay_let_others_in(stage: Stage) -> None:
    got: list[Result] = []

    def again() -> None:
        if not got:
            stage.one.after(0.0, again, steady=True)

    stage.other.serve("between", Trigger, lambda _request: Result(True, "done"))
    stage.one.after(0.0, again, steady=True)
    stage.begin()
    stage.one.call("between", Trigger(), got.append)
    stage.until(lambda: bool(got))
    assert got == [Result(True, "done")]


def check_parameters_are_typed_and_kept(stage: Stage) -> None:
    own = stage.one.parameters
    assert own.number("speed", 0.5) == 0.5
    own.keep("speed", 0.75)
    own.keep("deep/er", 3)
    assert own.number("speed", 0.5) == 0.75
    assert own.below("deep").integer("er") == 3
    assert own.has("deep")
    assert own.any("deep") == {"er": 3}
    own.keep("word", "fast")
    with pytest.raises(UserError, match="expected a number"):
        own.number("word")
    with pytest.raises(UserError, match="is not set"):
        own.text("absent")


def check_facts_are_known_to_all_nodes(stage: Stage) -> None:
    assert stage.one.facts.get("contract_fact", 1) == 1
    stage.one.facts.set("contract_fact", "known")
    assert stage.other.facts.get("contract_fact") == "known"


def check_transforms_reach_other_nodes(stage: Stage) -> None:
    tree = stage.other.transforms
    mount = Pose3(0.25, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0)
    moved = Pose3(1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    stage.one.transforms.send(Transform(STAMP, "base", "laser", mount, fixed=True))
    stage.one.transforms.send(Transform(STAMP, "base", "imu", mount, fixed=True))
    stage.begin()
    stamp = iter(range(STAMP, STAMP + 10**12, 10**7))
    stage.one.every(0.02, lambda: stage.one.transforms.send(Transform(next(stamp), "odom", "base", moved)))
    stage.until(lambda: None not in (tree.find("odom", "laser"), tree.find("odom", "imu")))
    found = tree.find("odom", "laser")
    assert found == moved.compose(mount)


def check_what_is_sent_at_the_end_still_leaves(stage: Stage) -> None:
    if stage.one is stage.other:
        return  # the listener would end with it
    got: list[Twist] = []
    publisher = stage.one.publish("last", Twist, Quality.COMMAND)
    stage.other.subscribe("last", Twist, got.append)
    stage.one.on_end(lambda: publisher.send(Twist(0.0, 0.0)))
    stage.begin()
    stage.one.end("the test is over")
    stage.until(lambda: got == [Twist(0.0, 0.0)])


def check_messages_without_a_kind_must_be_known(stage: Stage) -> None:
    with pytest.raises(LookupError):
        stage.one.subscribe_fields("foreign", "no_such_package/Sensor", ("name",), print)


def check_nodes_are_located(stage: Stage) -> None:
    place = stage.one.locate(stage.other.name)
    assert place is not None
    assert place.here
    assert stage.one.locate("/no/such/node") is None


def check_names_are_resolved(stage: Stage) -> None:
    assert stage.one.resolve("scan") == "/scan"
    assert stage.one.resolve("/tf") == "/tf"
    assert stage.one.resolve("~goal") == f"{stage.one.name}/goal"


CHECKS: dict[str, Callable[[Stage], None]] = {
    name.removeprefix("check_"): check for name, check in list(globals().items()) if name.startswith("check_")
}


def _fields(value: object) -> object:
    """A value in a form that compares: arrays as lists, NaN as a word."""
    if isinstance(value, np.ndarray):
        return [("nan" if each != each else each) for each in value.ravel().tolist()], value.shape
    if isinstance(value, float) and value != value:
        return "nan"
    if isinstance(value, tuple) and any(hasattr(type(each), "__dataclass_fields__") for each in value):
        return tuple(map(_fields, value))
    names = getattr(type(value), "__dataclass_fields__", None)
    if names is None or isinstance(value, Grid):
        return (_fields(value.values), value.resolution, value.origin) if isinstance(value, Grid) else value
    left_out = {"angle_max"} if getattr(value, "angle_max", 0) is None else set()
    both = {"angle_max"} | left_out  # a driver's own figure; from the others where it gave none
    return {name: _fields(getattr(value, name)) for name in names if name not in both}


class ActionlibClient:
    """See GoalClient."""

    def __init__(self, action: str) -> None:
        import actionlib
        import rospy
        from move_base_msgs.msg import MoveBaseAction

        self._client = actionlib.ActionClient(action, MoveBaseAction)
        self._goals: dict[str, Any] = {}
        self._heard: values.PlacedPose | None = None
        assert self._client.wait_for_server(rospy.Duration(60.0))

    def send(self, target: values.PlacedPose) -> str:
        from move_base_msgs.msg import MoveBaseGoal

        from ur_nodes.ros1.codecs.places import fill_placed

        goal = MoveBaseGoal()
        fill_placed(goal.target_pose, target)
        handle = self._client.send_goal(goal, feedback_cb=self._take_feedback)
        id = handle.comm_state_machine.action_goal.goal_id.id
        self._goals[id] = handle
        return str(id)

    def cancel(self, id: str) -> None:
        if id:
            self._goals[id].cancel()
        else:
            self._client.cancel_all_goals()

    def cancel_sent_before(self, id: str) -> None:
        self._client.cancel_goals_at_and_before_time(self._goals[id].comm_state_machine.action_goal.goal_id.stamp)

    def state(self, id: str) -> tuple[str, str]:
        handle = self._goals[id]
        return _STATES[handle.get_goal_status()], handle.get_goal_status_text()

    def report(self) -> values.PlacedPose | None:
        return self._heard

    def _take_feedback(self, _handle: Any, feedback: Any) -> None:
        from ur_nodes.ros1.codecs.places import placed_of

        self._heard = placed_of(feedback.base_position)


class RosStage:
    """One node of ROS 1, for both ends."""

    def __init__(self) -> None:
        from ur_nodes.ros1.node import RosNode

        self._node = RosNode()
        self.one: Node = self._node
        self.other: Node = self._node

    def begin(self) -> None:
        self._node.begin()

    def until(self, condition: Callable[[], bool]) -> None:
        end = time.monotonic() + 60.0
        while not condition():
            assert time.monotonic() < end, "waited for 60 s"
            time.sleep(0.005)

    def client(self, action: str) -> GoalClient:
        return ActionlibClient(action)


def main(names: list[str]) -> None:
    import rospy

    rospy.init_node("contract")
    failures: dict[str, str] = {}
    for name in names:
        if problem := _failure(CHECKS[name]):
            failures[name] = problem
    sys.stdout.write(json.dumps(failures) + "\n")
    sys.stdout.flush()
    rospy.signal_shutdown("done")


def _failure(check: Callable[[Stage], None]) -> str:
    try:
        check(RosStage())
    except Exception:
        return traceback.format_exc()
    return ""


if __name__ == "__main__":
    main(sys.argv[1:])
