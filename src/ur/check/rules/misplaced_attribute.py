"""An attribute of <node> stands in a <test>."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="misplaced-attribute",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="An attribute of <node> stands in a <test>.",
    explanation="""
A test ends by itself: it is not respawned, and its output goes to the results.
""",
    bad=(
        launch_example("""
<launch>
  <test test-name="hears" pkg="demo_nodes" type="talker" «respawn»="true"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <test test-name="hears" pkg="demo_nodes" type="talker" time-limit="20"/>
</launch>
"""),
    ),
)
