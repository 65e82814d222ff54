"""An argument with a fixed value is passed."""

from __future__ import annotations

from ur.check.example_parts import passing_example
from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="fixed-arg",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="An argument with a fixed value is passed.",
    explanation="""
An `<arg>` with `value=` cannot be given from outside. Where it is meant to be, it is written with `default=`.
""",
    bad=(passing_example(declared='<arg name="«speed»" value="0.5"/>'),),
    good=(passing_example(),),
)
