"""A number was expected."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-number",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="A number was expected.",
    explanation="""
`respawn_delay`, `timeout`, `ssh-port`, `time-limit` and `retry` are numbers; times are in seconds.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" respawn="true" respawn_delay="«5s»"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" respawn="true" respawn_delay="5"/>
</launch>
"""),
    ),
)
