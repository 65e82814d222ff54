"""An argument with a fixed value is passed."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="fixed-arg",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An argument with a fixed value is passed.",
    explanation="""
An `<arg>` with `value=` cannot be given from outside. Where it is meant to be, it is written with `default=`.
""",
    bad=(
        launch_example(
            """
<launch>
  <include file="$(find my_robot)/launch/part.launch.xml">
    <arg name="speed" value="0.3"/>
  </include>
</launch>
""",
            {
                "launch/part.launch.xml": """
<launch>
  <arg name="«speed»" value="0.5"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
""",
            },
        ),
    ),
    good=(
        launch_example(
            """
<launch>
  <include file="$(find my_robot)/launch/part.launch.xml">
    <arg name="speed" value="0.3"/>
  </include>
</launch>
""",
            {
                "launch/part.launch.xml": """
<launch>
  <arg name="speed" default="0.5"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
""",
            },
        ),
    ),
)
