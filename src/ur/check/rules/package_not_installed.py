"""A package that is needed is not installed on this computer."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.executables import find_program, is_misspelt
from ur.check.model import Found, Group, NodeView, Rule, launch_example
from ur.check.worlds import has_marker
from ur.source.diagnostic import Severity
from ur.source.suggest import did_you_mean


def _find_not_installed(view: NodeView) -> Iterable[Found]:
    package, name = view.node.package, view.node.type
    if not view.local or has_marker(package) or has_marker(name):
        return
    verdict = find_program(package, name, view.world)
    if verdict.kind == "no-package":
        near = did_you_mean(package, view.world.package_names())
        if near is None or not is_misspelt(package, near):
            yield Found(
                view.element.value_span("pkg"),
                f"package '{package}' is not installed here, expected it where its nodes run",
                f"install {package}, or source its workspace's setup.bash; what it holds is not checked until then",
                subject=package,
            )
    elif verdict.kind == "no-programs":
        yield Found(
            view.element.value_span("type"),
            f"package '{package}' holds no programs here, expected '{name}'",
            f"build {package}, or source its workspace's setup.bash; its programs are not checked until then",
            subject=package,
        )


_MANIFEST = """
<package format="2">
  <name>my_robot</name>
  <exec_depend>far_away</exec_depend>
</package>
"""

RULE = Rule(
    id="package-not-installed",
    group=Group.FILES,
    severity=Severity.WARNING,
    summary="A package that is needed is not installed on this computer.",
    explanation="""
The launch file may well be right, and what it takes from that package cannot be checked here. `ur check` lists all such
packages in one paragraph after the other findings.
""",
    bad=(
        launch_example(
            """
<launch>
  <node name="talker" pkg="«far_away»" type="talker"/>
</launch>
""",
            {"package.xml": _MANIFEST},
        ),
        launch_example("""
<launch>
  <arg name="simulate" default="false"/>
  <include file="«$(find far_away)»/launch/world.launch" if="$(arg simulate)"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker"/>
</launch>
"""),
    ),
    node=_find_not_installed,
)
