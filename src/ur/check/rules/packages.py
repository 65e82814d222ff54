"""Rules about the packages and executables of nodes."""

from collections.abc import Iterable

from ur.check.example_parts import make_launch
from ur.check.queries.executables import ExecutableLookup, find_program, is_misspelt
from ur.check.rule import (
    Example,
    LaunchedNode,
    ProgramView,
    Rule,
    RuleFinding,
    RuleGroup,
    launch_example,
    launch_examples,
)
from ur.check.worlds import CachedWorld, has_marker
from ur.launchfile.world import World
from ur.source.diagnostic import Severity
from ur.source.file import SourceFile, Span
from ur.source.script import find_script_faults
from ur.source.suggest import did_you_mean, suggest


def _look_up(view: LaunchedNode) -> ExecutableLookup:
    package, name = view.node.package, view.node.type
    known = view.local and not has_marker(package) and not has_marker(name)
    return find_program(package, name, view.world) if known else ExecutableLookup("unknown")


def _find_missing_executable(view: LaunchedNode) -> Iterable[RuleFinding]:
    package, name, verdict = view.node.package, view.node.type, _look_up(view)
    if verdict.kind not in ("missing", "not-executable"):
        return
    if verdict.kind == "not-executable":
        help_ = f"make it executable: chmod +x {verdict.path}"
    else:
        names = ", ".join(sorted(set(verdict.near))[:10]) or "no programs"
        help_ = suggest(name, verdict.near) or f"{package} has: {names}"
    message = f"package {package} has no executable '{name}', expected one for node {view.node.full_name}"
    yield RuleFinding(view.element.value_span("type"), message, help_, subject=name)


def _find_bad_scripts(view: LaunchedNode) -> Iterable[RuleFinding]:
    package, name = view.node.package, view.node.type
    if not view.local or has_marker(package) or has_marker(name):
        return
    try:
        folder = view.world.find_package(package)
        files = view.world.find_executables(package, name) or view.world.find_files(package, name)
        for path in files:
            if path.startswith(f"{folder}/"):  # what is installed is not the author's to change
                yield from _read_script(path, folder, view.world)
    except (LookupError, OSError, ValueError):
        return  # missing-executable speaks of it


def _find_bad_program(view: ProgramView) -> Iterable[RuleFinding]:
    return _read_script(view.source.path, view.package.folder, view.world)


def _read_script(path: str, folder: str, world: CachedWorld) -> Iterable[RuleFinding]:
    data = world.read_bytes(path)
    source = SourceFile(path, data.decode("utf-8", "replace"))
    for fault in find_script_faults(path, data, world.find_program):
        if fault.kind == "interpreter" and _writes_first_lines(folder, world):
            continue
        yield RuleFinding(Span(source, fault.start, fault.end), fault.message, fault.help, subject=path)


def _writes_first_lines(folder: str, world: World) -> bool:
    path = f"{folder}/CMakeLists.txt"
    return world.is_file(path) and b"catkin_install_python" in world.read_bytes(path)


_CMAKE = """
project(my_robot)
add_executable(${PROJECT_NAME}_driver src/driver.cpp)
"""


def _find_not_installed(view: LaunchedNode) -> Iterable[RuleFinding]:
    package, name, verdict = view.node.package, view.node.type, _look_up(view)
    if verdict.kind == "no-package":
        near = did_you_mean(package, view.world.package_names())
        if near is None or not is_misspelt(package, near):
            yield RuleFinding(
                view.element.value_span("pkg"),
                f"package '{package}' is not installed here, expected it where its nodes run",
                f"install {package}, or source its workspace's setup.bash; what it holds is not checked until then",
                subject=package,
            )
    elif verdict.kind == "no-programs":
        yield RuleFinding(
            view.element.value_span("type"),
            f"package '{package}' holds no programs here, expected '{name}'",
            f"build {package}, or source its workspace's setup.bash; its programs are not checked until then",
            subject=package,
        )


