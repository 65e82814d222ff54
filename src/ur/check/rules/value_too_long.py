"""A value grows beyond 1 MB when its $(...) are replaced."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="value-too-long",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="A value grows beyond 1 MB when its $(...) are replaced.",
    explanation="""
Arguments that repeat one another grow without end. Put long texts into files. The limit is part of what keeps
`ur` from hanging, so there is no example here.
""",
    bad=(),
    good=(),
)
