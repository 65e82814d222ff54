"""The file does not hold exactly one <launch>."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="launch-element",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="The file does not hold exactly one <launch>.",
    explanation="""
Everything in a launch file stands inside one `<launch>` element, which is the outermost one.
""",
    bad=(
        launch_example("""
«<robot»>
  <param name="speed" value="0.3"/>
</robot>
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
