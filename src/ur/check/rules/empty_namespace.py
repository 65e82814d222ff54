"""An ns attribute is empty."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="empty-namespace",
    group=Group.NAMES,
    severity=Severity.ERROR,
    summary="An ns attribute is empty.",
    explanation="""
roslaunch refuses `ns=''`. Leave the attribute away, or write `/` for the root.
""",
    bad=(
        launch_example("""
<launch>
  <group «ns»="">
    <node name="talker" pkg="demo_nodes" type="talker"/>
  </group>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <group ns="left">
    <node name="talker" pkg="demo_nodes" type="talker"/>
  </group>
</launch>
"""),
    ),
)
