"""A key in YAML is not a text."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-yaml-key",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="A key in YAML is not a text.",
    explanation="""
Names of parameters are texts. YAML reads `1`, `yes` and `on` as something else, unless they stand in quotes.
""",
    bad=(
        launch_example("""
<launch>
  <rosparam>
    speeds: {«1»: 0.3}
  </rosparam>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <rosparam>
    speeds: {first: 0.3}
  </rosparam>
</launch>
"""),
    ),
)
