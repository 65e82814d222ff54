"""More than 500,000 parameters are set."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="too-many-params",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="More than 500,000 parameters are set.",
    explanation="""
The parameter server is not made for data of this size: load it in the node, from a file. The limit is part of
what keeps `ur` from hanging, so there is no example here.
""",
    bad=(),
    good=(),
)
