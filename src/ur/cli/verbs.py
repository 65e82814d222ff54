"""The commands of `ur`: their modules, each imported when it is used, and their summaries."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module

import click

HELP = "Finds, selects and drives small ROS robots, simulated or real, and starts launch files."
EPILOG = "First drive: ur run keyboard_navigate"

# The summary stands here so that `ur --help` imports no verb; a test compares it with the verb's own.
VERBS = {
    "run": ("ur.cli.launch.run", "Run a program on the selected robot."),
    "list": ("ur.cli.launch.list_programs", "List the programs that `ur run` knows."),
    "launch": ("ur.cli.launch.launch", "Start a launch file, in place of roslaunch."),
    "web": ("ur.cli.robots.web", "Show and drive a robot in a browser."),
    "ps": ("ur.cli.runs.ps", "List the runs on this computer."),
    "attach": ("ur.cli.runs.attach", "Show what a run prints, from any terminal."),
    "logs": ("ur.cli.runs.logs", "Print what a node has printed so far."),
    "restart": ("ur.cli.runs.restart", "Stop a node and start it again."),
    "wait": ("ur.cli.runs.wait", "Return when every node of a run is up."),
    "stop": ("ur.cli.runs.stop", "End a run, or one of its nodes."),
    "check": ("ur.cli.files.check", "Check launch files, YAML files and programs."),
    "new": ("ur.cli.files.new", "Write a new node, group, view, program, base, package or world."),
    "get": ("ur.cli.files.get", "Install what launch files need."),
    "package": ("ur.cli.files.package", "Check package.xml and CMakeLists.txt of launch files."),
    "format": ("ur.cli.files.format", "Put launch files into a standard order and layout."),
    "find": ("ur.cli.files.find", "Find where a name in launch files is defined and used."),
    "docs": ("ur.cli.files.docs", "Write documents of launch files: one page, or a web site."),
    "graph": ("ur.cli.files.graph", "Draw what a launch file includes and starts, or what runs."),
    "explain": ("ur.cli.files.explain", "Explain where a name in a launch file got its value."),
    "maps": ("ur.cli.maps.maps", "List, show, edit and exchange the maps that robots have made."),
    "use": ("ur.cli.robots.use", "Select a robot, or show which one is selected."),
    "setup": ("ur.cli.computer.setup", "Set this computer up: shells, keys, workspace, names."),
    "robots": ("ur.cli.robots.robots", "List the robots on the network, and those known but away."),
    "shell": ("ur.cli.robots.shell", "Open a shell on a robot, or run one command there."),
    "x": ("ur.cli.robots.x", "Run a program on a robot with its windows here."),
    "sync": ("ur.cli.robots.sync", "Synchronise the workspaces of this computer and robots."),
    "build": ("ur.cli.robots.build", "Build the catkin workspace here or on robots."),
    "mount": ("ur.cli.robots.mount", "Mount a folder of a robot here."),
    "unmount": ("ur.cli.robots.unmount", "Unmount the folders of a robot."),
    "doctor": ("ur.cli.computer.doctor", "Find what is wrong between this computer and a robot."),
    "devices": ("ur.cli.robots.devices", "List the devices of this computer or a robot."),
    "wifi": ("ur.cli.robots.wifi", "Measure the connection to a robot: signal of both, latency, loss."),
    "robot": ("ur.cli.robot_setup.robot", "Set robots up and change them, over the network."),
    "image": ("ur.cli.robot_setup.image", "Prepare images for the first boot of robots."),
    "boot": ("ur.cli.robots.boot", "Choose what a robot starts when it boots."),
    "completion": ("ur.cli.computer.completion", "Print the lines that let a shell complete `ur` with Tab."),
    "debian": ("ur.cli.computer.debian", "Inspect, change or remove the Debian root that ROS runs in."),
    "env": ("ur.cli.computer.env", "Print the lines that let a shell follow the selection."),
}


@dataclass(frozen=True, slots=True)
class HelpPage:
    """Descriptions of a verb's positional arguments, in order, and examples with their meaning."""

    arguments: tuple[str, ...]
    examples: tuple[tuple[str, str], ...]


class VerbGroup(click.Group):
    """The verbs, each imported when it is used."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """The names, most important first."""
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002 - click's signature
        """Import a verb."""
        return load_verb(cmd_name) if cmd_name in VERBS else None


def load_verb(name: str) -> click.Command:
    """The command behind a verb's name: `command` of its module."""
    verb = import_module(VERBS[name][0]).command
    assert isinstance(verb, click.Command)
    return verb
