"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy
import actionlib_msgs.msg
import geometry_msgs.msg
import std_msgs.msg

class MoveBaseAction(genpy.Message):
    action_goal: MoveBaseActionGoal
    action_result: MoveBaseActionResult
    action_feedback: MoveBaseActionFeedback
    def __init__(
        self,
        action_goal: MoveBaseActionGoal = ...,
        action_result: MoveBaseActionResult = ...,
        action_feedback: MoveBaseActionFeedback = ...,
    ) -> None: ...

class MoveBaseActionFeedback(genpy.Message):
    header: std_msgs.msg.Header
    status: actionlib_msgs.msg.GoalStatus
    feedback: MoveBaseFeedback
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        status: actionlib_msgs.msg.GoalStatus = ...,
        feedback: MoveBaseFeedback = ...,
    ) -> None: ...

class MoveBaseActionGoal(genpy.Message):
    header: std_msgs.msg.Header
    goal_id: actionlib_msgs.msg.GoalID
    goal: MoveBaseGoal
    def __init__(
        self, header: std_msgs.msg.Header = ..., goal_id: actionlib_msgs.msg.GoalID = ..., goal: MoveBaseGoal = ...
    ) -> None: ...

class MoveBaseActionResult(genpy.Message):
    header: std_msgs.msg.Header
    status: actionlib_msgs.msg.GoalStatus
    result: MoveBaseResult
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        status: actionlib_msgs.msg.GoalStatus = ...,
        result: MoveBaseResult = ...,
    ) -> None: ...

class MoveBaseFeedback(genpy.Message):
    base_position: geometry_msgs.msg.PoseStamped
    def __init__(self, base_position: geometry_msgs.msg.PoseStamped = ...) -> None: ...

class MoveBaseGoal(genpy.Message):
    target_pose: geometry_msgs.msg.PoseStamped
    def __init__(self, target_pose: geometry_msgs.msg.PoseStamped = ...) -> None: ...

class MoveBaseResult(genpy.Message):
    def __init__(self) -> None: ...
