"""Arguments and examples of every verb, for its help page; a test compares them with the verbs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class HelpPage:
    """Descriptions of a verb's positional arguments, in order, and examples with their meaning."""

    arguments: tuple[str, ...]
    examples: tuple[tuple[str, str], ...]


_RUN = "A run, as 'ur ps' lists it, or the beginning of its name; optional where there is only one."
_ROBOT = "A robot's name, HOST or USER@HOST; the selected robot unless given."
_FILE = "A launch file: its path, or a package and the name of a file in it; then its arguments NAME:=VALUE."
_PATHS = "Files, folders or packages; the current folder unless given."
_NEW = "The name, in lower-case letters, digits and _; asked for unless given."

PAGES: Mapping[str, HelpPage] = {
    "run": HelpPage(
        (
            "A program that 'ur list' names, or PACKAGE/PROGRAM where several packages have one of this name.",
            "Arguments of the program's launch file; 'ur run PROGRAM --help' describes them.",
        ),
        (
            ("ur run keyboard_navigate", "Send the selected robot to places on a map."),
            ("ur run keyboard_navigate world:=office robot_base:=magni", "Choose the world and the robot."),
            ("ur run keyboard_navigate --help", "Describe the arguments of a program."),
        ),
    ),
    "list": HelpPage(
        (),
        (
            ("ur list", "List the programs of every package."),
            ("ur help keyboard_drive", "Describe one of them."),
        ),
    ),
    "launch": HelpPage(
        (f"{_FILE} '-' reads the file from standard input.",),
        (
            ("ur launch my_robot m_wander.launch.xml", "Start a launch file of a package."),
            ("ur launch ./test.launch speed:=0.5 --screen", "Start a file by its path, and show what its nodes print."),
            ("ur launch --detach --wait my_robot m_wander.launch.xml", "Start it and return when every node is up."),
            ("ur launch --ros-args my_robot m_wander.launch.xml", "Print the arguments of the file."),
        ),
    ),
    "ps": HelpPage((), (("ur ps", "List the runs."), ("ur ps --json", "List them for a script."))),
    "attach": HelpPage(
        (_RUN,),
        (
            ("ur attach", "Show the only run."),
            ("ur attach m_wander --plain", "Print the output of a run as lines."),
        ),
    ),
    "logs": HelpPage(
        ("A node of a run; what the run itself reports unless given.",),
        (
            ("ur logs wander", "Print the output of a node."),
            ("ur logs wander --follow --lines 20", "Print the last 20 lines and what follows them."),
        ),
    ),
    "restart": HelpPage(
        ("A node of a run.",),
        (
            ("ur restart wander", "Stop a node and start it again."),
            ("ur restart wander --run m_wander", "Choose among several runs."),
        ),
    ),
    "wait": HelpPage(
        (_RUN,),
        (
            ("ur wait", "Return when every node of the only run is up."),
            ("ur wait m_wander --timeout-ready 60", "Give the nodes a minute."),
        ),
    ),
    "stop": HelpPage(
        (_RUN,),
        (
            ("ur stop", "End the only run."),
            ("ur stop m_wander --node wander", "Stop one node; the run goes on."),
            ("ur stop --all", "End every run of this computer."),
        ),
    ),
    "check": HelpPage(
        (f"{_PATHS} NAME:=VALUE checks with that value of an argument only.",),
        (
            ("ur check", "Check everything below this folder."),
            ("ur check my_robot robot_base:=magni", "Check a package for one base."),
            ("ur check --explain unknown-argument", "Print the page of a rule."),
        ),
    ),
    "new": HelpPage(
        (),
        (
            ("ur new package my_robot", "Write a package for launch files."),
            ("ur new world home --picture plan.png --width 12", "Make a world of a floor plan that is 12 m wide."),
        ),
    ),
    "new node": HelpPage(
        (f"{_NEW} Without n_.", "Arguments of the node's own command line, while it is observed."),
        (
            ("ur new node wander --from-package my_robot --type wander.py", "Write a launch file for a node."),
            ("ur new node joy --from-package joy --type joy_node --no-look", "Write one without starting the node."),
        ),
    ),
    "new multi": HelpPage(
        (f"{_NEW} Without m_.",),
        (
            ("ur new multi wander --include m_robot_base --include n_wander", "Include two launch files."),
            ("ur new multi wander --include n_wander --no-program", "Write no program that starts it."),
        ),
    ),
    "new rviz": HelpPage(
        (f"{_NEW} Without rviz_.",),
        (
            ("ur new rviz wander --topic scan:sensor_msgs/LaserScan", "Show a lidar."),
            ("ur new rviz wander --frame map", "Show everything in the frame of the map."),
        ),
    ),
    "new program": HelpPage(
        (f"{_NEW} Without ur_.",),
        (
            ("ur new program wander", "Write bin/ur_wander, which starts m_wander.launch.xml."),
            ("ur new program tour --launch m_wander.launch.xml", "Start another launch file."),
        ),
    ),
    "new base": HelpPage(
        (_NEW,),
        (
            ("ur new base rover --length 0.5 --width 0.4 --lidar", "Describe a robot with a lidar."),
            ("ur new base rover --like magni", "Begin with the parameter files of another base."),
        ),
    ),
    "new package": HelpPage(
        (_NEW,),
        (
            ("ur new package my_robot", "Write a package, and ask for the rest."),
            ('ur new package my_robot --summary "Programs for my robot."', "Say what it is for."),
        ),
    ),
    "new world": HelpPage(
        ("The name, in letters, digits, - and _; asked for unless given.",),
        (
            ("ur new world room --size 8x6", "Make an empty room of 8 x 6 m."),
            ("ur new world home --picture plan.png --width 12", "Make a world of a floor plan that is 12 m wide."),
        ),
    ),
    "package": HelpPage(
        ("A package or a folder; the current folder unless given.",),
        (("ur package", "Name the dependencies that are missing."), ("ur package --write", "Add them.")),
    ),
    "format": HelpPage(
        (f"{_PATHS} '-' formats standard input to standard output.",),
        (("ur format --diff", "Print what would change."), ("ur format my_robot", "Format a package.")),
    ),
    "find": HelpPage(
        ("The name of an argument, node, topic, parameter or file; * stands for any characters.", _PATHS),
        (
            ("ur find scan", "Find a topic, or anything else of this name."),
            ("ur find 'robot_*' my_robot --kind arg", "Find arguments of a package."),
        ),
    ),
    "docs": HelpPage(
        ("A package or a folder; the current folder unless given.",),
        (
            ("ur docs my_robot", "Write launches.md of a package."),
            ("ur docs my_robot --site /tmp/site", "Make a web site."),
        ),
    ),
    "graph": HelpPage(
        (f"{_FILE} With --live: nodes whose neighbours are drawn.",),
        (
            ("ur graph my_robot m_wander.launch.xml", "Draw what a launch file includes."),
            ("ur graph --topics my_robot m_wander.launch.xml -o wander.svg", "Draw its nodes and topics."),
        ),
    ),
    "explain": HelpPage(
        ("A launch file, the name of a parameter, argument, remap or node in it, and arguments NAME:=VALUE.",),
        (
            ("ur explain my_robot m_wander.launch.xml near", "Explain the value of a parameter."),
            ("ur explain ./test.launch /talker/rate speed:=2", "Explain it for given arguments."),
        ),
    ),
    "use": HelpPage(
        ("The robot to select; the selection is printed unless given.",),
        (
            ("ur use sim:magni:lidar", "Select a simulated Magni with a lidar."),
            ("ur use bob", "Select the robot whose computer answers to bob.local."),
            ("ur use --away bob", "Select a robot that is away and was never set up from here."),
        ),
    ),
    "setup": HelpPage(
        (),
        (("ur setup", "Set this computer up."), ("ur setup --dry-run", "Show what that would change.")),
    ),
    "completion": HelpPage(
        ("bash, zsh or fish; this user's shell unless given.",),
        (
            ('eval "$(ur completion bash)"', "Complete in this shell."),
            ("ur completion fish", "Print the lines for another shell."),
        ),
    ),
    "debian": HelpPage(
        (),
        (
            ("ur debian status", "Print where the root is, and its size."),
            ("ur debian remove", "Delete it."),
        ),
    ),
    "debian status": HelpPage(
        (),
        (
            ("ur debian status", "Print where the root is, and its size."),
            ("ur help debian", "List the other commands."),
        ),
    ),
    "debian shell": HelpPage(
        ("A program with its arguments. Without it: your shell, or bash where the root does not have it.",),
        (
            ("ur debian shell", "Open a shell in the root."),
            ("ur debian shell rosbag info drive.bag", "Run one command there."),
        ),
    ),
    "debian install": HelpPage(
        ("Names of packages of Debian 13.",),
        (
            ("ur debian install gdb", "Install a debugger in the root."),
            ("ur debian install rviz rqt-graph", "Install several packages."),
        ),
    ),
    "debian update": HelpPage(
        (),
        (
            ("ur debian update", "Install newer versions of what is in the root."),
            ("ur help debian install", "Describe how to install other packages."),
        ),
    ),
    "debian remove": HelpPage(
        (),
        (
            ("ur debian remove", "Delete the root."),
            ("ur help debian", "List the other commands."),
        ),
    ),
    "env": HelpPage(
        (),
        (('eval "$(ur env)"', "Make this shell follow the selection."), ("ur env", "Print what that sets.")),
    ),
    "robots": HelpPage(
        (),
        (("ur robots", "List the robots."), ("ur robots --watch", "Show them as they come and go.")),
    ),
    "robot": HelpPage(
        (),
        (
            ("ur robot setup ubuntu@ubuntu.local", "Set a freshly flashed robot up."),
            ("ur robot wifi bob", "Show the wireless networks of a robot."),
        ),
    ),
    "robot setup": HelpPage(
        ("Robots as they answer now; found on the network unless given.",),
        (
            ("ur robot setup ubuntu@ubuntu.local --name bob --base magni", "Set one robot up."),
            ("ur robot setup --from robots.yaml", "Set up every robot that a file names."),
        ),
    ),
    "robot rename": HelpPage(
        ("The robot's present name.", "Its new name."),
        (
            ("ur robot rename bob alice", "Rename a robot."),
            ("ur robot rename bob alice --dry-run", "Show what that would change."),
        ),
    ),
    "robot wifi": HelpPage(
        (_ROBOT,),
        (
            ("ur robot wifi bob", "Show the wireless networks of a robot."),
            ("ur robot wifi bob --ssid Lab", "Join a network."),
        ),
    ),
    "robot network": HelpPage(
        (_ROBOT,),
        (
            ("ur robot network bob", "Show the network devices of a robot."),
            ("ur robot network bob --address 192.168.1.7/24", "Give it a fixed address."),
        ),
    ),
    "image": HelpPage(
        (),
        (
            ("ur image prepare ubuntu.img --name bob", "Prepare an image file."),
            ("ur help image prepare", "Describe every option."),
        ),
    ),
    "image prepare": HelpPage(
        ("An image file, or the device of a flashed card.",),
        (
            ("ur image prepare ubuntu.img.xz --output bob.img --name bob", "Prepare a compressed image."),
            ("ur image prepare /dev/sdb --name bob --ssid Lab", "Prepare a card that is flashed already."),
        ),
    ),
    "doctor": HelpPage(
        (_ROBOT,),
        (("ur doctor", "Check the selected robot and this computer."), ("ur doctor bob", "Check another robot.")),
    ),
    "wifi": HelpPage(
        (_ROBOT,),
        (("ur wifi", "Measure the route to the selected robot."), ("ur wifi bob", "Measure the one to another robot.")),
    ),
    "shell": HelpPage(
        (_ROBOT, "A command to run there; a shell is opened unless given."),
        (("ur shell bob", "Open a shell on a robot."), ("ur shell bob rosnode list", "Run one command there.")),
    ),
    "x": HelpPage(
        ("A robot's name, HOST or USER@HOST.", "The program and its arguments."),
        (("ur x bob xterm", "Open a window of a robot here."), ("ur x bob --check", "Find out whether that works.")),
    ),
    "boot": HelpPage(
        (),
        (
            ("ur boot install robot_base", "Start a program whenever the selected robot boots."),
            ("ur boot status --robot bob", "Show what a robot starts."),
        ),
    ),
    "boot install": HelpPage(
        ("A package and a launch file of it, a program, or a command; then arguments NAME:=VALUE.",),
        (
            ("ur boot install robot_base", "Start a program."),
            ("ur boot install --robot bob my_robot m_wander.launch.xml", "Start a launch file on another robot."),
        ),
    ),
    "boot status": HelpPage(
        (),
        (
            ("ur boot status", "Show what the selected robot starts."),
            ("ur boot status --robot bob", "Show what another one starts."),
        ),
    ),
    "boot log": HelpPage(
        ("A boot service, as 'ur boot status' shows it.",),
        (
            ("ur boot log robot_base", "Print its last lines."),
            ("ur boot log robot_base --follow", "Print what follows as well."),
        ),
    ),
    "boot remove": HelpPage(
        ("Boot services, as 'ur boot status' shows them; all of them unless given.",),
        (
            ("ur boot remove robot_base", "Remove one boot service."),
            ("ur boot remove --robot bob", "Remove all of a robot."),
        ),
    ),
    "sync": HelpPage(
        (_ROBOT, "Files and folders of the workspace; everything unless given."),
        (("ur sync bob --dry-run", "Show what would be copied."), ("ur sync bob", "Copy in both directions.")),
    ),
    "build": HelpPage(
        ("A robot's name, HOST or USER@HOST; this computer unless given.",),
        (("ur build", "Build the workspace of this computer."), ("ur build bob -j 2", "Build that of a robot.")),
    ),
    "mount": HelpPage(
        (_ROBOT,),
        (("ur mount bob", "Mount a robot's workspace at ~/robots/bob."), ("ur mount bob --at /tmp/bob", "Elsewhere.")),
    ),
    "unmount": HelpPage(
        (_ROBOT,),
        (
            ("ur unmount", "Unmount the folders of the selected robot."),
            ("ur unmount bob", "Unmount those of another robot."),
        ),
    ),
}

LAUNCH_GROUPS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("Run and output", ("--detach", "--wait", "--timeout-ready", "--screen", "--log", "--plain", "--calm", "--json",
                        "-v", "--timings")),
    ("Nodes", ("--only", "--except", "--prefix", "--debug", "--required", "--respawn-limit", "--local", "--replace")),
    ("Where somebody else drives the robot", ("--watch", "--ask", "--take-over", "--unattended")),
    ("Answer a question, and start nothing", ("--dry-run", "--ros-args", "--nodes", "--files", "--find-node", "--args",
                                              "--dump-params", "--dump", "--with-origins", "--no-commands")),
    ("Master", ("--core", "--port", "--numworkers", "--timeout", "--master-logger-level")),
    ("Process", ("--pid", "--sigint-timeout", "--sigterm-timeout", "--help")),
)  # fmt: skip
"""The options of `ur launch`, each in one group."""
