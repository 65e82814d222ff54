"""A remapping is not made of two ROS names."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-remap",
    group=Group.NAMES,
    severity=Severity.ERROR,
    summary="A remapping is not made of two ROS names.",
    explanation="""
`from` and `to` are names of topics or services: letters, digits, `_` and `/`.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker">
    <remap from="chatter" to="«my chatter»"/>
  </node>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker">
    <remap from="chatter" to="/left/chatter"/>
  </node>
</launch>
"""),
    ),
)
