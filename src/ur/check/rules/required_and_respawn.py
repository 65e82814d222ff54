"""A node is both required and respawned."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="required-and-respawn",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="A node is both required and respawned.",
    explanation="""
`required` ends everything when the node ends, `respawn` starts it again: a node can be one of the two.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" «required»="true" respawn="true"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" required="true"/>
</launch>
"""),
    ),
)
