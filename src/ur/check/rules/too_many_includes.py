"""More than 20,000 files are included."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="too-many-includes",
    group=Group.FILES,
    severity=Severity.ERROR,
    summary="More than 20,000 files are included.",
    explanation="""
Files that include others twice each double their number with every level. The limit is part of what keeps `ur`
from hanging, so there is no example here.
""",
    bad=(),
    good=(),
)
