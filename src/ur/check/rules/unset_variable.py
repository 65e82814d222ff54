"""$(env NAME) names a variable that is not set."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="unset-variable",
    group=Group.ARGUMENTS,
    severity=Severity.ERROR,
    summary="$(env NAME) names a variable that is not set.",
    explanation="""
`ur launch` reports it, `ur check` does not: a variable may be set on the computer where the file is used, so
there is no example here. `$(optenv NAME DEFAULT)` works without it.
""",
    bad=(),
    good=(),
)
