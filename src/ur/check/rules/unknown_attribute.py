"""An attribute is not one that its tag knows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ur.check.model import Found, Group, LaunchView, Rule, launch_example
from ur.launchfile.plan.arguments import ARG_ATTRIBUTES
from ur.launchfile.plan.body import GROUP_ATTRIBUTES, INCLUDE_ATTRIBUTES
from ur.launchfile.plan.nodes import NODE_ATTRIBUTES, TEST_ATTRIBUTES
from ur.launchfile.plan.params import PARAM_ATTRIBUTES, ROSPARAM_ATTRIBUTES
from ur.launchfile.plan.simple import MACHINE_ATTRIBUTES
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Severity
from ur.source.suggest import did_you_mean

_KNOWN: Mapping[str, Sequence[str]] = {
    "arg": ARG_ATTRIBUTES,
    "env": ("name", "value"),
    "group": GROUP_ATTRIBUTES,
    "include": INCLUDE_ATTRIBUTES,
    "machine": MACHINE_ATTRIBUTES,
    "node": NODE_ATTRIBUTES,
    "param": PARAM_ATTRIBUTES,
    "remap": ("from", "to"),
    "rosparam": ROSPARAM_ATTRIBUTES,
    "test": TEST_ATTRIBUTES,
}
_REFUSED = frozenset({"ros-root", "ros-package-path", "ros-ip", "ros-hostname"})  # obsolete-machine speaks of these


def _find_unknown_attributes(element: Element, _view: LaunchView) -> Iterable[Found]:
    known = _KNOWN.get(element.name)
    if known is None:
        return
    for name in element.attributes:
        if name in known or name in ("if", "unless") or name in _REFUSED or ":" in name:
            continue
        near = did_you_mean(name, [*known, "if", "unless"])
        yield Found(
            element.name_span(name),
            f"unknown attribute '{name}' of <{element.name}>, expected one of {', '.join(known)}",
            f"did you mean {near}?" if near else "remove it: roslaunch ignores it",
        )


RULE = Rule(
    id="unknown-attribute",
    group=Group.XML,
    severity=Severity.ERROR,
    summary="An attribute is not one that its tag knows.",
    explanation="""
roslaunch prints a warning among many other lines and goes on without the attribute: a node with `respaen="true"`
is not started again.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" «respaen»="true"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" respawn="true"/>
</launch>
"""),
    ),
    element=_find_unknown_attributes,
)
