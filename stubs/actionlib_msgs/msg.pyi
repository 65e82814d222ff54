"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy
import std_msgs.msg

class GoalID(genpy.Message):
    stamp: genpy.Time
    id: str
    def __init__(self, stamp: genpy.Time = ..., id: str = ...) -> None: ...

class GoalStatus(genpy.Message):
    PENDING: int
    ACTIVE: int
    PREEMPTED: int
    SUCCEEDED: int
    ABORTED: int
    REJECTED: int
    PREEMPTING: int
    RECALLING: int
    RECALLED: int
    LOST: int
    goal_id: GoalID
    status: int
    text: str
    def __init__(self, goal_id: GoalID = ..., status: int = ..., text: str = ...) -> None: ...

class GoalStatusArray(genpy.Message):
    header: std_msgs.msg.Header
    status_list: list[GoalStatus]
    def __init__(self, header: std_msgs.msg.Header = ..., status_list: list[GoalStatus] = ...) -> None: ...
