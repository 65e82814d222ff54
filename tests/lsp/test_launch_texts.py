"""Places in launch files of ROS 2, in Python, YAML and XML: values, definitions, candidates and uses."""

from pathlib import Path

import pytest

from ur.check.worlds import make_world
from ur.lsp.completion import complete
from ur.lsp.definitions import find_definitions, find_references
from ur.lsp.hover import describe_at
from ur.lsp.workspace import Workspace
from ur.source.file import Span
from ur.tools.find.arguments import apply_rename, rename_argument

TOP = """import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PythonExpression
from launch_ros.actions import Node


def generate_launch_description():
    speed = LaunchConfiguration('speed')
    share = get_package_share_directory('demo')
    return LaunchDescription([
        DeclareLaunchArgument('speed', default_value='2', choices=['1', '2'], description='How fast.'),
        Node(package='demo', executable='drive', parameters=[{'v': speed}, os.path.join(share, 'config', 'a.yaml')]),
        Node(package='demo', executable='stop', name=PythonExpression(['"s" + str(', speed, ' + 1)'])),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(share, 'launch', 'part.launch.py')),
            launch_arguments={'mode': 'fast'}.items(),
        ),
    ])
"""
PART = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('mode', default_value='slow', description='Its mode.'),
        Node(package='demo', executable='stop', name=LaunchConfiguration('mode')),
    ])
"""
YAML = """launch:
- arg:
    name: 'size'
    default: '3'
- node:
    pkg: demo
    exec: drive
    name: size_$(var size)
- include:
    file: $(find-pkg-share demo)/launch/part.launch.py
    arg:
    - name: mode
      value: fast
"""
XML = """<launch>
  <arg name="size" default="4"/>
  <node pkg="demo" exec="drive" name="n$(eval '1 + $(var size)')"/>
  <include file="$(find-pkg-share demo)/launch/part.launch.py"><arg name="mode" value="x"/></include>
</launch>
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "demo"
    for name, text in {
        "package.xml": "<package><name>demo</name></package>",
        "config/a.yaml": "/**: {ros__parameters: {}}",
        "launch/top.launch.py": TOP,
        "launch/part.launch.py": PART,
        "launch/size.launch.yaml": YAML,
        "launch/size.launch.xml": XML,
        "scripts/drive": "#!/bin/sh\n",
        "scripts/stop": "#!/bin/sh\n",
    }.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
        (folder / name).chmod(0o755 if text.startswith("#!") else 0o644)
    return folder


@pytest.fixture
def workspace(package: Path) -> Workspace:
    return Workspace([str(package)], lambda places: make_world(places, {}))


def place(package: Path, name: str, near: str, text: str | None = None) -> tuple[str, int]:
    """Return a path and the offset at `|` in `near`."""
    path = package / "launch" / name
    text = path.read_text() if text is None else text
    return str(path), text.index(near.replace("|", "")) + near.index("|")


HOVERS = {
    ("top.launch.py", "LaunchConfiguration('sp|eed"): "**speed**\n\nHow fast.\n\none of 1, 2\n\nvalue: `2`",
    ("top.launch.py", "{'v': sp|eed}"): "value: `2`",
    ("top.launch.py", "Python|Expression(["): "value: `s3`",
    ("top.launch.py", "{'mo|de'"): "**mode**\n\nIts mode.\n\nvalue: `fast`",
    ("top.launch.py", "directory('de|mo"): "package in `{package}`",
    ("top.launch.py", "='dri|ve'"): "runs `{package}/scripts/drive`",
    ("top.launch.py", "'a.y|aml'"): "`{package}/config/a.yaml`",
    ("size.launch.yaml", "(var si|ze"): "**size**\n\nvalue: `3`",
    ("size.launch.yaml", "pkg: de|mo"): "package in `{package}`",
    ("size.launch.yaml", "exec: dri|ve"): "runs `{package}/scripts/drive`",
    ("size.launch.yaml", "- name: mo|de"): "**mode**\n\nIts mode.\n\nvalue: `fast`",
    ("size.launch.xml", "(var si|ze"): "**size**\n\nvalue: `4`",
    ("size.launch.xml", "$(ev|al"): "value: `5`",
    ("size.launch.xml", "share de|mo"): "package in `{package}`",
}


