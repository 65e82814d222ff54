"""A file cannot be read as text."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="unreadable-file",
    group=Group.FILES,
    severity=Severity.ERROR,
    summary="A file cannot be read as text.",
    explanation="""
Launch files, YAML files and programs are UTF-8 texts. The message says whether permission or an encoding is the
reason. It depends on bytes and permissions, so there is no example here.
""",
    bad=(),
    good=(),
)
