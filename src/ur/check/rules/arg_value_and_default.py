"""An argument has both value= and default=."""

from __future__ import annotations

from ur.check.example_parts import speed_example
from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="arg-value-and-default",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An argument has both value= and default=.",
    explanation="""
`value` fixes an argument, `default` lets others change it: it is one or the other.
""",
    bad=(speed_example('<arg name="speed" value="0.3" «default»="0.5"/>'),),
    good=(speed_example(),),
)