@pytest.mark.parametrize(("name", "near"), HOVERS)
def test_hover_shows_the_value(workspace: Workspace, package: Path, name: str, near: str) -> None:
    found = describe_at(workspace, *place(package, name, near))
    assert found is not None
    assert found[0] == HOVERS[name, near].format(package=package)


def test_hover_works_while_the_text_is_broken(workspace: Workspace, package: Path) -> None:
    path, offset = place(package, "top.launch.py", "{'v': sp|eed}")
    assert describe_at(workspace, path, offset) is not None
    broken = TOP.replace("    share = ", "    share = (((\n")
    workspace.set_text(path, broken)
    found = describe_at(workspace, *place(package, "top.launch.py", "{'v': sp|eed}", broken))
    assert found is not None
    assert found[0] == "value: `2`"


def test_hover_follows_what_is_typed(workspace: Workspace, package: Path) -> None:
    path, offset = place(package, "top.launch.py", "LaunchConfiguration('sp|eed")
    describe_at(workspace, path, offset)
    workspace.set_text(path, TOP.replace("default_value='2'", "default_value='1'"))
    found = describe_at(workspace, path, offset)
    assert found is not None
    assert found[0].endswith("value: `1`")


DEFINITIONS = {
    ("top.launch.py", "LaunchConfiguration('sp|eed"): ("launch/top.launch.py", "'speed'"),
    ("top.launch.py", "{'mo|de'"): ("launch/part.launch.py", "'mode'"),
    ("top.launch.py", "directory('de|mo"): ("package.xml", ""),
    ("top.launch.py", "'part.la|unch.py"): ("launch/part.launch.py", ""),
    ("top.launch.py", "='dri|ve'"): ("scripts/drive", ""),
    ("size.launch.yaml", "part.la|unch.py"): ("launch/part.launch.py", ""),
    ("size.launch.yaml", "(var si|ze"): ("launch/size.launch.yaml", "'size'"),
    ("size.launch.xml", "part.la|unch.py"): ("launch/part.launch.py", ""),
    ("size.launch.xml", "(var si|ze"): ("launch/size.launch.xml", "size"),
}


@pytest.mark.parametrize(("name", "near"), DEFINITIONS)
def test_definition_is_found(workspace: Workspace, package: Path, name: str, near: str) -> None:
    (found,) = find_definitions(workspace, *place(package, name, near))
    file, text = DEFINITIONS[name, near]
    assert (found.file.path, found.text) == (str(package / file), text)


COMPLETIONS = {
    ("top.launch.py", "{'v': speed}", "{'v': LaunchConfiguration('s|"): ["speed"],
    ("top.launch.py", "package='demo', executable='drive'", "package='demo', executable='d|'"): ["drive"],
    ("top.launch.py", "package='demo', executable='drive'", "package='d|'"): ["demo"],
    ("top.launch.py", "{'mode': 'fast'}.items()", "{'m|"): ["mode"],
    (
        "top.launch.py",
        "os.path.join(share, 'config', 'a.yaml')",
        "os.path.join(FindPackageShare('demo'), 'config', '|'",
    ): ["a.yaml"],
    ("size.launch.yaml", "pkg: demo", "pkg: d|"): ["demo"],
    ("size.launch.yaml", "exec: drive", "exec: s|"): ["stop"],
    ("size.launch.yaml", "$(var size)", "$(var s|"): ["size"],
    ("size.launch.yaml", "part.launch.py", "p|"): ["part.launch.py"],
    ("size.launch.yaml", "- name: mode", "- name: m|"): ["mode"],
    ("size.launch.xml", "$(var size)", "$(var s|"): ["size"],
    ("size.launch.xml", 'exec="drive"', 'exec="d|"'): ["drive"],
    ("size.launch.xml", '<arg name="mode"', '<arg name="m|"'): ["mode"],
    ("size.launch.xml", "launch/part.launch.py", "launch/pa|"): ["part.launch.py"],
}


