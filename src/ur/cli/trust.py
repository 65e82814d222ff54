"""Declarations of what each command of `ur` trusts: what it reads, starts, sends and writes.

`tools/make_trust_table.py` makes the table of docs/explain/security.md of this. Tests compare the declarations of
commands that start and send nothing with what these commands do.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

NOTHING = "nothing"
_LAUNCH = "launch files, YAML files and packages"
_ROBOT = "the robot, by ssh with a known host key"


@dataclass(frozen=True, slots=True)
class Trust:
    """Input, started programs, sent data with its receiver, and written files of a command; each a phrase, or NOTHING.

    `starts` are programs that are not parts of `ur`.
    """

    reads: str
    starts: str = NOTHING
    sends: str = NOTHING
    writes: str = NOTHING


_ASK_RUN = Trust("the answers of a run of yours, over its socket", sends="a request to that run, on this computer")
_START = Trust(
    _LAUNCH,
    starts="the nodes of the file, programs of `<param command>`, a ROS master; `sudo apt-get` for missing packages, "
    "after a question",
    sends="ROS: registrations and parameters, to the master; the command's arguments to a selected robot, by ssh",
    writes="logs and `~/.ros`",
)

TRUST: Mapping[str, Trust] = {
    "run": _START,
    "list": Trust(
        "programs of your packages, as text", sends="a question to the ROS master", writes="a cache in `~/.cache`"
    ),
    "launch": _START,
    "web": Trust(
        "requests of browsers",
        starts="commands of `ur`, for pages whose login may drive; nodes of the page",
        sends="the page, to browsers with a login; ROS: registrations, to the master of the selected robot",
        writes="sessions as hashes, `web.log`",
    ),
    "ps": Trust("records of your runs, and who runs on the selected master", sends="questions to the ROS master"),
    "attach": _ASK_RUN,
    "logs": Trust("log files of your runs"),
    "restart": _ASK_RUN,
    "wait": _ASK_RUN,
    "stop": _ASK_RUN,
    "check": Trust(_LAUNCH, writes="a cache in `~/.cache`; with `--fix`, the files"),
    "new": Trust(
        "your packages, and what you answer", starts="`git config`, for your name", writes="new files of a package"
    ),
    "new node": Trust(
        "packages, and the topics of the observed node",
        starts="the node, to observe it, unless `--no-look` is given",
        writes="new files of a package",
    ),
    "new base": Trust(
        "with `--from`, a description and the meshes that it names",
        starts="with `--from FILE.xacro`, xacro, in a process that can only compute",
        writes="new files of a package",
    ),
    "get": Trust(
        "launch files, manifests and scripts of a folder, as text; the indexes of ROS",
        starts="`git ls-remote`, `apt-get` and pip, after a question each",
        sends="names of missing packages and owners, to GitHub, GitLab, Bitbucket, after a question; requests for "
        "indexes and packages, to their servers",
        writes="packages, and a record for `--undo`",
    ),
    "package": Trust(_LAUNCH, writes="with `--write`, package.xml and CMakeLists.txt"),
    "format": Trust(_LAUNCH, writes="the files, unless `--check` or `--diff` is given"),
    "find": Trust(_LAUNCH),
    "docs": Trust(_LAUNCH, writes="the documents"),
    "graph": Trust(
        _LAUNCH, sends="without FILE, questions to the ROS master and its nodes", writes="with `--output`, a file"
    ),
    "explain": Trust(_LAUNCH),
    "maps": Trust("map files and pictures", writes="maps in `~/.local/share/ubiquity_launches/maps`"),
    "maps copy": Trust(
        "an archive from the robot, within limits", sends=f"the map, to {_ROBOT}", writes="a map, here or there"
    ),
    "use": Trust(
        "records of robots",
        sends="for a robot that is not known yet, a question for its address, to the network",
        writes="the selection",
    ),
    "setup": Trust(
        "your shells' files, ssh keys, the system's packages",
        starts="`apt-get`, `usermod` and others by `sudo`, after a question",
        sends="requests for packages, to their servers",
        writes="a block in your shells' files, an ssh key, a workspace",
    ),
    "robots": Trust(
        "announcements of the network, answers of robots",
        sends="zeroconf questions, to the network; a connection to ports 22 and 11311 of each robot found; a login by "
        "key, where the host key is known",
        writes="where each robot was seen",
    ),
    "shell": Trust("your input", starts="what you type, on the robot", sends=f"your input, to {_ROBOT}"),
    "x": Trust(
        "your input",
        starts="the program, on the robot; it draws here, and may read what your screen shows and what you type (X11)",
        sends=f"the command, to {_ROBOT}",
    ),
    "sync": Trust(
        "the workspaces of both computers",
        sends=f"files of your workspace, to {_ROBOT}",
        writes="files of both workspaces, after a question",
    ),
    "build": Trust(
        "the workspace",
        starts="`catkin_make` or `catkin build`, and with it scripts of every package in the workspace",
        sends=f"with ROBOT, the command, to {_ROBOT}",
        writes="the workspace",
    ),
    "mount": Trust("files of the robot", starts="`sshfs`", sends=f"file operations, to {_ROBOT}", writes="a folder"),
    "unmount": Trust("the list of mounts", starts="`fusermount`"),
    "doctor": Trust(
        "settings of both computers, answers of the robot",
        starts="scripts that inspect, here and on the robot; with `--fix`, commands that are marked safe",
        sends=f"scripts, to {_ROBOT}; a connection to the ROS master",
    ),
    "devices": Trust(
        "`/sys` and `/dev`; with `--probe`, answers of devices",
        sends=f"with `--robot`, a script, to {_ROBOT}; with `--probe`, questions to free ports",
    ),
    "wifi": Trust(
        "wireless statistics", starts="`ping`", sends=f"pings, and a script, to {_ROBOT}", writes="with `--log`, a file"
    ),
    "robot": Trust(
        "answers of the robot",
        starts="scripts on the robot, as root after its password",
        sends=f"settings, to {_ROBOT}",
        writes="settings of the robot; records of it here",
    ),
    "robot setup": Trust(
        "answers of the robot",
        starts="scripts on the robot, as root after its password; ROS's packages there",
        sends="before the host key is known or confirmed: the user name; then your public key, files, the present and "
        "the new password, by ssh",
        writes="settings of the robot; its record and host key here",
    ),
    "image": Trust(
        "an image, as its partitions and file systems",
        writes="an image that only you can read, or a device after a question; the robot's record and host key",
    ),
    "boot": Trust(
        "answers of the robot",
        starts="the program at each boot, as the robot's user",
        sends=f"unit files, to {_ROBOT}",
        writes="services of the robot",
    ),
    "completion": Trust("the name of your shell"),
    "debian": Trust(
        "the Debian root",
        starts="programs of the Debian root; `install`, `update` and `remove` by `sudo`",
        sends="requests for packages, to their servers",
        writes="the Debian root",
    ),
    "env": Trust("the selection"),
}
