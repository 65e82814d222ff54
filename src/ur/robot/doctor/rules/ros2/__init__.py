"""ROS 2: discovery between nodes, connections of topics, and the data that nodes send."""

from ur.robot.doctor.rules.registry import Rule
from ur.robot.doctor.rules.ros2 import discovery, nodes, pairs, topics

RULES: tuple[Rule, ...] = (*discovery.RULES, *pairs.RULES, *topics.RULES, *nodes.RULES)
