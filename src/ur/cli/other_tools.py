"""Commands of other tools, and words that are near to a verb in meaning only: what to type in place of them."""

from __future__ import annotations

_ROS = """use the tool of ROS: {} (once in each shell before: eval "$(ur env)")"""
_VERBS = (
    ("topic topics rostopic echo hz pub", _ROS.format("rostopic list")),
    ("node nodes rosnode", "'ur ps' lists the runs, 'ur graph --live' draws their nodes"),
    ("service services rosservice", _ROS.format("rosservice list")),
    ("param params parameter rosparam", _ROS.format("rosparam list")),
    ("msg srv interface rosmsg rossrv", _ROS.format("rosmsg show TYPE")),
    ("bag rosbag record play", _ROS.format("rosbag record TOPIC")),
    ("pkg rospack", _ROS.format("rospack find PACKAGE")),
    ("tf action", _ROS.format("rostopic echo /tf")),
    ("daemon lifecycle component", "there is none in ROS 1; 'ur ps' lists the runs"),
    ("roslaunch rosrun", "start a launch file: ur launch PACKAGE FILE"),
    ("roscore rosmaster master core", "each run starts a master if there is none: ur run PROGRAM"),
    ("rosdep apt install add download", "install what launch files need: ur get --missing FOLDER"),
    ("catkin catkin_make colcon make compile", "build the workspace: ur build"),
    ("roswtf wtf diagnose", "find what is wrong: ur doctor"),
    ("rqt rqt_graph rosgraph", "draw what runs: ur graph --live"),
    ("rviz rviz2 view viz", "show the robot: ur run rviz_robot, or ur web"),
    ("start exec", "start a program: ur run PROGRAM; 'ur list' lists the programs"),
    ("kill end quit exit down", "end a run: ur stop"),
    ("status top htop running runs jobs", "list the runs: ur ps"),
    ("log tail journal output", "print what a node has printed: ur logs NODE"),
    ("update upgrade self-update pull fetch", "to update a clone: git pull; a wheel: pipx upgrade ubiquity-launches"),
    ("remove uninstall purge", "docs/how-to/uninstall.md has the steps; 'ur get --undo' removes packages"),
    ("push commit checkout diff", "that is a command of git"),
    ("clone search", "find a package: ur get PACKAGE"),
    ("rename hostname", "rename a robot: ur robot rename NAME NEW"),
    ("world worlds", "make a world: ur new world NAME; choose one: ur run PROGRAM world:=office"),
    ("map", "did you mean 'ur maps'?"),
    ("base bases", "make a base: ur new base NAME; choose one: ur use sim:NAME"),
    ("create init generate", "write a file that starts something: ur new"),
    ("lint validate verify", "did you mean 'ur check'?"),
    ("fmt", "did you mean 'ur format'?"),
    ("ssh login connect", "open a shell on a robot: ur shell ROBOT; select one: ur use ROBOT"),
    ("scp rsync copy cp", "synchronise the workspaces: ur sync ROBOT"),
    ("select switch", "select a robot: ur use ROBOT"),
    ("discover scan ping", "list the robots on the network: ur robots"),
    ("page browser gui ui dashboard", "did you mean 'ur web'?"),
    ("sim simulate simulator gazebo stage", "select a simulated robot: ur use sim; then: ur run PROGRAM"),
    ("drive teleop keyboard", "did you mean 'ur run keyboard_drive'?"),
    ("navigate goto go goal nav", "did you mean 'ur run keyboard_navigate'?"),
    ("slam mapping", "did you mean 'ur run make_map'?"),
    ("explore", "did you mean 'ur run make_map explore:=true'?"),
    ("camera image_view", "did you mean 'ur run raspicam_view'?"),
    ("config settings", "show what is selected: ur use; set this computer up: ur setup"),
    ("version", "did you mean 'ur --version'?"),
    ("test", "check launch files: ur check; the project's own tests: ./test"),
)  # fmt: skip
_MAPS = (
    ("join combine concat fuse append", "merge"),
    ("rm remove del erase", "delete"),
    ("mv move name", "rename"),
    ("cp get put pull push send fetch", "copy"),
    ("save write", "export"),
    ("load add open", "import"),
    ("view draw print cat", "show"),
    ("crop change turn", "edit"),
)


def suggest_for(where: str, word: str) -> str | None:
    """Text of a help line for a word after `where` (`ur`, `ur maps`) that other tools know; None for other words."""
    if where == "ur maps":
        if word in ("list", "ls"):
            return "'ur maps' alone lists the maps"
        verb = _find(_MAPS, word)
        return verb and f"did you mean 'ur maps {verb}'?"
    return _find(_VERBS, word) if where == "ur" else None


def _find(table: tuple[tuple[str, str], ...], word: str) -> str | None:
    return next((text for words, text in table if word in words.split()), None)
