"""A rosparam holds a value and does not say which parameter it is."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="rosparam-not-a-mapping",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="A rosparam holds a value and does not say which parameter it is.",
    explanation="""
Without `param`, a `<rosparam>` holds names with values.
""",
    bad=(
        launch_example("""
<launch>
  «<rosparam»>[1, 2, 3]</rosparam>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <rosparam param="wheels">[1, 2, 3]</rosparam>
</launch>
"""),
    ),
)
