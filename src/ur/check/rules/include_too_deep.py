"""Files are included 200 levels deep."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="include-too-deep",
    group=Group.FILES,
    severity=Severity.ERROR,
    summary="Files are included 200 levels deep.",
    explanation="""
Each level of includes is one more place to look at when something is wrong; 200 is more than anybody can
follow. The limit is part of what keeps `ur` from hanging, so there is no example here.
""",
    bad=(),
    good=(),
)
