"""A required argument of an included file is not passed."""

from __future__ import annotations

from ur.check.example_parts import make_speed_launch, passing_example
from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

_INCLUDES = """
<launch>
  «<include» file="$(find my_robot)/launch/part.launch.xml"/>
</launch>
"""
_PART = "launch/part.launch.xml"
_DECLARED = '<arg name="speed"/>'

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
        launch_example(_INCLUDES, {_PART: make_speed_launch(_DECLARED)}),
        launch_example(
            _INCLUDES,
            {
                _PART: """<launch>
  <arg name="speed"/>
  <group if="false">
    <param name="speed" value="$(arg speed)"/>
  </group>
</launch>
""",
            },
        ),
    ),
    good=(passing_example(declared=_DECLARED),),
)
