"""The file is not well-formed XML."""

from __future__ import annotations

from ur.check.model import Group, Rule, launch_example
from ur.source.diagnostic import Severity

RULE = Rule(
    id="bad-xml",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="The file is not well-formed XML.",
    explanation="""
A launch file is XML: every tag is closed, quotes come in pairs, and `<` and `&` in a value are written `&lt;`
and `&amp;`. roslaunch refuses the whole file, and every file that includes it.
""",
    bad=(
        launch_example("""
<launch>
  <group ns="left">
    <node name="talker" pkg="demo_nodes" type="talker"/>
«</launch>»
"""),
        launch_example("""
<launch>
  <param name="question" value="black «&» white"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <group ns="left">
    <node name="talker" pkg="demo_nodes" type="talker"/>
  </group>
  <param name="question" value="black &amp; white"/>
</launch>
"""),
    ),
)