@pytest.mark.parametrize(("name", "old", "new"), COMPLETIONS)
def test_candidates_are_offered(workspace: Workspace, package: Path, name: str, old: str, new: str) -> None:
    path, _ = place(package, name, "|launch")
    text = Path(path).read_text()
    describe_at(workspace, path, 0)
    before, _, after = text.partition(old)
    head, _, tail = new.partition("|")
    workspace.set_text(path, before + head + tail + after)
    assert [each.label for each in complete(workspace, path, len(before + head))] == COMPLETIONS[name, old, new]


KEYWORDS = {
    "Node(|": ["executable", "additional_env"],
    "Node(package='demo', exe|)": ["executable", "exec_name"],
    "Node(package='demo (a', # (\n    n|)": ["name", "namespace"],
    "Node(\n  parameters=[{'a': 1}],\n  par|ameters=[])": [],
    "launch_ros.actions.Node(re|, name='a', respawn=True)": ["remappings", "respawn_delay", "respawn_max_retries"],
    "Node(parameters=[re|": [],
    "Node(name|": ["name", "namespace"],
    "Node(name=LaunchConfiguration('a'), names|pace=1)": [],
    "Node(name=LaunchConfiguration('a'), names| =1)": ["namespace"],
    "DeclareLaunchArgument('a', d|": ["default_value", "description"],
    "other(n|": [],
    "x = Node(a=1).n|": [],
}


@pytest.mark.parametrize("text", KEYWORDS)
def test_arguments_of_a_call_are_offered(workspace: Workspace, package: Path, text: str) -> None:
    path, _ = place(package, "top.launch.py", "|launch")
    head, _, tail = f"def generate_launch_description():\n    {text}".partition("|")
    workspace.set_text(path, head + tail)
    found = complete(workspace, path, len(head))
    assert [each.label for each in found][: 2 if text == "Node(|" else None] == KEYWORDS[text]
    assert all(each.insert == (each.label if tail.lstrip().startswith("=") else f"{each.label}=") for each in found)


def test_argument_of_a_call_has_its_type_and_meaning(workspace: Workspace, package: Path) -> None:
    path, _ = place(package, "top.launch.py", "|launch")
    workspace.set_text(path, "Node(exec")
    first = complete(workspace, path, 9)[0]
    assert (first.label, first.help, first.document) == ("executable", "required", "text: the program of the package")


def test_argument_is_renamed_over_files(workspace: Workspace, package: Path) -> None:
    path, offset = place(package, "top.launch.py", "{'mo|de'")
    spans = find_references(workspace, path, offset)
    assert sorted(Path(each.file.path).name for each in spans) == [
        "part.launch.py", "part.launch.py", "size.launch.xml", "size.launch.yaml", "top.launch.py",
    ]  # fmt: skip
    part = str(package / "launch" / "part.launch.py")
    renamed = apply_rename(rename_argument(part, "mode", "kind", workspace.views, workspace.world), "kind")
    assert {Path(file).name: text for file, text in renamed.items()} == {
        "part.launch.py": PART.replace("'mode'", "'kind'"),
        "top.launch.py": TOP.replace("'mode'", "'kind'"),
        "size.launch.yaml": YAML.replace("mode", "kind"),
        "size.launch.xml": XML.replace('"mode"', '"kind"'),
    }


def test_mistake_is_reported_where_it_is_written(workspace: Workspace, package: Path) -> None:
    path = str(package / "launch" / "top.launch.py")
    workspace.set_text(path, TOP.replace("executable='drive'", "node_executable='drive'"))
    for _ in workspace.steps([path]):
        pass
    spans = [each.span for each in workspace.findings_of(path) if each.rule == "launch-argument"]
    assert [span.text for span in spans if isinstance(span, Span)] == ["node_executable"]
