"""A parameter lies inside another one that is a value."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="param-conflict",
    group=Group.VALUES,
    severity=Severity.WARNING,
    summary="A parameter lies inside another one that is a value.",
    explanation="""
A parameter is either a value or a namespace. roslaunch sets both, and the later one replaces the earlier.
""",
    bad=(
        launch_example("""
<launch>
  <param name="wheel" value="round"/>
  «<param» name="wheel/radius" value="0.1"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <param name="wheel/shape" value="round"/>
  <param name="wheel/radius" value="0.1"/>
</launch>
"""),
    ),
)
