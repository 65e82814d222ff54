"""The type of a parameter is not known."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-param-type",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="The type of a parameter is not known.",
    explanation="""
Known are `str`, `int`, `double`, `bool` and `yaml`; without `type` roslaunch guesses.
""",
    bad=(
        launch_example("""
<launch>
  <param name="speed" type="«float»" value="0.3"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <param name="speed" type="double" value="0.3"/>
</launch>
"""),
    ),
)
