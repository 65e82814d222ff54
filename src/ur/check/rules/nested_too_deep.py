"""Elements or mappings are nested too deep."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="nested-too-deep",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="Elements or mappings are nested too deep.",
    explanation="""
More than 900 elements inside one another, or 100 mappings in YAML, are not read. The limit is part of what
keeps `ur` from hanging, so there is no example here.
""",
    bad=(),
    good=(),
)
