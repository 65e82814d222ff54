"""A client of Nav2's actions as programs of others are, of rclpy alone. Prints what became of its goals as JSON."""

from __future__ import annotations

import json
import sys
from typing import Any

import rclpy
from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from geometry_msgs.msg import PoseStamped
from lifecycle_msgs.srv import GetState
from nav2_msgs.action import NavigateThroughPoses, NavigateToPose
from rclpy.action import ActionClient
from rclpy.qos import qos_profile_action_status_default

PATIENCE = 20.0  # s


class ActionClientStage:
    def __init__(self) -> None:
        rclpy.init()
        self.node = rclpy.create_node("stranger")
        self.to_pose = ActionClient(self.node, NavigateToPose, "navigate_to_pose")
        self.through = ActionClient(self.node, NavigateThroughPoses, "navigate_through_poses")
        self.feedback: list[Any] = []
        self.statuses: dict[bytes, int] = {}
        self.node.create_subscription(
            GoalStatusArray, "navigate_to_pose/_action/status", self._take_status, qos_profile_action_status_default
        )
        assert self.to_pose.wait_for_server(PATIENCE)

    def wait(self, future: Any) -> Any:
        rclpy.spin_until_future_complete(self.node, future, timeout_sec=PATIENCE)
        assert future.done(), "no answer"
        return future.result()

    def send(self, *xs: float) -> Any:
        """Send a goal at x, or through several; returns its handle."""
        self.feedback.clear()
        poses = [PoseStamped() for _ in xs]
        for pose, x in zip(poses, xs, strict=True):
            pose.header.frame_id, pose.pose.position.x = "map", x
        client = self.to_pose if len(xs) == 1 else self.through
        goal = NavigateToPose.Goal(pose=poses[0]) if len(xs) == 1 else NavigateThroughPoses.Goal()
        if len(xs) > 1:
            goal.poses.goals = poses  # type: ignore[union-attr]  # a list in Jazzy
        handle = self.wait(client.send_goal_async(goal, lambda message: self.feedback.append(message.feedback)))
        assert handle.accepted
        return handle

    def end(self, handle: Any) -> list[object]:
        """How a goal has ended: its status, error code and text."""
        answer = self.wait(handle.get_result_async())
        return [answer.status, answer.result.error_code, answer.result.error_msg]

    def until_feedback(self) -> None:
        while not self.feedback:
            rclpy.spin_once(self.node, timeout_sec=PATIENCE)

    def _take_status(self, message: GoalStatusArray) -> None:
        self.statuses = {bytes(each.goal_info.goal_id.uuid): each.status for each in message.status_list}


def run_all(client: ActionClientStage) -> dict[str, object]:
    assert client.through.wait_for_server(PATIENCE)
    found: dict[str, object] = {}
    found["reached"] = client.end(client.send(3.0))
    found["feedback"] = [[each.current_pose.pose.position.x, each.distance_remaining] for each in client.feedback]
    found["refused"] = client.end(client.send(-20.0))
    found["given up"] = client.end(client.send(-6.0))
    handle = client.send(9.0)
    client.until_feedback()
    found["cancels"] = len(client.wait(handle.cancel_goal_async()).goals_canceling)
    found["cancelled"] = client.end(handle)
    first = client.send(9.0)
    client.until_feedback()
    second = client.send(1.0)
    found["replaced"], found["replacing"] = client.end(first), client.end(second)
    found["through"] = client.end(client.send(1.0, 2.0, 3.0))
    found["poses left"] = sorted({each.number_of_poses_remaining for each in client.feedback}, reverse=True)
    handle = client.send(1.0, 9.0)
    while not client.feedback or client.feedback[-1].number_of_poses_remaining != 1:
        rclpy.spin_once(client.node, timeout_sec=PATIENCE)
    client.wait(handle.cancel_goal_async())
    found["through, cancelled"] = client.end(handle)
    empty = client.wait(client.through.send_goal_async(NavigateThroughPoses.Goal()))
    found["no poses"] = client.end(empty)
    state = client.node.create_client(GetState, "bt_navigator/get_state")
    found["state"] = (
        state.wait_for_service(1.0) and client.wait(state.call_async(GetState.Request())).current_state.label
    )
    return found


def drive(client: ActionClientStage, x: float, y: float) -> dict[str, object]:
    """Drive a whole robot to a place."""
    goal = NavigateToPose.Goal(pose=PoseStamped())
    goal.pose.header.frame_id, goal.pose.pose.position.x, goal.pose.pose.position.y = "map", x, y
    accepted = client.to_pose.send_goal_async(goal, lambda each: client.feedback.append(each.feedback))
    rclpy.spin_until_future_complete(client.node, accepted, timeout_sec=PATIENCE)
    if (handle := accepted.result()) is None:  # the server had not found this client when it answered
        return {"status": None}
    answer = handle.get_result_async()
    rclpy.spin_until_future_complete(client.node, answer, timeout_sec=60.0)
    found = {"status": answer.result().status, "text": answer.result().result.error_msg}
    if client.feedback:
        here = client.feedback[-1].current_pose.pose.position
        found["place"] = [here.x, here.y]
    return found


def cancel_others(client: ActionClientStage) -> dict[str, object]:
    """Cancel the goal of a client that has died."""
    while not client.statuses:
        rclpy.spin_once(client.node, timeout_sec=PATIENCE)
    before = sorted(client.statuses.values())
    cancel = client.node.create_client(CancelGoal, "navigate_to_pose/_action/cancel_goal")
    assert cancel.wait_for_service(PATIENCE)
    count = len(client.wait(cancel.call_async(CancelGoal.Request())).goals_canceling)
    while 5 not in client.statuses.values():
        rclpy.spin_once(client.node, timeout_sec=PATIENCE)
    return {"before": before, "cancels": count, "after": sorted(client.statuses.values())}


if __name__ == "__main__":
    peer = ActionClientStage()
    if sys.argv[1] == "leave":  # and be killed
        peer.send(9.0)
        peer.until_feedback()
        sys.stdout.write("driving\n")
        sys.stdout.flush()
        rclpy.spin(peer.node)
    if sys.argv[1] == "drive":
        made = drive(peer, *map(float, sys.argv[2:4]))
    else:
        made = run_all(peer) if sys.argv[1] == "all" else cancel_others(peer)
    sys.stdout.write(json.dumps(made) + "\n")
    sys.stdout.flush()
