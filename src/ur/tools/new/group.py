"""Launch files that include others: m_<name>, rviz_<name>, and the program that starts one."""

from collections.abc import Iterator, Sequence

from ur.tools.new.launch_text import LOCALHOST, hand_on, write_launch
from ur.tools.new.parts import IncludedPart, NewArgument, NewFile

_MACHINES = {
    "robot_machine": NewArgument(
        "robot_machine", "The robot: where everything runs that drives or senses.", default="localhost"
    ),
    "viewer_machine": NewArgument("viewer_machine", "The viewer: where people watch and steer.", default="localhost"),
}
_STANDARD = {
    "robot_base": NewArgument("robot_base", "The base, for example `stage` or `magni`."),
    "robot_variant": NewArgument("robot_variant", "The variant of the base; empty for the plain base.", default=""),
    "simulate": NewArgument(
        "simulate", "`true`: the simulator stands for the robot; `false`: its own driver does.", default="true"
    ),
    "world": NewArgument("world", "The simulated world.", default="maze"),
    **_MACHINES,
}
_RVIZ = """\
Panels:
  - Class: rviz/Displays
    Name: Displays
  - Class: rviz/Views
    Name: Views
Visualization Manager:
  Class: ""
  Displays:
    - {{Class: rviz/Grid, Name: Grid, Enabled: true, Value: true, Cell Size: 1, Plane Cell Count: 20}}
    - {{Class: rviz/RobotModel, Name: RobotModel, Enabled: true, Value: true, Robot Description: robot_description}}
{displays}\
  Enabled: true
  Global Options: {{Fixed Frame: odom, Frame Rate: 30}}
  Name: root
  Tools:
    - {{Class: rviz/Interact}}
    - {{Class: rviz/MoveCamera}}
  Value: true
  Views:
    Current: {{Class: rviz/TopDownOrtho, Name: Current View, Scale: 60, Target Frame: odom, X: 0, Y: 0}}
Window Geometry: {{Height: 800, Width: 1100, X: 60, Y: 60}}
"""
DISPLAYS = {"sensor_msgs/LaserScan": "LaserScan", "sensor_msgs/Range": "Range", "nav_msgs/OccupancyGrid": "Map",
             "nav_msgs/Path": "Path", "sensor_msgs/Image": "Image", "nav_msgs/Odometry": "Odometry",
             "visualization_msgs/MarkerArray": "MarkerArray", "sensor_msgs/PointCloud2": "PointCloud2"}  # fmt: skip


def plan_multi(name: str, summary: str, parts: Sequence[IncludedPart]) -> tuple[NewFile, ...]:
    """Plan a launch file that includes others; their required arguments that no other file sets become its own."""
    arguments: dict[str, NewArgument] = {}
    body: list[str] = []
    for part in parts:
        handed = list(_handed(part, arguments))
        body += (
            [f'<include file="{part.file}">', *hand_on(handed), "</include>"]
            if handed
            else [f'<include file="{part.file}"/>']
        )
    folder = f"m_{name}"
    started = ", ".join(f"`{_stem(part.file)}`" for part in parts)
    text = write_launch(summary, f"It starts {started}.", list(arguments.values()), body)
    return (NewFile(f"{folder}/launch/{folder}.launch.xml", text),)


def _stem(file: str) -> str:
    return file.rpartition("/")[2].removesuffix(".xml").removesuffix(".launch")


def _handed(part: IncludedPart, arguments: dict[str, NewArgument]) -> Iterator[tuple[str, str]]:
    viewer = part.file.rpartition("/")[2].startswith(
        ("rviz_", "n_rviz", "n_teleop_twist_keyboard", "n_keyboard", "n_joy.")
    )
    for theirs, default in part.arguments.items():
        ours = ("viewer_machine" if viewer else "robot_machine") if theirs == "machine" else theirs
        if ours in _STANDARD:
            arguments.setdefault(ours, _STANDARD[ours])
        elif default is None:
            arguments.setdefault(
                ours, NewArgument(ours, part.docs.get(theirs) or f"As {part.file.rpartition('/')[2]} has it.")
            )
        else:
            continue
        yield theirs, ours


def plan_rviz(name: str, summary: str, package: str, topics: Sequence[tuple[str, str]] = ()) -> tuple[NewFile, ...]:
    """Plan a view: its launch file and its RViz configuration.

    `topics` are names and message types; those of types without a display in RViz are left out.
    """
    folder = f"rviz_{name}"
    shown = [(topic, DISPLAYS[kind]) for topic, kind in topics if kind in DISPLAYS]
    displays = "".join(
        f"    - {{Class: rviz/{kind}, Name: {topic.strip('/')}, Enabled: true, Value: true, "
        f"{_topic_key(kind)}: {topic}}}\n"
        for topic, kind in shown
    )
    names = ", ".join(f"`{topic.strip('/')}`" for topic, _ in shown)
    overview = f"It shows the robot{', ' + names if names else ''} in the frame `odom`."
    arguments = [
        NewArgument("machine", "Where RViz runs: the viewer.", default="localhost"),
        NewArgument("node_name", "The name of the node.", default=folder),
        NewArgument("rviz_config", "The configuration file.", default=f"$(find {package})/{folder}/rviz/{name}.rviz"),
    ]
    # RViz reads the path from its arguments only, and roslaunch splits those: the folder may have a blank in its name.
    prefix = "sh -c 'exec &quot;$0&quot; -d &quot;$RVIZ_CONFIG&quot; &quot;$@&quot;'"
    node = (
        f'<node machine="$(arg machine)" name="$(arg node_name)" pkg="rviz" type="rviz" launch-prefix="{prefix}">',
        '  <env name="RVIZ_CONFIG" value="$(arg rviz_config)"/>',
        "</node>",
    )
    return (
        NewFile(
            f"{folder}/launch/{folder}.launch.xml", write_launch(summary, overview, arguments, (*LOCALHOST, *node))
        ),
        NewFile(f"{folder}/rviz/{name}.rviz", _RVIZ.format(displays=displays)),
    )


def _topic_key(display: str) -> str:
    return {"Image": "Image Topic", "MarkerArray": "Marker Topic"}.get(display, "Topic")


def plan_program(name: str, summary: str, package: str, launch: str) -> tuple[NewFile, ...]:
    """Plan a program in `bin` that starts a launch file of its package."""
    text = "\n".join(
        [
            "#!/bin/bash",
            f"##Summary: {' '.join(summary.split())}",
            f"##Overview: Starts `{launch}` on the selected robot.",
            "##",
            f"## Arguments are those of `{launch}`, written `NAME:=VALUE`.",
            f'exec ur launch {package} {launch} "$@"',
            "",
        ]
    )
    return (NewFile(f"bin/ur_{name}", text, executable=True),)
