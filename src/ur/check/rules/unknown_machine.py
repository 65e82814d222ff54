"""A node names a machine that is not defined."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="unknown-machine",
    group=Group.MACHINES,
    severity=Severity.ERROR,
    summary="A node names a machine that is not defined.",
    explanation="""
`machine` names a `<machine>` of the same run; `localhost` has to be defined, too. A file that others include is judged
where they include it, and a file that includes one that cannot be found here is left alone.
""",
    bad=(
        launch_example("""
<launch>
  <machine name="robot" address="robot.local"/>
  <node name="talker" pkg="demo_nodes" type="talker" machine="«robto»"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <machine name="robot" address="robot.local"/>
  <node name="talker" pkg="demo_nodes" type="talker" machine="robot"/>
</launch>
"""),
    ),
)
