"""A condition on <launch> has no effect."""

from __future__ import annotations

from ur.check.example_parts import group_example
from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="useless-condition",
    group=Group.VALUES,
    severity=Severity.WARNING,
    summary="A condition on <launch> has no effect.",
    explanation="""
roslaunch reads `if` and `unless` of `<launch>` and forgets them. The condition belongs on the `<include>` of
the file.
""",
    bad=(
        launch_example("""
<launch «if»="false">
  <node name="talker" pkg="demo_nodes" type="talker"/>
</launch>
"""),
    ),
    good=(group_example('<group if="false">'),),
)
