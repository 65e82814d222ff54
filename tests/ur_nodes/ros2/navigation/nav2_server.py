"""A stand-in for Nav2, of rclpy alone: `navigate_to_pose` as bt_navigator offers it.

It arrives at goals ahead, with recoveries on the way; it gives up goals behind the robot, refuses those behind x = -10,
and takes its time with goals beyond x = 5. A new goal replaces the old one, which ends as aborted. A
recorder beside it reads what clients send to servers of this project, which there are none.
"""

from __future__ import annotations

from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import Path
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from std_msgs.msg import String

_BEAT = 0.05  # s
_NO_PATH = 208  # of ComputePathToPose


class Nav2:
    def __init__(self) -> None:
        rclpy.init()
        self.node = rclpy.create_node("bt_navigator")
        self._newest: Any = None
        self._plans = self.node.create_publisher(Path, "plan", 10)
        for name in ("goal", "cancel"):
            self.node.create_subscription(String, f"navigate_to_pose/{name}", lambda _: None, 10)
        self._server = ActionServer(
            self.node,
            NavigateToPose,
            "navigate_to_pose",
            self._drive,
            callback_group=ReentrantCallbackGroup(),
            goal_callback=lambda goal: (
                GoalResponse.REJECT if goal.pose.pose.position.x < -10.0 else GoalResponse.ACCEPT
            ),
            cancel_callback=lambda _handle: CancelResponse.ACCEPT,
        )

    async def _drive(self, handle: Any) -> Any:
        self._newest = handle
        aim = handle.request.pose
        path = Path(header=aim.header, poses=[PoseStamped(header=aim.header), aim])
        for beats in range(1, 1000):
            await self._sleep()
            if handle.is_cancel_requested:
                handle.canceled()
                return NavigateToPose.Result()
            if self._newest is not handle:
                handle.abort()
                return NavigateToPose.Result()
            self._plans.publish(path)
            feedback = NavigateToPose.Feedback(number_of_recoveries=min(2, beats // 3))
            handle.publish_feedback(feedback)
            if beats == 8 and aim.pose.position.x < 0.0:
                handle.abort()
                return NavigateToPose.Result(error_code=_NO_PATH, error_msg="tried 3 times")
            if beats == 8 and aim.pose.position.x <= 5.0:
                handle.succeed()
                return NavigateToPose.Result()
        raise AssertionError("the test lasts too long")

    async def _sleep(self) -> None:
        done = rclpy.Future()
        timer = self.node.create_timer(_BEAT, lambda: done.set_result(None))
        await done
        self.node.destroy_timer(timer)


if __name__ == "__main__":
    rclpy.spin(Nav2().node)
