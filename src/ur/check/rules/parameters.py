"""Rules about `<param>` and `<rosparam>`."""

from __future__ import annotations

from ur.check.rule import Rule, RuleGroup, launch_examples
from ur.source.diagnostic import Severity

RULES = (
    Rule(
        id="bad-param-type",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="The type of a parameter is not known.",
        explanation="""
Known are `str`, `int`, `double`, `bool` and `yaml`; without `type` roslaunch guesses.
""",
        bad=launch_examples("""
<launch>
  <param name="speed" type="«float»" value="0.3"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <param name="speed" type="double" value="0.3"/>
</launch>
"""),
    ),
    Rule(
        id="bad-param-value",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A parameter's value is not of its type.",
        explanation="""
roslaunch converts the text to the type that `type=` names, and refuses the file when it cannot.
""",
        bad=launch_examples("""
<launch>
  <param name="count" type="int" value="«3.5»"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <param name="count" type="int" value="3"/>
</launch>
"""),
    ),
    Rule(
        id="bad-yaml-key",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A key in YAML is not a text.",
        explanation="""
Names of parameters are texts. YAML reads `1`, `yes` and `on` as something else, unless they stand in quotes.
""",
        bad=launch_examples("""
<launch>
  <rosparam>
    speeds: {«1»: 0.3}
  </rosparam>
</launch>
"""),
        good=launch_examples("""
<launch>
  <rosparam>
    speeds: {first: 0.3}
  </rosparam>
</launch>
"""),
    ),
    Rule(
        id="param-conflict",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="A parameter lies inside another one that is a value.",
        explanation="""
A parameter is either a value or a namespace. roslaunch sets both, and the later one replaces the earlier.
""",
        bad=launch_examples("""
<launch>
  <param name="wheel" value="round"/>
  «<param» name="wheel/radius" value="0.1"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <param name="wheel/shape" value="round"/>
  <param name="wheel/radius" value="0.1"/>
</launch>
"""),
    ),
    Rule(
        id="param-value",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A parameter has no value, or more than one.",
        explanation="""
`<param>` takes exactly one of `value`, `textfile`, `binfile` and `command`.
""",
        bad=launch_examples("""
<launch>
  «<param» name="speed" />
</launch>
"""),
        good=launch_examples("""
<launch>
  <param name="speed" value="0.3"/>
</launch>
"""),
    ),
    Rule(
        id="rosparam-file",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A rosparam deletes with a file.",
        explanation="""
`command='delete'` removes parameters by name; a file belongs to `load` and `dump`.
""",
        bad=launch_examples("""
<launch>
  <rosparam command="delete" param="speed" «file»="speed.yaml"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <rosparam command="delete" param="speed"/>
</launch>
"""),
    ),
    Rule(
        id="rosparam-not-a-mapping",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A rosparam holds a value and does not say which parameter it is.",
        explanation="""
Without `param`, a `<rosparam>` holds names with values.
""",
        bad=launch_examples("""
<launch>
  «<rosparam»>[1, 2, 3]</rosparam>
</launch>
"""),
        good=launch_examples("""
<launch>
  <rosparam param="wheels">[1, 2, 3]</rosparam>
</launch>
"""),
    ),
    Rule(
        id="too-many-params",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="More than 500,000 parameters are set.",
        explanation="""
The parameter server is not made for data of this size: load it in the node, from a file. The limit is part of
what keeps `ur` from hanging, so there is no example here.
""",
        bad=(),
        good=(),
    ),
)
