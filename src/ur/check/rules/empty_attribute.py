"""An attribute is empty that has to say something."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="empty-attribute",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="An attribute is empty that has to say something.",
    explanation="""
`pkg` and `type` of a node and `name` of an environment variable cannot be empty.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" «type»=""/>
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
