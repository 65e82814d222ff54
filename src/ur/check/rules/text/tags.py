"""Rules about tags and attributes that roslaunch does not know."""

from collections.abc import Iterable, Sequence

from ur.check.example_parts import group_example, make_launch
from ur.check.rule import LaunchView, Rule, RuleFinding, RuleGroup, launch_example, launch_examples
from ur.check.survey import is_switched_off
from ur.launchfile.plan.tags.body import TAGS
from ur.launchfile.query.vocabulary import ATTRIBUTES, INSIDE
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Severity
from ur.source.suggest import did_you_mean, suggest

_REFUSED = frozenset({"ros-root", "ros-package-path", "ros-ip", "ros-hostname"})  # obsolete-machine speaks of these


def _find_unknown_attributes(element: Element, _view: LaunchView) -> Iterable[RuleFinding]:
    known = ATTRIBUTES.get(element.name)
    if known is None:
        return
    for name in element.attributes:
        if name in known or name in ("if", "unless") or name in _REFUSED or ":" in name:
            continue
        yield RuleFinding(
            element.name_span(name),
            f"unknown attribute '{name}' of <{element.name}>, expected one of {', '.join(known)}",
            suggest(name, [*known, "if", "unless"]) or "remove it: roslaunch ignores it",
        )


def _find_unknown_tags(view: LaunchView) -> Iterable[RuleFinding]:
    # Resolving reports those that take part; here are the others, in branches that a condition leaves out.
    stack = [view.tree.launch] if view.tree.launch else []
    while stack:
        element = stack.pop()
        known = INSIDE.get(element.name)
        if known is None:
            continue
        for child in element.elements:
            name = child.name if known is TAGS else child.name.lower()
            if name in known:
                if is_switched_off(child):
                    continue
                stack.append(child)
            elif name != "master":  # had a meaning once: resolving warns of it
                yield _explain(child, element, known)


def _explain(child: Element, parent: Element, known: Sequence[str]) -> RuleFinding:
    near = did_you_mean(child.name, known)
    return RuleFinding(
        child.span,
        f"unknown tag <{child.name}> inside <{parent.name}>, expected one of {', '.join(known)}",
        f"did you mean <{near}>?" if near else "remove it: roslaunch ignores it with all that is inside",
    )


RULES = (
    Rule(
        id="unknown-attribute",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="An attribute is not one that its tag knows.",
        explanation="""
roslaunch prints a warning among many other lines and goes on without the attribute: a node with `respaen="true"`
is not started again.
""",
        bad=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker" «respaen»="true"/>')),
        good=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker" respawn="true"/>')),
        element=_find_unknown_attributes,
    ),
    Rule(
        id="unknown-tag",
        group=RuleGroup.XML,
        severity=Severity.ERROR,
        summary="A tag is not one that roslaunch knows.",
        explanation="""
roslaunch prints a warning among many other lines, ignores the tag with everything inside it, and starts the rest.
""",
        bad=(
            launch_example(
                make_launch('«<gruop» ns="left">', '  <node name="talker" pkg="demo_nodes" type="talker"/>', "</gruop>")
            ),
            launch_example("""
<launch>
  <arg name="loud" default="false"/>
  <group if="$(arg loud)">
    <node name="talker" pkg="demo_nodes" type="talker">
      «<parm» name="volume" value="11"/>
    </node>
  </group>
</launch>
"""),
        ),
        good=(group_example('<group ns="left">'),),
        launch_file=_find_unknown_tags,
    ),
)
