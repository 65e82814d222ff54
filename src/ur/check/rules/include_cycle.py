"""A file includes itself, directly or through others."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="include-cycle",
    group=Group.FILES,
    severity=Severity.ERROR,
    summary="A file includes itself, directly or through others.",
    explanation="""
roslaunch goes on until Python gives up. A condition that becomes false ends the circle.
""",
    bad=(
        launch_example("""
<launch>
  <include file="«$(find my_robot)/launch/example.launch»"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <arg name="again" default="true"/>
  <include file="$(find my_robot)/launch/example.launch" if="$(arg again)">
    <arg name="again" value="false"/>
  </include>
</launch>
"""),
    ),
)
