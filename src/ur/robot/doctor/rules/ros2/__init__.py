"""Rules about ROS 2: how nodes discover one another, whether their topics connect, and what they send."""

from ur.robot.doctor.rules.registry import Rule
from ur.robot.doctor.rules.ros2 import discovery, nodes, pairs, topics

RULES: tuple[Rule, ...] = (*discovery.RULES, *pairs.RULES, *topics.RULES, *nodes.RULES)
