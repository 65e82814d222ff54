"""A file says of itself that it is deprecated."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
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
)
