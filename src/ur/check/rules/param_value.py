"""A parameter has no value, or more than one."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="param-value",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="A parameter has no value, or more than one.",
    explanation="""
`<param>` takes exactly one of `value`, `textfile`, `binfile` and `command`.
""",
    bad=(
        launch_example("""
<launch>
  «<param» name="speed" />
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <param name="speed" value="0.3"/>
</launch>
"""),
    ),
)
