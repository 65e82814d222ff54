"""An argument is passed without a value."""

from __future__ import annotations

from ur.check.example_parts import passing_example
from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="arg-without-value",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An argument is passed without a value.",
    explanation="""
Inside `<include>`, `<arg>` passes a value to the included file, so it needs one. To hand on an argument of your
own, pass its value, or use `pass_all_args`.
""",
    bad=(passing_example('«<arg» name="speed"/>'),),
    good=(passing_example(),),
)
