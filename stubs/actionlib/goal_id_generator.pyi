"""The names of actionlib.goal_id_generator that this project uses."""

from actionlib_msgs.msg import GoalID

class GoalIDGenerator:
    def generate_ID(self) -> GoalID: ...
