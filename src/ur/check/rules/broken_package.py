"""A package.xml on the package path cannot be read."""

from __future__ import annotations

from ur.check.model import Group, Rule
from ur.source.diagnostic import Severity

RULE = Rule(
    id="broken-package",
    group=Group.FILES,
    severity=Severity.ERROR,
    summary="A package.xml on the package path cannot be read.",
    explanation="""
rospack reads every `package.xml` on ROS_PACKAGE_PATH; one that is broken keeps roslaunch from finding any
package. Repair or remove the file that the message names. It is about the computer, so there is no example
here.
""",
    bad=(),
    good=(),
)
