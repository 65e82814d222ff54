"""Checks of goals and of those who follow them."""

import math
from functools import partial

import pytest
from tests.ur_nodes.ports.stage import STAMP, TARGET, Follower, Stage, Takers

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.actions import Goal, GoalState
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedPose


def check_goal_is_accepted_reported_and_succeeds(stage: Stage) -> None:
    handlers = Takers()
    server = stage.other.serve_goals("drive", handlers)
    stage.begin()
    client = stage.client("drive")
    id = client.send(TARGET)
    stage.until(lambda: bool(handlers.got))
    handle = handlers.got[0]
    assert handle.goal.id == id
    assert handle.goal.target.frame == "map"
    assert handle.goal.target.pose == pytest.approx(TARGET.pose)
    handle.accept()
    handle.note("on my way")
    server.publish_status()
    stage.until(lambda: client.state(id) == ("active", "on my way"))
    handle.report(TARGET)
    stage.until(lambda: client.report() is not None)
    assert client.report() == TARGET
    handle.succeed("there")
    stage.until(lambda: client.state(id) == ("succeeded", "there"))


def check_pose_alone_is_a_goal(stage: Stage) -> None:
    handlers = Takers()
    stage.other.serve_goals("drive_pose", handlers)
    poses = stage.one.publish("drive_pose_simple/goal", StampedPose, Quality.EVERY)
    stage.begin()
    stage.until(lambda: poses.subscribers() > 0)
    poses.send(TARGET)
    poses.send(TARGET)
    stage.until(lambda: len(handlers.got) == 2)
    goals = [handle.goal for handle in handlers.got]
    assert goals[0].target.pose == pytest.approx(TARGET.pose)
    assert goals[0].id != goals[1].id


def check_goal_is_refused_aborted_or_cancelled_with_a_text(stage: Stage) -> None:
    handlers = Takers()
    stage.other.serve_goals("drive_ends", handlers)
    stage.begin()
    client = stage.client("drive_ends")
    ids = [client.send(TARGET) for _ in range(3)]
    stage.until(lambda: len(handlers.got) == 3)
    refused, aborted, cancelled = handlers.got
    refused.refuse("not now")
    aborted.accept()
    aborted.abort("no way")
    cancelled.accept()
    cancelled.cancel("replaced")
    ends = [("aborted", "not now"), ("aborted", "no way"), ("cancelled", "replaced")]
    stage.until(lambda: [client.state(id) for id in ids] == ends)


def check_goals_are_cancelled_by_id_by_time_and_all(stage: Stage) -> None:
    handlers = Takers()
    stage.other.serve_goals("drive_cancel", handlers)
    stage.begin()
    client = stage.client("drive_cancel")
    ids = []
    for _ in range(5):
        ids.append(client.send(TARGET))
        stage.until(lambda: len(handlers.got) == len(ids))
        handlers.got[-1].accept()
    handlers.got[0].succeed("before anybody cancels")
    for cancel, count in (
        (partial(client.cancel, ids[2]), 1),
        (partial(client.cancel_sent_before, ids[3]), 3),
        (partial(client.cancel, ""), 4),
    ):
        cancel()
        stage.until(partial(handlers.has_cancelled, count))
    assert handlers.cancelled == [ids[2], ids[1], ids[3], ids[4]]
    stage.until(lambda: client.state(ids[4]) == ("cancelled", "as you wish"))


def check_follower_sends_goals_and_hears_of_those_of_others(stage: Stage) -> None:
    handlers, follower = Takers(), Follower()
    stage.other.serve_goals("drive_on", handlers)
    goals = stage.one.follow_goals("drive_on", follower)
    stage.begin()
    others = stage.client("drive_on")
    stage.until(lambda: goals.servers() == 1)
    goals.send(Goal("mine", TARGET))
    theirs = others.send(TARGET)
    stage.until(lambda: len(handlers.got) == 2)
    for handle in handlers.got:
        handle.accept()
    stage.until(lambda: follower.open == {"mine", theirs})
    goals.cancel("mine")
    stage.until(lambda: GoalState("mine", "cancelled", "as you wish") in follower.ends)
    next(each for each in handlers.got if each.goal.id == theirs).succeed("there")
    stage.until(lambda: GoalState(theirs, "succeeded", "there") in follower.ends)
    assert len(follower.ends) == 2


def check_target_that_is_no_pose_arrives_as_nan(stage: Stage) -> None:
    handlers = Takers()
    stage.other.serve_goals("drive_nan", handlers)
    stage.begin()
    client = stage.client("drive_nan")
    client.send(StampedPose(STAMP, "map", Pose2(math.nan, 0.0, 0.0)))
    stage.until(lambda: bool(handlers.got))
    assert math.isnan(handlers.got[0].goal.target.pose.x)
