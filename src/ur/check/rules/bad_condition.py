"""A tag has both if and unless."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-condition",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="A tag has both if and unless.",
    explanation="""
A tag takes one condition. Two of them are one expression: an `if` with `$(eval ...)`.
""",
    bad=(
        launch_example("""
<launch>
  <arg name="a" default="true"/>
  <arg name="b" default="true"/>
  <node name="talker" pkg="demo_nodes" type="talker" if="$(arg a)" «unless»="$(arg b)"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <arg name="a" default="true"/>
  <arg name="b" default="true"/>
  <node name="talker" pkg="demo_nodes" type="talker" if="$(eval a and not b)"/>
</launch>
"""),
    ),
)
