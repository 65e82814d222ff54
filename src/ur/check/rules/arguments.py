"""Rules about arguments, reported by the parser and resolver of launch files."""

from ur.check.example_parts import make_launch, make_speed_launch, passing_example, speed_example
from ur.check.rule import Rule, RuleGroup, launch_example, launch_examples
from ur.source.diagnostic import Severity

_INCLUDES = """
<launch>
  «<include» file="$(find my_robot)/launch/part.launch.xml"/>
</launch>
"""
_PART = "launch/part.launch.xml"
_DECLARED = '<arg name="speed"/>'


RULES = (
    Rule(
        id="arg-value-and-default",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="An argument has both value= and default=.",
        explanation="""
`value` fixes an argument, `default` lets others change it: it is one or the other.
""",
        bad=(speed_example('<arg name="speed" value="0.3" «default»="0.5"/>'),),
        good=(speed_example(),),
    ),
    Rule(
        id="arg-without-value",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="An argument is passed without a value.",
        explanation="""
Inside `<include>`, `<arg>` passes a value to the included file, so it needs one. To hand on an argument of your
own, pass its value, or use `pass_all_args`.
""",
        bad=(passing_example('«<arg» name="speed"/>'),),
        good=(passing_example(),),
    ),
    Rule(
        id="bad-eval",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="An expression in $(eval ...) cannot be evaluated.",
        explanation="""
Between `$(eval ` and `)` stands a Python expression over arguments, `env()`, `find()` and the functions of
`math`.
""",
        bad=launch_examples(
            make_launch('<arg name="speed" default="0.5"/>', '<param name="double" value="$(eval speed +«*» 2)"/>')
        ),
        good=launch_examples(
            make_launch('<arg name="speed" default="0.5"/>', '<param name="double" value="$(eval speed * 2)"/>')
        ),
    ),
    Rule(
        id="bad-substitution",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="A $(...) cannot be understood.",
        explanation="""
Known are `$(arg NAME)`, `$(find PACKAGE)`, `$(env NAME)`, `$(optenv NAME DEFAULT)`, `$(anon NAME)`,
`$(dirname)` and `$(eval EXPRESSION)`. They do not nest, and `$(eval ...)` has to be the whole value.
""",
        bad=(
            launch_example(
                make_launch('<arg name="speed" default="0.5"/>', '<param name="speed" value="«$(args speed)»"/>')
            ),
            launch_example("""
<launch>
  <arg name="base" default="speed"/>
  <arg name="speed" default="0.5"/>
  <param name="speed" value="$(arg «$»(arg base))"/>
  <param name="copy" value="$(arg speed)"/>
</launch>
"""),
        ),
        good=launch_examples(
            make_launch('<arg name="speed" default="0.5"/>', '<param name="speed" value="$(arg speed)"/>')
        ),
    ),
    Rule(
        id="duplicate-arg",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="An argument is declared twice.",
        explanation="""
roslaunch refuses a second `<arg>` of the same name in one file, unless `if` and `unless` leave one of them. Of options
that are not required only the defaults are judged: other values may not be meant to be given together.
""",
        bad=launch_examples(
            make_launch(
                '<arg name="speed" default="0.3"/>',
                '<arg name="«speed»" default="0.5"/>',
                '<param name="speed" value="$(arg speed)"/>',
            )
        ),
        good=launch_examples("""
<launch>
  <arg name="fast" default="false"/>
  <arg name="speed" default="0.3" unless="$(arg fast)"/>
  <arg name="speed" default="0.5" if="$(arg fast)"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
"""),
    ),
    Rule(
        id="fixed-arg",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="An argument with a fixed value is passed.",
        explanation="""
An `<arg>` with `value=` cannot be given from outside. Where it is meant to be, it is written with `default=`.
""",
        bad=(passing_example(declared='<arg name="«speed»" value="0.5"/>'),),
        good=(passing_example(),),
    ),
    Rule(
        id="missing-argument",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="A required argument of an included file is not passed.",
        explanation="""
An `<arg>` with neither `default` nor `value` has to be given by the file that includes it. roslaunch notices
only where the argument is used, and accepts it silently where it is not.
""",
        bad=(
            launch_example(_INCLUDES, {_PART: make_speed_launch(_DECLARED)}),
            launch_example(
                _INCLUDES,
                {
                    _PART: """<launch>
  <arg name="speed"/>
  <group if="false">
    <param name="speed" value="$(arg speed)"/>
  </group>
</launch>
"""
                },
            ),
        ),
        good=(passing_example(declared=_DECLARED),),
    ),
    Rule(
        id="unknown-argument",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="An argument is passed that the included file does not declare.",
        explanation="""
roslaunch refuses it. Most often it is misspelt, or the file has changed since.
""",
        bad=(passing_example('<arg name="«sped»" value="0.3"/>'),),
        good=(passing_example(),),
    ),
    Rule(
        id="unset-variable",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="$(env NAME) names a variable that is not set.",
        explanation="""
`ur launch` reports it, `ur check` does not: a variable may be set on the computer where the file is used.
`$(optenv NAME DEFAULT)` works without it.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="value-too-long",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="A value grows beyond 1 MB when its $(...) are replaced.",
        explanation="""
Arguments that repeat one another grow without end. Put long texts into files. The limit keeps `ur` from hanging.
""",
        bad=(),
        good=(),
    ),
)
