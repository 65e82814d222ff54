"""An attribute takes one of a few words, and this is another."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-choice",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="An attribute takes one of a few words, and this is another.",
    explanation="""
`output` is `log` or `screen`, `cwd` is `ROS_HOME` or `node`, `command` of `<rosparam>` is `load`, `dump` or
`delete`.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" output="«sceen»"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" output="screen"/>
</launch>
"""),
    ),
)
