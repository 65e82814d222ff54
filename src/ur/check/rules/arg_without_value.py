"""An argument is passed without a value."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="arg-without-value",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An argument is passed without a value.",
    explanation="""
Inside `<include>`, `<arg>` passes a value to the included file, so it needs one. To hand on an argument of your
own, pass its value, or use `pass_all_args`.
""",
    bad=(
        launch_example(
            """
<launch>
  <include file="$(find my_robot)/launch/part.launch.xml">
    «<arg» name="speed"/>
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
