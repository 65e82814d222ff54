"""An ns attribute is empty."""

from __future__ import annotations

from ur.check.example_parts import group_example
from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="empty-namespace",
    group=Group.NAMES,
    severity=Severity.ERROR,
    summary="An ns attribute is empty.",
    explanation="""
roslaunch refuses `ns=''`. Leave the attribute away, or write `/` for the root.
""",
    bad=(group_example('<group «ns»="">'),),
    good=(group_example('<group ns="left">'),),
)
