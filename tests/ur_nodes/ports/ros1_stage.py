"""The contract on ROS 1: ros1_stage.py NAME ... makes checks, and prints their failures by name as a line of JSON."""

from __future__ import annotations

import json
import sys
import time
import traceback
from collections.abc import Callable
from typing import Any

import numpy as np
from tests.ur_nodes.ports.contract import CHECKS
from tests.ur_nodes.ports.stage import Described, GoalClient, Stage

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, StampedPose

_STATES = {0: "pending", 1: "active", 2: "cancelled", 3: "succeeded", 4: "aborted", 6: "active", 8: "cancelled"}
"""actionlib_msgs/GoalStatus as `ports.actions.GoalState`."""


class ActionlibClient:
    """See GoalClient."""

    def __init__(self, action: str) -> None:
        import actionlib
        import rospy
        from move_base_msgs.msg import MoveBaseAction

        self._client = actionlib.ActionClient(action, MoveBaseAction)
        self._goals: dict[str, Any] = {}
        self._heard: StampedPose | None = None
        assert self._client.wait_for_server(rospy.Duration(60.0))

    def send(self, target: StampedPose) -> str:
        from move_base_msgs.msg import MoveBaseGoal

        from ur_nodes.codecs.poses import fill_stamped

        goal = MoveBaseGoal()
        fill_stamped(goal.target_pose, target)
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

    def report(self) -> StampedPose | None:
        return self._heard

    def _take_feedback(self, _handle: Any, feedback: Any) -> None:
        from ur_nodes.codecs.poses import stamped_of

        self._heard = stamped_of(feedback.base_position)


class Ros1Stage:
    """One node of ROS 1, for both ends."""

    raw_senders_unknown = False
    moments_known = False
    silent_services_hide_failures = False
    keeps_for_all = True
    only_live_parameters = True
    string_type = "std_msgs/String"
    wire = b"\x05\x00\x00\x00hello"

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

    def spoil(self, topic: str) -> None:
        publisher = self.one.publish(topic, Map, Quality.LATCHED)
        publisher.send(Map(0, "map", Grid(np.zeros((1, 1), np.int8), 0.0, Pose2(0.0, 0.0, 0.0))))

    def set_parameter(self, name: str, value: object) -> str:
        import rospy
        from dynamic_reconfigure import encoding
        from dynamic_reconfigure.srv import Reconfigure

        folder, _, last = self.one.resolve(f"~{name}").rpartition("/")
        try:
            answer = rospy.ServiceProxy(f"{folder}/set_parameters", Reconfigure)(encoding.encode_config({last: value}))
        except rospy.ServiceException as problem:
            return str(problem)
        assert encoding.decode_config(answer.config)[last] == value
        return ""

    def describe(self, name: str) -> Described:
        import rospy
        from dynamic_reconfigure import encoding
        from dynamic_reconfigure.msg import ConfigDescription

        folder, _, last = self.one.resolve(f"~{name}").rpartition("/")
        message = rospy.wait_for_message(f"{folder}/parameter_descriptions", ConfigDescription, 60.0)
        found = encoding.decode_description(message)
        parameter = next(each for each in found["parameters"] if each["name"] == last)
        return Described(parameter["description"], parameter["min"], parameter["max"], read_only=False)

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
        check(Ros1Stage())
    except Exception:
        return traceback.format_exc()
    return ""


if __name__ == "__main__":
    main(sys.argv[1:])
