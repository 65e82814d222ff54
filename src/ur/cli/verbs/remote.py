"""Verbs that work on robots over the network."""

from __future__ import annotations

from ur.cli.verbs.verb import SSH, Below, Trust, Verb

_SECTION = "Robots"
_ROBOT = "A robot's name, HOST or USER@HOST; the selected robot unless given."

REMOTE = (
    Verb(
        "shell",
        "ur.cli.robots.shell",
        "Open a shell on a robot, or run one command there.",
        _SECTION,
        arguments=("robot",),
        descriptions=(_ROBOT, "A command to run there; a shell is opened unless given."),
        examples=(
            ("ur shell bob", "Open a shell on a robot."),
            ("ur shell bob rosnode list", "Run one command there."),
            ("ur shell -X bob xterm", "Open a window of a robot here."),
        ),
        trust=Trust(
            "your input",
            starts="what you type, on the robot; with `-X` it draws here, and may read what your screen shows and what "
            "you type (X11)",
            sends=f"your input, to {SSH}",
        ),
    ),
    Verb(
        "boot",
        "ur.cli.robots.boot",
        "Choose what a robot starts when it boots.",
        _SECTION,
        arguments=("boot command", "program"),
        examples=(
            ("ur boot install robot_base", "Start a program whenever the selected robot boots."),
            ("ur boot status --robot bob", "Show what a robot starts."),
        ),
        trust=Trust(
            "answers of the robot",
            starts="the program at each boot, as the robot's user",
            sends=f"unit files, to {SSH}",
            writes="services of the robot",
        ),
        below={
            "install": Below(
                descriptions=(
                    "A package and a launch file of it, a program, or a command; then arguments NAME:=VALUE.",
                ),
                examples=(
                    ("ur boot install robot_base", "Start a program."),
                    (
                        "ur boot install --robot bob my_robot m_wander.launch.xml",
                        "Start a launch file on another robot.",
                    ),
                    ("ur boot install web", "Serve the page, and print a link to it."),
                ),
            ),
            "status": Below(
                examples=(
                    ("ur boot status", "Show what the selected robot starts."),
                    ("ur boot status --all", "Show what every robot starts that was set up from here."),
                )
            ),
            "link": Below(
                examples=(
                    ("ur boot link --robot bob", "Print a link to the page of bob, and its QR code."),
                    ("ur boot link --look", "Print one that allows watching but not driving."),
                )
            ),
            "log": Below(
                descriptions=("A boot service, as 'ur boot status' shows it.",),
                examples=(
                    ("ur boot log robot_base", "Print its last lines."),
                    ("ur boot log robot_base --follow", "Print what follows as well."),
                ),
            ),
            "remove": Below(
                descriptions=("Boot services, as 'ur boot status' shows them; all of them unless given.",),
                examples=(
                    ("ur boot remove robot_base", "Remove one boot service."),
                    ("ur boot remove --robot bob", "Remove all of a robot."),
                ),
            ),
        },
    ),
    Verb(
        "sync",
        "ur.cli.workspace.sync",
        "Synchronise the workspaces of this computer and robots.",
        _SECTION,
        arguments=("robot", "files", "..."),
        descriptions=(
            "A robot's name, HOST or USER@HOST, or several joined by commas; the selected robot unless given.",
            "Files and folders of the workspace; everything unless given.",
        ),
        examples=(
            ("ur sync bob --dry-run", "Show what would be copied."),
            ("ur sync bob", "Copy in both directions."),
            ("ur sync bob,eve --to my_package", "Bring a package to two robots."),
        ),
        trust=Trust(
            "the workspaces of both computers",
            sends=f"files of your workspace, to {SSH}",
            writes="files of both workspaces, after a question",
        ),
    ),
    Verb(
        "build",
        "ur.cli.workspace.build",
        "Build the catkin workspace here or on robots.",
        _SECTION,
        arguments=("robot", "..."),
        descriptions=("Robots: names, HOST or USER@HOST; this computer unless given.",),
        examples=(
            ("ur build", "Build the workspace of this computer."),
            ("ur build bob -j 2", "Build that of a robot."),
            ("ur build bob eve", "Build those of two robots, in parallel."),
        ),
        trust=Trust(
            "the workspace",
            starts="`catkin_make` or `catkin build`, and with it scripts of every package in the workspace",
            sends=f"with ROBOT, the command, to {SSH}",
            writes="the workspace",
        ),
    ),
    Verb(
        "mount",
        "ur.cli.workspace.mount",
        "Mount a folder of a robot here, or unmount it.",
        _SECTION,
        arguments=("robot",),
        descriptions=(_ROBOT,),
        examples=(
            ("ur mount bob", "Mount a robot's workspace at ~/robots/bob."),
            ("ur mount bob --at /tmp/bob", "Mount it at another path."),
            ("ur mount bob --undo", "Unmount all of its folders, also when it is off."),
        ),
        trust=Trust(
            "files of the robot", starts="`sshfs`, `fusermount`", sends=f"file operations, to {SSH}", writes="a folder"
        ),
    ),
)
