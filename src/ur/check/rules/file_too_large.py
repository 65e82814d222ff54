"""The file is larger than any launch file."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="file-too-large",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="The file is larger than any launch file.",
    explanation="""
A launch file of more than 8 MB, or of more than 200,000 elements, is not read: it would take the memory that
nodes need. Split it, or load large data with `<rosparam file=...>` and `textfile=`. The limit is part of what
keeps `ur` from hanging, so there is no example here.
""",
    bad=(),
    good=(),
)
