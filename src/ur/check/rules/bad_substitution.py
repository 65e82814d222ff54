"""A $(...) cannot be understood."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-substitution",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="A $(...) cannot be understood.",
    explanation="""
Known are `$(arg NAME)`, `$(find PACKAGE)`, `$(env NAME)`, `$(optenv NAME DEFAULT)`, `$(anon NAME)`,
`$(dirname)` and `$(eval EXPRESSION)`. They do not nest, and `$(eval ...)` has to be the whole value.
""",
    bad=(
        launch_example("""
<launch>
  <arg name="speed" default="0.5"/>
  <param name="speed" value="«$(args speed)»"/>
</launch>
"""),
        launch_example("""
<launch>
  <arg name="base" default="speed"/>
  <arg name="speed" default="0.5"/>
  <param name="speed" value="$(arg «$»(arg base))"/>
  <param name="copy" value="$(arg speed)"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <arg name="speed" default="0.5"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
"""),
    ),
)
