"""A package that is needed is not installed on this computer."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

_MANIFEST = """
<package format="2">
  <name>my_robot</name>
  <exec_depend>far_away</exec_depend>
</package>
"""

RULE = Rule(
    id="package-not-installed",
    group=Group.FILES,
    severity=Severity.WARNING,
    summary="A package that is needed is not installed on this computer.",
    explanation="""
`package.xml` depends on the package, or only an option needs it that is off: the launch file may well be right, and
what it takes from that package cannot be checked here.
""",
    bad=(
        launch_example(
            """
<launch>
  <node name="talker" pkg="«far_away»" type="talker"/>
</launch>
""",
            {"package.xml": _MANIFEST},
        ),
        launch_example("""
<launch>
  <arg name="simulate" default="false"/>
  <include file="«$(find far_away)»/launch/world.launch" if="$(arg simulate)"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker"/>
</launch>
"""),
    ),
)
