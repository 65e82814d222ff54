"""Clients of goals on a master of their own."""

import sys
from pathlib import Path

import pytest
from tests.ros_session import RosSession

RECORDER = """import rospy
from actionlib_msgs.msg import GoalID
from move_base_msgs.msg import MoveBaseActionGoal
rospy.init_node("recorder")
rospy.Subscriber("drive/goal", MoveBaseActionGoal, lambda _: None)
rospy.Subscriber("drive/cancel", GoalID, lambda _: None)
rospy.spin()
"""
SERVER = """import rospy
from actionlib import ActionServer
from move_base_msgs.msg import MoveBaseAction
rospy.init_node("server")
ActionServer("drive", MoveBaseAction, lambda _: None, auto_start=False).start()
rospy.spin()
"""
CLIENT = """import rospy
from ur_nodes.ros1.goals import RosGoalClient
class Follower:
    on_states = on_goal_end = staticmethod(lambda _: None)
class Loop:
    mailbox = staticmethod(lambda _, handle: handle)
rospy.init_node("client")
client = RosGoalClient("drive", Follower, Loop)
while not (client._goals.get_num_connections() and client._cancels.get_num_connections()):
    rospy.sleep(0.01)
print(client.servers(), flush=True)
while not client.servers():
    rospy.sleep(0.01)
print("served", flush=True)
rospy.spin()
"""


@pytest.mark.ros
def test_recorder_that_hears_goals_is_no_server_of_them(tmp_path: Path) -> None:
    session = RosSession(tmp_path)
    try:
        session.start(sys.executable, "-c", RECORDER)
        printed = session.start(sys.executable, "-c", CLIENT).stdout
        assert printed
        assert printed.readline() == "0\n"
        session.start(sys.executable, "-c", SERVER)
        assert printed.readline() == "served\n"
    finally:
        for process in session.running[1:]:
            process.kill()  # rospy may go on for long after a signal
        session.close()
