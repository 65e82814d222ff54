"""Rules about launch files in Python, and what launch files of ROS 2 construct; reported while these are resolved."""

from ur.check.rule import Example, Rule, RuleGroup, launch_example
from ur.source.diagnostic import Severity

_FILE = "launch/example.launch.py"
_NODE = 'Node(package="demo_nodes", executable="talker")'
_COMPONENTS = (
    "from launch_ros.actions import LoadComposableNodes, Node\nfrom launch_ros.descriptions import ComposableNode"
)


def _file(*lines: str, imports: str = "from launch_ros.actions import Node") -> Example:
    body = (f"    {line}" for line in lines)
    head = ("from launch import LaunchDescription", imports, "", "", "def generate_launch_description():")
    return launch_example("\n".join((*head, *body)), name=_FILE)


def _describing(entity: str) -> Example:
    return _file(f"return LaunchDescription([{entity}])")


def _with_file(place: str, text: str) -> Example:
    files = place.replace("HERE", '["/etc/talker.yaml"]')
    talker = f'talker = Node(package="demo_nodes", executable="talker", name="talker", parameters={files})'
    return Example({**_file(talker, "return LaunchDescription([talker])").files, "/etc/talker.yaml": text})


def _components(component: str, *others: str) -> Example:
    return _file(
        *others,
        f'parts = [{component}(package="demo_nodes", plugin="demo::Filter")]',
        'load = LoadComposableNodes(target_container="filters", composable_node_descriptions=parts)',
        f"return LaunchDescription([{'start, ' if others else ''}load])",
        imports=_COMPONENTS,
    )


RULES = (
    Rule(
        id="launch-argument",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.ERROR,
        summary="A class of the launch API has no argument of this name, or lacks one.",
        explanation="""
Python raises TypeError, and nothing of the file starts. `node_executable`, `node_name`, `node_namespace` and
`node_plugin` were removed years ago: the names are `executable`, `name`, `namespace` and `plugin`.
""",
        bad=(_describing('Node(package="demo_nodes", «node_executable»="talker")'),),
        good=(_describing(_NODE),),
    ),
    Rule(
        id="launch-function",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.ERROR,
        summary="A Python launch file has no usable generate_launch_description().",
        explanation="""
`ros2 launch` imports the file, and calls this function without arguments. It returns a LaunchDescription.
""",
        bad=(launch_example("«i»mport launch", name=_FILE),),
        good=(_describing(_NODE),),
    ),
    Rule(
        id="launch-import",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.ERROR,
        summary="A module of the launch API does not have the imported name.",
        explanation="""
Actions, conditions, substitutions and event handlers have modules of their own.
""",
        bad=(
            launch_example(
                "from launch.actions import «LaunchDescription»\n\n\n"
                "def generate_launch_description():\n    return LaunchDescription([])",
                name=_FILE,
            ),
        ),
        good=(_describing(_NODE),),
    ),
    Rule(
        id="launch-value",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.ERROR,
        summary="An argument of the launch API has a value of the wrong kind.",
        explanation="""
An action where a text or substitution is needed, parameters or remappings that are no list of pairs, a condition that
is none, and the like: the launch fails when it gets to this place.
""",
        bad=(_describing('Node(package="demo_nodes", executable="talker", remappings=«[("chatter",)]»)'),),
        good=(_describing('Node(package="demo_nodes", executable="talker", remappings=[("chatter", "news")])'),),
    ),
    Rule(
        id="parameter-file",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.WARNING,
        summary="A parameter file has no `ros__parameters`.",
        explanation="""
The values of a node stand below its name and `ros__parameters`. A node that gets another file ends when it starts.
""",
        bad=(_with_file("«HERE»", "talker:\n  rate: 5\n"),),
        good=(_with_file("HERE", "talker:\n  ros__parameters:\n    rate: 5\n"),),
    ),
    Rule(
        id="parameter-section",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.WARNING,
        summary="The only parameter file of a node has no section for it, and one with nearly its name.",
        explanation="""
The node starts with its defaults: sections for others are skipped without a word. Files with sections for many nodes
are left alone.
""",
        bad=(_with_file("«HERE»", "talkr:\n  ros__parameters:\n    rate: 5\n"),),
        good=(_with_file("HERE", "/**/talker:\n  ros__parameters:\n    rate: 5\n"),),
    ),
    Rule(
        id="python-syntax",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.ERROR,
        summary="A launch file is not valid Python.",
        explanation="""
Nothing else is reported about such a file.
""",
        bad=(_file("return LaunchDescription(«]»)"),),
        good=(_describing(_NODE),),
    ),
    Rule(
        id="undefined-name",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.ERROR,
        summary="A Python launch file uses a name that it neither imports nor assigns before.",
        explanation="""
Python raises NameError, and nothing of the file starts.
""",
        bad=(_describing("«talker»"),),
        good=(_file(f"talker = {_NODE}", "return LaunchDescription([talker])"),),
    ),
    Rule(
        id="unknown-container",
        group=RuleGroup.LAUNCH_API,
        severity=Severity.WARNING,
        summary="Components are loaded into a container that the launch file does not start.",
        explanation="""
They wait for its service without an end, unless something else starts a container of this name. Names that an argument
chooses are left alone, and so are files with parts that are not known.
""",
        bad=(_components("«ComposableNode»"),),
        good=(
            _components(
                "ComposableNode",
                'start = Node(package="rclcpp_components", executable="component_container", name="filters")',
            ),
        ),
    ),
)
