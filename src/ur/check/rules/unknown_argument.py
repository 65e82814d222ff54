"""An argument is passed that the included file does not declare."""

from __future__ import annotations

from ur.check.example_parts import passing_example
from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="unknown-argument",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An argument is passed that the included file does not declare.",
    explanation="""
roslaunch refuses an argument that the included file does not declare. Most often it is misspelt, or the file
has changed since.
""",
    bad=(passing_example('<arg name="«sped»" value="0.3"/>'),),
    good=(passing_example(),),
)
