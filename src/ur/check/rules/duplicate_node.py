"""Two nodes have the same name."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="duplicate-node",
    group=Group.NAMES,
    severity=Severity.ERROR,
    summary="Two nodes have the same name.",
    explanation="""
A name belongs to one node at a time: the ROS master ends the first when the second starts, so roslaunch refuses
the file.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker"/>
  <node name="«talker»" pkg="demo_nodes" type="listener"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker"/>
  <node name="talker" pkg="demo_nodes" type="talker" ns="left"/>
</launch>
"""),
    ),
)
