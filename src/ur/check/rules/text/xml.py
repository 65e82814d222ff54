"""Rules about the XML of a launch file, reported by its parser."""

from ur.check.example_parts import make_launch, speed_example
from ur.check.rule import Rule, RuleGroup, launch_example, launch_examples
from ur.source.diagnostic import Severity

RULES = (
    Rule(
        id="attribute-too-long",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="An attribute's value is longer than 1 MB.",
        explanation="""
Put the text into a file and name that with `textfile=` or `<rosparam file=...>`. The limit keeps `ur` from hanging.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="bad-xml",
        group=RuleGroup.XML,
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
            launch_example(make_launch('<param name="question" value="black «&» white"/>')),
        ),
        good=launch_examples("""
<launch>
  <group ns="left">
    <node name="talker" pkg="demo_nodes" type="talker"/>
  </group>
  <param name="question" value="black &amp; white"/>
</launch>
"""),
    ),
    Rule(
        id="entity-declaration",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="The file declares an XML entity.",
        explanation="""
Entities can make a small file as large as the memory, so they are refused. An argument does what an entity is
used for.
""",
        bad=launch_examples("""
<!DOCTYPE launch [
  «<!ENTITY» speed "0.3">
]>
<launch>
  <param name="speed" value="&speed;"/>
</launch>
"""),
        good=(speed_example('<arg name="speed" default="0.3"/>'),),
    ),
    Rule(
        id="file-too-large",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="The file is larger than any launch file.",
        explanation="""
A launch file of more than 8 MB, or of more than 200,000 elements, is not read: split it, or load large data with
`<rosparam file=...>` and `textfile=`. The limit keeps `ur` from hanging.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="launch-element",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="The file does not hold exactly one <launch>.",
        explanation="""
Everything in a launch file stands inside one `<launch>` element, which is the outermost one.
""",
        bad=launch_examples("""
«<robot»>
  <param name="speed" value="0.3"/>
</robot>
"""),
        good=launch_examples(make_launch('<param name="speed" value="0.3"/>')),
    ),
    Rule(
        id="missing-attribute",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="A tag lacks an attribute that it cannot do without.",
        explanation="""
`<node>` needs `name`, `pkg` and `type`, `<include>` needs `file`, `<remap>` needs `from` and `to`, and so on.
""",
        bad=launch_examples(make_launch('«<node» name="talker" type="talker"/>')),
        good=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker"/>')),
    ),
    Rule(
        id="nested-too-deep",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="Elements or mappings are nested too deep.",
        explanation="""
More than 900 elements inside one another, or 100 mappings in YAML, are not read. The limit keeps `ur` from hanging.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="wrong-ros-version",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="A launch file for ROS 1 includes one for ROS 2.",
        explanation="""
`<let>`, `<node exec=...>` and `$(find-pkg-share ...)` belong to the launch language of ROS 2, which roslaunch does not
read; files named `*.launch.py` and `*.launch.yaml` are for ROS 2, too. Each is checked alone as ROS 2 reads it.
""",
        bad=(
            launch_example(
                '<launch>\n  <include file="$(find my_robot)/launch/part.launch.xml"/>\n</launch>\n',
                {"launch/part.launch.xml": '<launch>\n  «<let» name="speed" value="0.3"/>\n</launch>\n'},
            ),
        ),
        good=launch_examples(make_launch('<let name="speed" value="0.3"/>')),
    ),
)
