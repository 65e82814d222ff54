"""Rules that compare the arguments a launch file declares with those it uses."""

import re
from collections.abc import Iterable

from ur.check.example_parts import make_launch, speed_example
from ur.check.rule import LaunchView, PlanView, Rule, RuleFinding, RuleGroup, launch_example, launch_examples
from ur.check.survey import walk_elements
from ur.launchfile.syntax import Element, SubstitutionProblem, is_eval, parse_substitutions
from ur.source.diagnostic import Severity
from ur.source.suggest import did_you_mean, suggest

_ARG_CALL = re.compile(r"""(?<![\w.])arg\(\s*(["'])([^"']*)\1\s*\)""")


def _find_undeclared_argument(element: Element, view: LaunchView) -> Iterable[RuleFinding]:
    # Resolving reports those that take part; here are the others, in branches that a condition leaves out.
    for attribute, value in element.attributes.items():
        if "$(" not in value:
            continue
        for name, start, end in _arguments_in(value):
            if name not in view.declared and not any("$(" in each for each in view.declared):
                help_ = (
                    suggest(name, view.declared) or f'declare it before it is used: <arg name="{name}" default="..."/>'
                )
                yield RuleFinding(
                    element.piece_span(attribute, start, end),
                    f"argument '{name}' is not declared, expected <arg name=\"{name}\">",
                    help_,
                    subject=name,
                )


def _arguments_in(value: str) -> Iterable[tuple[str, int, int]]:
    if is_eval(value):
        if _ARG_CALL.search(value):
            yield from ((match.group(2), 0, len(value)) for match in _ARG_CALL.finditer(value))
        return
    try:
        pieces = parse_substitutions(value)
    except SubstitutionProblem:
        return
    for piece in pieces:
        if piece.command == "arg" and len(piece.words) == 1:
            yield piece.words[0].text, piece.start, piece.end


def _find_unused_argument(view: LaunchView) -> Iterable[RuleFinding]:
    if _uses_all(view):
        return
    undeclared = set(view.used) - set(view.declared)
    for name, elements in view.declared.items():
        # Where a name near to it is used and not declared, that one is misspelt, and reported.
        if "$(" not in name and name not in view.used and not did_you_mean(name, undeclared):
            message = f"argument '{name}' is declared and not used, expected a place that uses it"
            help_ = "remove it, or use it where it was meant to be"
            yield RuleFinding(elements[0].value_span("name"), message, help_, subject=name)


def _find_unused_declared(view: PlanView) -> Iterable[RuleFinding]:
    for place in view.plan.unused:
        name = place.text.strip("'\"")
        message = f"argument '{name}' is declared and not used, expected a place that uses it"
        yield RuleFinding(place, message, "remove it, or use it where it was meant to be", subject=name)


def _uses_all(view: LaunchView) -> bool:
    # Included files and YAML files may use what is declared here.
    for element, _ in walk_elements(view.tree.launch):
        if element.attributes.get("pass_all_args", "false").lower() != "false":
            return True
        if "file" in element.attributes and element.attributes.get("subst_value", "false").lower() != "false":
            return True
    return False


RULES = (
    Rule(
        id="undeclared-argument",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.ERROR,
        summary="$(arg NAME) names an argument that the file does not declare.",
        explanation="""
Every file declares the arguments it uses, before it uses them; those of the including file are not inherited. roslaunch
refuses the file as soon as the place takes part.
""",
        bad=(
            launch_example(
                make_launch(
                    '<arg name="speed" default="0.3"/>',
                    '<param name="speed" value="$(arg speed)"/>',
                    '<param name="limit" value="«$(arg sped)»"/>',
                )
            ),
            launch_example("""
<launch>
  <arg name="loud" default="false"/>
  <group if="$(arg loud)">
    <param name="volume" value="«$(arg volume)»" unless="$(arg loud)"/>
  </group>
</launch>
"""),
        ),
        good=(speed_example('<arg name="speed" default="0.3"/>'),),
        element=_find_undeclared_argument,
    ),
    Rule(
        id="unused-argument",
        group=RuleGroup.ARGUMENTS,
        severity=Severity.WARNING,
        summary="An argument is declared and nothing uses it.",
        explanation="""
The file works, but who gives the argument expects an effect. Files that hand on everything with `pass_all_args`, or
into YAML with `subst_value`, are left alone, and so are arguments that another file passes: roslaunch refuses a file
that does not declare what it is passed.
""",
        bad=launch_examples(make_launch('<arg name="«speed»" default="0.3"/>', '<param name="limit" value="0.5"/>')),
        good=launch_examples("""
<launch>
  <arg name="speed" default="0.3"/>
  <arg name="fast" value="$(eval speed > 1)"/>
  <rosparam subst_value="true">
    speeds: [$(arg speed), $(arg fast)]
  </rosparam>
</launch>
"""),
        launch_file=_find_unused_argument,
        plan=_find_unused_declared,
    ),
)
