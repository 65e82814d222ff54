"""A parameter's value is not of its type."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-param-value",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="A parameter's value is not of its type.",
    explanation="""
roslaunch converts the text to the type that `type=` names, and refuses the file when it cannot.
""",
    bad=(
        launch_example("""
<launch>
  <param name="count" type="int" value="«3.5»"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <param name="count" type="int" value="3"/>
</launch>
"""),
    ),
)
