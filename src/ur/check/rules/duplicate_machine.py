"""Two machines have the same name and differ."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="duplicate-machine",
    group=Group.MACHINES,
    severity=Severity.ERROR,
    summary="Two machines have the same name and differ.",
    explanation="""
A machine may be defined again with equal attributes, for instance by two included files, and not with others.
""",
    bad=(
        launch_example("""
<launch>
  <machine name="robot" address="robot.local"/>
  <machine name="«robot»" address="10.0.0.2"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <machine name="robot" address="robot.local"/>
  <machine name="other" address="10.0.0.2"/>
</launch>
"""),
    ),
)
