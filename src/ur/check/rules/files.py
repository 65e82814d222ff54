"""Rules about files and includes that reading and resolving a launch file reports."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULES = (
    Rule(
        id="broken-package",
        group=Group.FILES,
        severity=Severity.ERROR,
        summary="A package.xml on the package path cannot be read.",
        explanation="""
rospack reads every `package.xml` on ROS_PACKAGE_PATH; one that is broken keeps roslaunch from finding any
package. Repair or remove the file that the message names. It is about the computer, so there is no example
here.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="deprecated-file",
        group=Group.FILES,
        severity=Severity.WARNING,
        summary="A file says of itself that it is deprecated.",
        explanation="""
`<launch deprecated='why'>` makes roslaunch print the reason. Include the file that it names instead.
""",
        bad=(
            launch_example("""
<launch deprecated="«use talk.launch»">
  <node name="talker" pkg="demo_nodes" type="talker"/>
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
    ),
    Rule(
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
    ),
    Rule(
        id="include-too-deep",
        group=Group.FILES,
        severity=Severity.ERROR,
        summary="Files are included 200 levels deep.",
        explanation="""
Each level of includes is one more place to look at when something is wrong; 200 is more than anybody can
follow. The limit is part of what keeps `ur` from hanging, so there is no example here.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="too-many-includes",
        group=Group.FILES,
        severity=Severity.ERROR,
        summary="More than 20,000 files are included.",
        explanation="""
Files that include others twice each double their number with every level. The limit is part of what keeps `ur`
from hanging, so there is no example here.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="unreadable-file",
        group=Group.FILES,
        severity=Severity.ERROR,
        summary="A file cannot be read as text.",
        explanation="""
Launch files, YAML files and programs are UTF-8 texts. The message says whether permission or an encoding is the
reason. It depends on bytes and permissions, so there is no example here.
""",
        bad=(),
        good=(),
    ),
)
