"""An argument is passed that the included file does not declare."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="unknown-argument",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An argument is passed that the included file does not declare.",
    explanation="""
roslaunch refuses an argument that the included file does not declare. Most often it is misspelt, or the file
has changed since.
""",
    bad=(
        launch_example(
            """
<launch>
  <include file="$(find my_robot)/launch/part.launch.xml">
    <arg name="«sped»" value="0.3"/>
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
