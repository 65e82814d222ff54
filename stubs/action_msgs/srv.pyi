"""Made by tools/make_message_stubs.py. Do not edit."""

from typing import ClassVar, TypeAlias
import genpy
import action_msgs.msg

class CancelGoalRequest(genpy.Message):
    goal_info: action_msgs.msg.GoalInfo
    def __init__(self, goal_info: action_msgs.msg.GoalInfo = ...) -> None: ...

class CancelGoalResponse(genpy.Message):
    ERROR_NONE: int
    ERROR_REJECTED: int
    ERROR_UNKNOWN_GOAL_ID: int
    ERROR_GOAL_TERMINATED: int
    return_code: int
    goals_canceling: list[action_msgs.msg.GoalInfo]
    def __init__(self, return_code: int = ..., goals_canceling: list[action_msgs.msg.GoalInfo] = ...) -> None: ...

class CancelGoal:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[CancelGoalRequest]]
    _response_class: ClassVar[type[CancelGoalResponse]]
    Request: TypeAlias = CancelGoalRequest  # of ROS 2, as is the next
    Response: TypeAlias = CancelGoalResponse
