"""An argument is declared twice."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="duplicate-arg",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An argument is declared twice.",
    explanation="""
roslaunch refuses a second `<arg>` of the same name in one file, unless `if` and `unless` leave one of them. Of options
that are not required only the defaults are judged: other values may not be meant to be given together.
""",
    bad=(
        launch_example("""
<launch>
  <arg name="speed" default="0.3"/>
  <arg name="«speed»" default="0.5"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <arg name="fast" default="false"/>
  <arg name="speed" default="0.3" unless="$(arg fast)"/>
  <arg name="speed" default="0.5" if="$(arg fast)"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
"""),
    ),
)
