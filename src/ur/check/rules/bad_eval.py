"""An expression in $(eval ...) cannot be evaluated."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-eval",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An expression in $(eval ...) cannot be evaluated.",
    explanation="""
Between `$(eval ` and `)` stands a Python expression over arguments, `env()`, `find()` and the functions of
`math`.
""",
    bad=(
        launch_example("""
<launch>
  <arg name="speed" default="0.5"/>
  <param name="double" value="$(eval speed +«*» 2)"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <arg name="speed" default="0.5"/>
  <param name="double" value="$(eval speed * 2)"/>
</launch>
"""),
    ),
)
