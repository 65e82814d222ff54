"""The file declares an XML entity."""

from __future__ import annotations

from ur.check.example_parts import speed_example
from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="entity-declaration",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="The file declares an XML entity.",
    explanation="""
Entities can make a small file as large as the memory, so they are refused. An argument does what an entity is
used for.
""",
    bad=(
        launch_example("""
<!DOCTYPE launch [
  «<!ENTITY» speed "0.3">
]>
<launch>
  <param name="speed" value="&speed;"/>
</launch>
"""),
    ),
    good=(speed_example('<arg name="speed" default="0.3"/>'),),
)
