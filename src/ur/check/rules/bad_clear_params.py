"""clear_params stands without the name of what is cleared."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-clear-params",
    group=Group.NAMES,
    severity=Severity.ERROR,
    summary="clear_params stands without the name of what is cleared.",
    explanation="""
`clear_params` deletes the parameters of a namespace, so `<group>` and `<include>` need `ns` beside it.
""",
    bad=(
        launch_example("""
<launch>
  <group «clear_params»="true">
    <node name="talker" pkg="demo_nodes" type="talker"/>
  </group>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <group clear_params="true" ns="left">
    <node name="talker" pkg="demo_nodes" type="talker"/>
  </group>
</launch>
"""),
    ),
)
