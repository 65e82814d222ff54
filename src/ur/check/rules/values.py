"""Rules about the values of attributes, and about attributes that exclude one another."""

from collections.abc import Iterable

from ur.check.example_parts import group_example, make_launch
from ur.check.rule import LaunchView, Rule, RuleFinding, RuleGroup, TextEdit, launch_example, launch_examples
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Diagnostic, Severity

_FLAGS = ("respawn", "required", "clear_params", "pass_all_args", "subst_value")
_MEANT = {"1": "true", "0": "false", "yes": "true", "no": "false", "on": "true", "off": "false"}


def _find_bad_booleans(element: Element, view: LaunchView) -> Iterable[RuleFinding]:
    if element is view.tree.launch:
        return
    for name, value in element.attributes.items():
        if "$" in value:
            continue
        if name in ("if", "unless") and value.lower().strip() not in ("true", "false", "1", "0"):
            meant = _MEANT.get(value.lower().strip())
            yield RuleFinding(
                element.value_span(name),
                f"'{name}' of <{element.name}> is '{value}', expected true, false, 1 or 0",
                f'write {name}="{meant}"' if meant else None,
            )
        elif name in _FLAGS and value and value.lower() not in ("true", "false"):
            meant = _MEANT.get(value.lower().strip(), value.lower().strip())
            yield RuleFinding(
                element.value_span(name),
                f"'{name}' of <{element.name}> is '{value}', expected true or false",
                f'write {name}="{meant}"' if meant in ("true", "false") else None,
            )


def _repair_boolean(found: Diagnostic) -> tuple[TextEdit, ...]:
    span = found.span
    if span is None:
        return ()
    written = span.text.strip().lower()
    meant = _MEANT.get(written, written)
    return (TextEdit(span, meant),) if meant in ("true", "false") else ()


RULES = (
    Rule(
        id="bad-boolean",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="Something that is true or false is neither.",
        explanation="""
`if` and `unless` take `true`, `false`, `1` and `0`; `respawn`, `required`, `clear_params`, `pass_all_args` and
`subst_value` only `true` and `false`. `--fix` writes `true` for 1, yes and on, `false` for 0, no and off.
""",
        bad=(
            launch_example(make_launch('<node name="talker" pkg="demo_nodes" type="talker" respawn="«1»"/>')),
            launch_example(
                make_launch('<group if="«yes»">', '  <node name="talker" pkg="demo_nodes" type="talker"/>', "</group>")
            ),
        ),
        good=launch_examples("""
<launch>
  <arg name="again"/>
  <group if="1">
    <node name="talker" pkg="demo_nodes" type="talker" respawn="$(arg again)"/>
  </group>
</launch>
"""),
        element=_find_bad_booleans,
        fix=_repair_boolean,
    ),
    Rule(
        id="bad-choice",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="An attribute takes one of a few words, and this is another.",
        explanation="""
`output` is `log` or `screen`, `cwd` is `ROS_HOME` or `node`, `command` of `<rosparam>` is `load`, `dump` or
`delete`.
""",
        bad=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker" output="«sceen»"/>')),
        good=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker" output="screen"/>')),
    ),
    Rule(
        id="bad-condition",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A tag has both if and unless.",
        explanation="""
A tag takes one condition. Two of them are one expression: an `if` with `$(eval ...)`.
""",
        bad=launch_examples(
            make_launch(
                '<arg name="a" default="true"/>',
                '<arg name="b" default="true"/>',
                '<node name="talker" pkg="demo_nodes" type="talker" if="$(arg a)" «unless»="$(arg b)"/>',
            )
        ),
        good=launch_examples(
            make_launch(
                '<arg name="a" default="true"/>',
                '<arg name="b" default="true"/>',
                '<node name="talker" pkg="demo_nodes" type="talker" if="$(eval a and not b)"/>',
            )
        ),
    ),
    Rule(
        id="bad-number",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A number was expected.",
        explanation="""
`respawn_delay`, `timeout`, `ssh-port`, `time-limit` and `retry` are numbers; times are in seconds.
""",
        bad=launch_examples(
            make_launch('<node name="talker" pkg="demo_nodes" type="talker" respawn="true" respawn_delay="«5s»"/>')
        ),
        good=launch_examples(
            make_launch('<node name="talker" pkg="demo_nodes" type="talker" respawn="true" respawn_delay="5"/>')
        ),
    ),
    Rule(
        id="bad-ready",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="A ready: comment is not made of conditions.",
        explanation="""
`ur launch` reads `<!--ready: ...-->` inside a node as what has to be there before the node is up, and `ur wait` waits
for it. A part that it does not understand is left out, so nothing would wait for it. roslaunch ignores the comment.
""",
        bad=launch_examples(
            make_launch(
                '<node name="talker" pkg="demo_nodes" type="talker">', "  «<!--ready: topics chatter-->»", "</node>"
            )
        ),
        good=launch_examples(
            make_launch(
                '<node name="talker" pkg="demo_nodes" type="talker">',
                "  <!--ready: topic chatter 5 Hz; service ~set_logger_level-->",
                "</node>",
            )
        ),
    ),
    Rule(
        id="empty-attribute",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="An attribute is empty that has to say something.",
        explanation="""
`pkg` and `type` of a node and `name` of an environment variable cannot be empty.
""",
        bad=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" «type»=""/>')),
        good=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker"/>')),
    ),
    Rule(
        id="misplaced-attribute",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="An attribute of <node> stands in a <test>.",
        explanation="""
A test ends by itself: it is not respawned, and its output goes to the results.
""",
        bad=launch_examples(make_launch('<test test-name="hears" pkg="demo_nodes" type="talker" «respawn»="true"/>')),
        good=launch_examples(make_launch('<test test-name="hears" pkg="demo_nodes" type="talker" time-limit="20"/>')),
    ),
    Rule(
        id="required-and-respawn",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="A node is both required and respawned.",
        explanation="""
`required` ends everything when the node ends, `respawn` starts it again: a node can be one of the two.
""",
        bad=launch_examples(
            make_launch('<node name="talker" pkg="demo_nodes" type="talker" «required»="true" respawn="true"/>')
        ),
        good=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker" required="true"/>')),
    ),
    Rule(
        id="useless-condition",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="A condition on <launch> has no effect.",
        explanation="""
roslaunch reads `if` and `unless` of `<launch>` and forgets them. The condition belongs on the `<include>` of
the file.
""",
        bad=launch_examples("""
<launch «if»="false">
  <node name="talker" pkg="demo_nodes" type="talker"/>
</launch>
"""),
        good=(group_example('<group if="false">'),),
    ),
)
