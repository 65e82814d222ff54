"""The file is a launch file for ROS 2."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="wrong-ros-version",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="The file is a launch file for ROS 2.",
    explanation="""
`<let>`, `<node exec=...>` and `$(find-pkg-share ...)` belong to the launch language of ROS 2, which roslaunch does not
read. Nothing else is reported about such a file. Files named `*.launch.py` and `*.launch.yaml` are for ROS 2, too.
""",
    bad=(
        launch_example("""
<launch>
  «<let» name="speed" value="0.3"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <param name="speed" value="0.3"/>
</launch>
"""),
    ),
)
