"""A rosparam deletes with a file."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="rosparam-file",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="A rosparam deletes with a file.",
    explanation="""
`command='delete'` removes parameters by name; a file belongs to `load` and `dump`.
""",
    bad=(
        launch_example("""
<launch>
  <rosparam command="delete" param="speed" «file»="speed.yaml"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <rosparam command="delete" param="speed"/>
</launch>
"""),
    ),
)
