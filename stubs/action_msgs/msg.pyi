"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy
import unique_identifier_msgs.msg

class GoalInfo(genpy.Message):
    goal_id: unique_identifier_msgs.msg.UUID
    stamp: genpy.Time
    def __init__(self, goal_id: unique_identifier_msgs.msg.UUID = ..., stamp: genpy.Time = ...) -> None: ...

class GoalStatus(genpy.Message):
    STATUS_UNKNOWN: int
    STATUS_ACCEPTED: int
    STATUS_EXECUTING: int
    STATUS_CANCELING: int
    STATUS_SUCCEEDED: int
    STATUS_CANCELED: int
    STATUS_ABORTED: int
    goal_info: GoalInfo
    status: int
    def __init__(self, goal_info: GoalInfo = ..., status: int = ...) -> None: ...

class GoalStatusArray(genpy.Message):
    status_list: list[GoalStatus]
    def __init__(self, status_list: list[GoalStatus] = ...) -> None: ...
