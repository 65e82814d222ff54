"""A package cannot be found."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.executables import find_program, is_misspelt
from ur.check.model import Found, Group, NodeView, Rule, launch_example
from ur.check.worlds import has_marker
from ur.source.diagnostic import Severity
from ur.source.suggest import did_you_mean


def _find_unknown_package(view: NodeView) -> Iterable[Found]:
    package = view.node.package
    if not view.local or has_marker(package) or has_marker(view.node.type):
        return
    if find_program(package, view.node.type, view.world).kind == "no-package":
        near = did_you_mean(package, view.world.package_names())
        if near and is_misspelt(package, near):
            message = f"package '{package}' is not found, expected an installed one"
            yield Found(view.element.value_span("pkg"), message, f"did you mean {near}?", subject=package)


RULE = Rule(
    id="unknown-package",
    group=Group.FILES,
    severity=Severity.ERROR,
    summary="A package cannot be found.",
    explanation="""
`$(find PACKAGE)` and `pkg` name packages that are installed or on ROS_PACKAGE_PATH; packages beside the checked one
are found, too. Only a name that is nearly that of another package is an error; every other package that is not found is
reported as `package-not-installed` instead, a warning.
""",
    bad=(
        launch_example("""
<launch>
  <rosparam command="load" file="«$(find my_robto)»/params/speed.yaml"/>
</launch>
"""),
        launch_example("""
<launch>
  <node name="talker" pkg="«demo_node»" type="talker"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <arg name="package" default="demo_nodes"/>
  <arg name="other"/>
  <node name="talker" pkg="$(arg package)" type="talker"/>
  <node name="other" pkg="$(arg other)" type="talker"/>
</launch>
"""),
    ),
    node=_find_unknown_package,
)
