"""A package does not hold the program of a node."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.executables import find_program
from ur.check.model import Found, Group, NodeView, Rule, launch_example
from ur.check.worlds import has_marker
from ur.source.diagnostic import Severity
from ur.source.suggest import did_you_mean


def _find_missing_executable(view: NodeView) -> Iterable[Found]:
    package, name = view.node.package, view.node.type
    if not view.local or has_marker(package) or has_marker(name):
        return
    verdict = find_program(package, name, view.world)
    if verdict.kind not in ("missing", "not-executable"):
        return
    if verdict.kind == "not-executable":
        help_ = f"make it executable: chmod +x {verdict.path}"
    else:
        near = did_you_mean(name, verdict.near)
        names = ", ".join(sorted(set(verdict.near))[:10]) or "no programs"
        help_ = f"did you mean {near}?" if near else f"{package} has: {names}"
    message = f"package {package} has no executable '{name}', expected one for node {view.node.full_name}"
    yield Found(view.element.value_span("type"), message, help_)


_CMAKE = """
project(my_robot)
add_executable(${PROJECT_NAME}_driver src/driver.cpp)
"""

RULE = Rule(
    id="missing-executable",
    group=Group.FILES,
    severity=Severity.ERROR,
    summary="A package does not hold the program of a node.",
    explanation="""
roslaunch looks for an executable file of this name in the package and where the package is installed, and says
"cannot launch node" when it starts, also when the file's mode does not allow to run it. Programs that the package's
CMakeLists.txt builds or installs count as there, and nodes of other computers are left alone.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="«tlker»"/>
</launch>
"""),
        launch_example(
            """
<launch>
  <node name="driver" pkg="my_robot" type="«driver.py»"/>
</launch>
""",
            {"scripts/driver.py": "#!/usr/bin/env python3\n"},
        ),
    ),
    good=(
        launch_example(
            """
<launch>
  <node name="talker" pkg="demo_nodes" type="talker"/>
  <node name="driver" pkg="my_robot" type="my_robot_driver"/>
</launch>
""",
            {"CMakeLists.txt": _CMAKE},
        ),
        launch_example(
            """
<launch>
  <machine name="robot" address="robot.local"/>
  <node name="driver" pkg="my_robot" type="driver.py"/>
  <node name="camera" pkg="my_robot" type="camera" machine="robot"/>
</launch>
""",
            {"scripts/driver.py": "#!/usr/bin/env python3\n"},
            executables=("scripts/driver.py",),
        ),
    ),
    node=_find_missing_executable,
)
