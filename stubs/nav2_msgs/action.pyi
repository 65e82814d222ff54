"""The fields of Nav2's actions that this project uses; Jazzy has no `error_msg`, and `poses` is a list there."""

import genpy
import unique_identifier_msgs.msg
from geometry_msgs.msg import PoseStamped

class _Goals(genpy.Message):
    goals: list[PoseStamped]

class NavigateToPose:
    class Goal(genpy.Message):
        pose: PoseStamped
        poses: list[PoseStamped] | _Goals
        def __init__(self, *, pose: PoseStamped = ...) -> None: ...

    class Result(genpy.Message):
        error_code: int
        error_msg: str
        def __init__(self, *, error_code: int = ..., error_msg: str = ...) -> None: ...

    class Feedback(genpy.Message):
        current_pose: PoseStamped
        navigation_time: genpy.Duration
        estimated_time_remaining: genpy.Duration
        number_of_recoveries: int
        distance_remaining: float
        number_of_poses_remaining: int
        def __init__(self, *, number_of_recoveries: int = ...) -> None: ...

    class Impl:
        class SendGoalService:
            class Request(genpy.Message):
                goal_id: unique_identifier_msgs.msg.UUID
                goal: NavigateToPose.Goal

        class GetResultService:
            class Request(genpy.Message):
                goal_id: unique_identifier_msgs.msg.UUID

        class FeedbackMessage(genpy.Message):
            goal_id: unique_identifier_msgs.msg.UUID
            feedback: NavigateToPose.Feedback

class NavigateThroughPoses(NavigateToPose): ...
