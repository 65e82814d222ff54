"""A required argument of an included file is not passed."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="missing-argument",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="A required argument of an included file is not passed.",
    explanation="""
An `<arg>` with neither `default` nor `value` has to be given by whoever includes the file. roslaunch notices
only where the argument is used, and accepts it silently where it is not.
""",
    bad=(
        launch_example(
            """
<launch>
  «<include» file="$(find my_robot)/launch/part.launch.xml"/>
</launch>
""",
            {
                "launch/part.launch.xml": """
<launch>
  <arg name="speed"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
""",
            },
        ),
        launch_example(
            """
<launch>
  «<include» file="$(find my_robot)/launch/part.launch.xml"/>
</launch>
""",
            {
                "launch/part.launch.xml": """
<launch>
  <arg name="speed"/>
  <group if="false">
    <param name="speed" value="$(arg speed)"/>
  </group>
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
  <arg name="speed"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
""",
            },
        ),
    ),
)
