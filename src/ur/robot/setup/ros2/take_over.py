"""The remap of a base's driver, so that only the mux commands it: the files for it, or why it is impossible. Pure.

The driver's unit gets a drop-in: its node, or all nodes of its launch file, are remapped to other velocity topics.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from ur.robot.boot.units import FOLDER, PREFIX, UnitFile, launch_line, program_unit, source_line
from ur.robot.robot_file import Ros2Robot
from ur.robot.ros2.seen_graph import TWISTS, Process, Ros2, SeenGraph, SeenTopic

SUFFIX = "_base"  # of the topics that the base takes then
MUX_NODE = "cmd_vel_mux"
LAUNCH_FILE = "/etc/ubiquity/base.launch.py"
MARK = "# Written by ur robot setup --take-over"
DROP_IN = "50-ubiquity.conf"
_LAUNCH = re.compile(r"\bros2 launch (?:(?P<package>[A-Za-z0-9_]{1,80}) )?(?P<file>[\w./-]{1,200}\.(?:py|xml|yaml))")
_RUN = re.compile(r"\bros2 run [A-Za-z0-9_]{1,80} [\w./-]{1,80}(?: [^;&|]*)?")
_QUOTES = "'\" "
_LAUNCH_TEXT = """\
{mark}: all nodes of the launch file take these topics.
from launch import LaunchDescription
from launch.actions import GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch_ros.actions import SetRemap
from ros2launch.api import get_share_file_path_from_package

REMAPS = {remaps!r}


def generate_launch_description():
    path = {path}
    remaps = [SetRemap(src=name, dst=target) for name, target in REMAPS.items()]
    return LaunchDescription([GroupAction([*remaps, IncludeLaunchDescription(AnyLaunchDescriptionSource(path))])])
"""


@dataclass(frozen=True, slots=True)
class Driver:
    """The driver of a base: its unit, the processes of that unit, and the velocity topics of the base by their types.

    The topics have the names that programs use, also after the mux has taken them over. `unit` is '' if the driver
    cannot be remapped; `reason` tells why.
    """

    unit: str
    argv: tuple[str, ...]
    topics: Mapping[str, str]
    reason: str = ""


@dataclass(frozen=True, slots=True)
class TakeOver:
    """The files of a take-over by their paths; `topics` are those of the base under the names that programs use."""

    unit: str
    topics: tuple[str, ...]
    files: Mapping[str, str]


def list_topics(graph: SeenGraph, commands: str) -> dict[str, str]:
    """Return the velocity topics of the base that subscribes to `commands`, with types; the mux is ignored."""

    def takers(topic: SeenTopic) -> set[str]:
        ends = (end for end in topic.subscribers if end.kind in TWISTS)
        return {end.node for end in ends if end.node.rpartition("/")[2] != MUX_NODE}

    base = next((takers(topic) for topic in graph.topics if topic.name == commands), set())
    return {
        topic.name: next(end.kind for end in topic.subscribers if end.kind in TWISTS and end.node in base)
        for topic in graph.topics
        if takers(topic) & base
    }


def find_driver(found: Ros2, commands: str) -> Driver:
    """Find the driver that subscribes to `commands`."""
    graph = found.graph or SeenGraph()
    topics = {name.removesuffix(SUFFIX): kind for name, kind in list_topics(graph, commands).items()}
    names = {
        end.node.rpartition("/")[2]
        for topic in graph.topics
        if topic.name == commands
        for end in topic.subscribers
        if end.kind in TWISTS
    }

    def fail(reason: str) -> Driver:
        return Driver("", (), topics, reason)

    if not topics:
        return fail(f"no node takes {commands}")
    by_unit: dict[str, list[Process]] = {}
    for each in found.processes:
        by_unit.setdefault(each.unit, []).append(each)
    units = {unit for unit in by_unit if unit and not unit.startswith(PREFIX)}
    named = {unit for unit in units if any(f"__node:={name}" in each.argv for name in names for each in by_unit[unit])}
    if len(named or units) != 1:
        where = f"its driver is one of {', '.join(sorted(units))}" if units else "no unit of the system runs its driver"
        return fail(where)
    unit = next(iter(named or units))
    return Driver(unit, tuple(each.argv for each in by_unit[unit]), topics)


def plan_take_over(driver: Driver, texts: Mapping[str, str]) -> TakeOver | str:
    """Plan the files of a take-over; return the reason if it is impossible.

    `texts` are the unit's files by their paths.
    """
    if not driver.unit:
        return driver.reason
    lines = [line for path, text in texts.items() if not path.endswith(f"/{DROP_IN}") for line in read_starts(text)]
    if len(lines) != 1:
        return f"{driver.unit} has {len(lines)} lines ExecStart=, expected one"
    remaps = {name: name + SUFFIX for name in driver.topics}
    line, files = lines[0], {}
    if launch := _LAUNCH.search(line):
        start = line[: launch.start()] + f"ros2 launch {LAUNCH_FILE}" + line[launch.end() :]
        files[LAUNCH_FILE] = launch_text(launch["package"] or "", launch["file"], remaps)
    else:
        added = " --ros-args " + " ".join(f"-r {name}:={target}" for name, target in remaps.items())
        end = len(line.rstrip(_QUOTES))
        node = line[:end]
        if not any(node.endswith(argv.removesuffix(added)) for argv in driver.argv if argv) and not _RUN.search(node):
            return f"ExecStart= of {driver.unit} shows neither its node nor a launch file"
        start = node + added + line[end:]
    text = f"{MARK}: the mux alone reaches the base.\n[Service]\nExecStart=\nExecStart={start}\n"
    return TakeOver(driver.unit, tuple(remaps), {**files, f"{FOLDER}/{driver.unit}.d/{DROP_IN}": text})


def read_starts(text: str) -> list[str]:
    """Return the commands of the lines ExecStart= of a unit file, except those before an empty one."""
    starts: list[str] = []
    for line in text.replace("\\\n", " ").splitlines():
        name, _, value = line.strip().partition("=")
        if name.strip() == "ExecStart":
            starts = [*starts, value.strip()] if value.strip() else []
    return starts


def launch_text(package: str, file: str, remaps: Mapping[str, str]) -> str:
    """Return a launch file that includes another one and remaps topics of its nodes."""
    path = f"get_share_file_path_from_package(package_name={package!r}, file_name={file!r})" if package else repr(file)
    return _LAUNCH_TEXT.format(mark=MARK, remaps=dict(remaps), path=path)


def mux_unit(robot: str, base: str, variant: str, ros2: Ros2Robot, user: str, home: str) -> UnitFile:
    """Return the unit of the mux, which subscribes to `ros2.commands` in place of the base."""
    values = {"robot_base": base, "robot_variant": variant, "cmd_vel": ros2.commands}
    values["takes_over"] = ros2.commands.removesuffix(SUFFIX)
    arguments = [f"{name}:={value}" for name, value in values.items() if value]
    line = launch_line("ubiquity_launches", "n_cmd_vel_mux.launch.xml", arguments, roslaunch=False)
    return program_unit(MUX_NODE, f"{source_line(ros2, robot)}; {line}", user, home, master=False)
