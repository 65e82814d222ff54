"""A name is not one that ROS can use."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-name",
    group=Group.NAMES,
    severity=Severity.ERROR,
    summary="A name is not one that ROS can use.",
    explanation="""
Names begin with a letter and go on with letters, digits and `_`. The name of a node holds no `/`; its namespace
goes into `ns`.
""",
    bad=(
        launch_example("""
<launch>
  <node name="«left/talker»" pkg="demo_nodes" type="talker"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker_1" pkg="demo_nodes" type="talker" ns="left"/>
</launch>
"""),
    ),
)
