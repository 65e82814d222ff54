"""Arguments and examples of every verb, for its help page; a test compares them with the verbs."""

from __future__ import annotations

from collections.abc import Mapping

from ur.cli.robot_help_pages import ROBOT_PAGES
from ur.cli.verbs import HelpPage

_RUN = "A run, as 'ur ps' lists it, or the beginning of its name; optional where there is only one."
_FILE = "A launch file: its path, or a package and the name of a file in it; then its arguments NAME:=VALUE."
_PATHS = "Files, folders or packages; the current folder unless given."
_MAP = "The name of a map, as 'ur maps' lists it."
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
            ("ur run keyboard_navigate --web", "Send it there in a browser."),
            ("ur run keyboard_navigate --foxglove", "The same, and see its topics in Foxglove or Lichtblick."),
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
    "maps": HelpPage(
        (),
        (
            ("ur maps show flat", "Draw a map; 'ur maps' alone lists all."),
            ("ur maps copy flat --from bob", "Copy a map that bob has made to this computer."),
        ),
    ),
    "maps show": HelpPage(
        (_MAP,),
        (
            ("ur maps show flat", "Draw a map."),
            ("ur maps show latest", "Draw the last map that the robot of this computer has made."),
        ),
    ),
    "maps rename": HelpPage(
        (_MAP, "A name that no map has."),
        (
            ("ur maps rename map-2026-05-01 flat", "Name a map."),
            ("ur maps rename flat old-flat", "Make room for another one."),
        ),
    ),
    "maps delete": HelpPage(
        (_MAP,),
        (
            ("ur maps delete flat", "Delete a map after a question."),
            ("ur maps delete flat attic --yes", "Delete two without one."),
        ),
    ),
    "maps export": HelpPage(
        (_MAP, "The path of the files; their ending is .yaml, .png or .pgm, or left out."),
        (
            ("ur maps export flat ~/flat.yaml", "Write flat.yaml and flat.png."),
            ("ur maps export flat ~/flat.pgm", "Write flat.yaml and flat.pgm."),
        ),
    ),
    "maps import": HelpPage(
        ("A YAML file of map_server, or the folder of a map.", "Its name here; that of the file unless given."),
        (
            ("ur maps import ~/catkin_ws/src/maps/office.yaml", "Take in a map under the name office."),
            ("ur maps import map.yaml flat", "Choose its name."),
        ),
    ),
    "maps edit": HelpPage(
        (
            _MAP,
            "The change: rotate, origin, erase, wall, keep-out, zone or place.",
            "Its numbers, in metres and degrees; before them the name of a place or zone.",
        ),
        (
            ("ur maps edit flat rotate", "Turn a map so that its walls lie along the axes."),
            ("ur maps edit flat erase 1.5 2 2.5 3", "Erase what stands in a rectangle."),
            ("ur maps edit flat wall 0 0 0 2.5", "Draw a wall."),
            ("ur maps edit flat zone stairs keep-out 1 2 3 4", "Keep out of a rectangle."),
            ("ur maps edit flat zone hall 40 5 0 9 3", "Drive at 40 % of the highest speed there."),
            ("ur maps edit flat place door 1 2 90", "Name a place."),
        ),
    ),
    "maps merge": HelpPage(
        ("The map whose frame the new one has.", "The map that is laid on it."),
        (
            ("ur maps merge flat attic --as house", "Join two maps that share some floor."),
            ("ur maps merge flat map-2026-11-01 --as flat-2", "Bring a map up to date with a later one."),
        ),
    ),
    "maps copy": HelpPage(
        (_MAP,),
        (
            ("ur maps copy flat --from bob", "Copy a map that bob has made to this computer."),
            ("ur maps copy flat --to alice", "Let another robot navigate on it."),
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
        (_NEW, "Arguments of the xacro file that --from names; the others have its defaults."),
        (
            ("ur new base rover --length 0.5 --width 0.4 --lidar", "Describe a robot with a lidar."),
            ("ur new base rover --like magni", "Begin with the parameter files of another base."),
            ("ur new base rover --from rover.urdf --workspace ~/rover", "Read it from the description of a robot."),
            ("ur new base rover --from rover.urdf.xacro colour:=red", "Expand it with an argument."),
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
    **ROBOT_PAGES,
}

LAUNCH_GROUPS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("Run and output", ("--detach", "--wait", "--timeout-ready", "--screen", "--log", "--plain", "--calm", "--json",
                        "-v", "--timings")),
    (
        "Nodes",
        (
            *("--only", "--except", "--no-terminal", "--prefix", "--debug", "--required", "--respawn-limit"),
            *("--local", "--replace"),
        ),
    ),
    ("Where somebody else drives the robot", ("--watch", "--ask", "--take-over", "--unattended")),
    ("Answer a question, and start nothing", ("--dry-run", "--ros-args", "--nodes", "--files", "--find-node", "--args",
                                              "--dump-params", "--dump", "--with-origins", "--no-commands")),
    ("Master", ("--core", "--port", "--numworkers", "--timeout", "--master-logger-level")),
    ("Process", ("--pid", "--sigint-timeout", "--sigterm-timeout", "--help")),
)  # fmt: skip
"""The options of `ur launch`, each in one group."""