def _script_example(text: str, *programs: str) -> Example:
    launch = make_launch('<node name="driver" pkg="my_robot" type="driver.py"/>')
    files = {"scripts/driver.py": text, "launch/example.launch": launch, **dict.fromkeys(programs, "")}
    return Example(files, ("scripts/driver.py",), {"PATH": "/usr/bin"} if programs else {})


_MANIFEST = """
<package format="2">
  <name>my_robot</name>
  <exec_depend>far_away</exec_depend>
</package>
"""


def _find_unknown_package(view: LaunchedNode) -> Iterable[RuleFinding]:
    package = view.node.package
    if _look_up(view).kind == "no-package":
        near = did_you_mean(package, view.world.package_names())
        if near and is_misspelt(package, near):
            message = f"package '{package}' is not found, expected an installed one"
            yield RuleFinding(view.element.value_span("pkg"), message, f"did you mean {near}?", subject=package)


RULES = (
    Rule(
        id="bad-script",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="The script of a node does not start.",
        explanation="""
The first line of a script (`#!`) names its interpreter. The script does not start when that line is missing, ends with
the carriage return of Windows, or names a program that is not installed, and when the interpreter does not read the
text: `python` and Python 2 are not part of current systems. Scripts of nodes below their package's folder, and programs
in its folder `bin`, are read and compiled; none is run.
""",
        bad=(
            _script_example('«#!/usr/bin/env python3»\r\nprint("hello")\r\n'),
            _script_example('«#!/usr/bin/env python»\nprint("hello")\n', "/usr/bin/python3"),
            _script_example('«print("hello")»\n'),
            _script_example("#!/usr/bin/env python3\n«print 'hello'»\n"),
        ),
        good=(_script_example('#!/usr/bin/env python3\nprint("hello")\n'),),
        node=_find_bad_scripts,
        program=_find_bad_program,
    ),
    Rule(
        id="missing-executable",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="A package does not hold the program of a node.",
        explanation="""
roslaunch looks for an executable file of this name in the package and where the package is installed, and says
"cannot launch node" when it starts, also when the file's mode does not allow to run it. Programs that the package's
CMakeLists.txt builds or installs count as there, and nodes of other computers are left alone.
""",
        bad=(
            launch_example(make_launch('<node name="talker" pkg="demo_nodes" type="«tlker»"/>')),
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
    ),
    Rule(
        id="package-not-installed",
        group=RuleGroup.FILES,
        severity=Severity.WARNING,
        summary="A package that is needed is not installed on this computer.",
        explanation="""
What the launch file takes from that package cannot be checked here. `ur check` lists all such packages in one paragraph
after the other findings.
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
            launch_example(
                make_launch(
                    '<arg name="simulate" default="false"/>',
                    '<include file="«$(find far_away)»/launch/world.launch" if="$(arg simulate)"/>',
                )
            ),
        ),
        good=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker"/>')),
        node=_find_not_installed,
    ),
    Rule(
        id="unknown-package",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="A package cannot be found.",
        explanation="""
`$(find PACKAGE)` and `pkg` name packages that are installed or on ROS_PACKAGE_PATH; packages beside the checked one are
found, too. Only a name that is nearly that of another package is an error; others are reported as
`package-not-installed`, a warning.
""",
        bad=(
            launch_example(make_launch('<rosparam command="load" file="«$(find my_robto)»/params/speed.yaml"/>')),
            launch_example(make_launch('<node name="talker" pkg="«demo_node»" type="talker"/>')),
        ),
        good=launch_examples("""
<launch>
  <arg name="package" default="demo_nodes"/>
  <arg name="other"/>
  <node name="talker" pkg="$(arg package)" type="talker"/>
  <node name="other" pkg="$(arg other)" type="talker"/>
</launch>
"""),
        node=_find_unknown_package,
    ),
)
