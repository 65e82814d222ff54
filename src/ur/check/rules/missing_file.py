"""Rule for missing files that a launch file names."""

from collections.abc import Iterable, Iterator
from itertools import pairwise

from ur.check.queries.executables import is_placeholder
from ur.check.rule import LaunchedNode, ParamView, Rule, RuleFinding, RuleGroup, launch_example
from ur.check.worlds import has_marker
from ur.launchfile.syntax import Element
from ur.launchfile.world import World
from ur.source.arguments import split_words
from ur.source.diagnostic import Severity
from ur.source.suggest import did_you_mean

_DESCRIPTIONS = (".xacro", ".urdf", ".sdf", ".srdf")
_READ = (".rviz", ".yaml")  # endings of files that a node reads, where a variable names one
_CONFIGURATION = ("-d", "--display-config")


def _find_in_arguments(view: LaunchedNode) -> Iterable[RuleFinding]:
    named: list[str] = []
    if view.node.type == "rviz":
        named = _after(_split(view.node.args), _CONFIGURATION)
    elif view.node.type in ("spawn_model", "spawn_entity"):
        named = _after(_split(view.node.args), ("-file",))
    yield from _missing(named, view.element, "args", view.world)
    if view.package is not None and view.package.follows_conventions:
        values = dict(view.node.env)
        for child in view.element.children:
            if not isinstance(child, Element) or child.name != "env":
                continue
            value = values.get(child.attributes.get("name", ""), "")
            if value.endswith(_READ):
                yield from _missing([value], child, "value", view.world)


def _find_in_command(view: ParamView) -> Iterable[RuleFinding]:
    words = _split(view.param.command or "")
    if not words or words[0].rpartition("/")[2] not in ("xacro", "xacro.py", "cat"):
        return ()
    named = [word for word in words[1:] if word.endswith(_DESCRIPTIONS) and ":=" not in word and word[0] != "-"]
    return _missing(named, view.element, "command", view.world)


def _after(words: list[str], options: tuple[str, ...]) -> list[str]:
    return [word for option, word in pairwise(words) if option in options]


def _split(text: str) -> list[str]:
    try:
        return split_words(text)
    except ValueError:
        return []


def _missing(paths: Iterable[str], element: Element, attribute: str, world: World) -> Iterator[RuleFinding]:
    # A path that is written out may be one of the computer where the file is used.
    if "$(" not in element.attributes.get(attribute, ""):
        return
    for path in paths:
        if not path.startswith("/") or has_marker(path) or world.is_file(path) or _is_elsewhere(path, world):
            continue
        folder, _, name = path.rpartition("/")
        near = did_you_mean(name, world.list_folder(folder))
        yield RuleFinding(
            element.value_span(attribute),
            f"{path}: no such file or directory, expected a file",
            f"did you mean {folder}/{near}?" if near else "check the path, or create the file",
            subject=path,
        )


def _is_elsewhere(path: str, world: World) -> bool:
    folder = path
    while folder := folder.rpartition("/")[0]:
        if world.is_file(f"{folder}/package.xml"):
            return is_placeholder(folder, world)
    return False


_PART = """
<launch>
  <param name="speed" value="0.3"/>
</launch>
"""


RULES = (
    Rule(
        id="missing-file",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="A file that is named does not exist.",
        explanation="""
Included launch files, parameter files, robot descriptions (`textfile`, xacro), maps and RViz configurations are looked
for, for every base and variant of the package, and in the branches of options that are off by default. Paths that
depend on something unknown are left alone: required arguments, arguments whose default is no path, and environment
variables that are not set. So are absolute paths outside of packages, which may be those of another computer. A file
that others include is judged with the values that they pass.
""",
        bad=(
            launch_example(
                """
<launch>
  <include file="«$(find my_robot)/launch/prat.launch.xml»"/>
</launch>
""",
                {"launch/part.launch.xml": _PART},
            ),
            launch_example("""
<launch>
  <rosparam command="load" file="«$(find my_robot)/params/none.yaml»"/>
</launch>
"""),
            launch_example("""
<launch>
  <arg name="simulate" default="false"/>
  <param name="robot_description" textfile="«$(find my_robot)/urdf/robot.urdf»" if="$(arg simulate)"/>
</launch>
"""),
            launch_example("""
<launch>
  <param name="robot_description" command="«xacro $(find my_robot)/urdf/robot.xacro»"/>
</launch>
"""),
            launch_example("""
<launch>
  <node name="rviz" pkg="rviz" type="rviz" args="«-d $(find my_robot)/rviz/view.rviz»"/>
</launch>
"""),
            launch_example(
                """
<launch>
  <arg name="robot_base"/>
  <rosparam command="load" file="«$(find my_robot)/params/$(arg robot_base).yaml»"/>
</launch>
""",
                {
                    "bases/loki/base.yaml": "summary: a base\n",
                    "bases/magni/base.yaml": "summary: a base\n",
                    "params/magni.yaml": "speed: 0.3\n",
                },
            ),
        ),
        good=(
            launch_example(
                """
<launch>
  <arg name="robot"/>
  <include file="$(find my_robot)/launch/part.launch.xml"/>
  <include file="$(find my_robot)/launch/$(arg robot).launch.xml"/>
</launch>
""",
                {"launch/part.launch.xml": _PART},
            ),
            launch_example(
                """
<launch>
  <arg name="robot_base"/>
  <rosparam command="load" file="$(find my_robot)/params/$(arg robot_base).yaml"/>
</launch>
""",
                {"bases/magni/base.yaml": "summary: a base\n", "params/magni.yaml": "speed: 0.3\n"},
            ),
        ),
        node=_find_in_arguments,
        param=_find_in_command,
    ),
)
