"""An attribute's value is longer than 1 MB."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="attribute-too-long",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="An attribute's value is longer than 1 MB.",
    explanation="""
Put the text into a file and name that with `textfile=` or `<rosparam file=...>`. The limit is part of what
keeps `ur` from hanging, so there is no example here.
""",
    bad=(),
    good=(),
)
