"""A `ready:` comment is not made of conditions."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-ready",
    group=Group.VALUES,
    severity=Severity.WARNING,
    summary="A ready: comment is not made of conditions.",
    explanation="""
`ur launch` reads `<!--ready: ...-->` inside a node as what has to be there before the node is up, and `ur wait` waits
for it. A part that it does not understand is left out, so nobody would wait for it. roslaunch ignores the comment.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker">
    «<!--ready: topics chatter-->»
  </node>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker">
    <!--ready: topic chatter 5 Hz; service ~set_logger_level-->
  </node>
</launch>
"""),
    ),
)
