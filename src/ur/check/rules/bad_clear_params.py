"""clear_params stands without the name of what is cleared."""

from __future__ import annotations

from ur.check.example_parts import group_example
from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-clear-params",
    group=Group.NAMES,
    severity=Severity.ERROR,
    summary="clear_params stands without the name of what is cleared.",
    explanation="""
`clear_params` deletes the parameters of a namespace, so `<group>` and `<include>` need `ns` beside it.
""",
    bad=(group_example('<group «clear_params»="true">'),),
    good=(group_example('<group clear_params="true" ns="left">'),),
)
