"""A comment that is to hide a finding cannot be understood."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

_GOOD = """
<launch>
  <!--ur: ignore unused-argument: files that include this one still pass it-->
  <arg name="speed" default="0.3"/>
</launch>
"""

RULE = Rule(
    id="bad-suppression",
    group=Group.COMMENTS,
    severity=Severity.WARNING,
    summary="A comment that is to hide a finding cannot be understood.",
    explanation="""
`<!--ur: ignore RULE: REASON-->` hides findings of a rule in the element that follows, `ignore-file` in the whole file.
In YAML and programs it is `# ur: ignore RULE: REASON`, at the end of a line or alone above it. Several rules are
separated by commas. The reason is for whoever reads the file next, so it may not be left away.
""",
    bad=(
        launch_example("""
<launch>
  «<!--ur: ignore unused-arguments: files that include this one still pass it-->»
  <param name="speed" value="0.3"/>
</launch>
"""),
        launch_example("""
<launch>
  «<!--ur: ignore unused-argument-->»
  <param name="speed" value="0.3"/>
</launch>
"""),
    ),
    good=(launch_example(_GOOD),),
)
