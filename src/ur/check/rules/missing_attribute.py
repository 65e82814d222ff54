"""A tag lacks an attribute that it cannot do without."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="missing-attribute",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="A tag lacks an attribute that it cannot do without.",
    explanation="""
`<node>` needs `name`, `pkg` and `type`, `<include>` needs `file`, `<remap>` needs `from` and `to`, and so on.
""",
    bad=(
        launch_example("""
<launch>
  «<node» name="talker" type="talker"/>
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
