"""Verbs that find, set up and inspect robots, and that work on them over the network."""

from ur.cli.verbs.verb import SSH, Below, Trust, Verb

_SECTION = "Robots"
_ROBOT = "A robot's name, HOST or USER@HOST; the selected robot unless given."

ROBOTS = (
    Verb(
        "robots",
        "ur.cli.robots.robots",
        "List the robots on the network, and those known but away.",
        _SECTION,
        arguments=("robot", "..."),
        descriptions=("Names of robots; all of them unless given.",),
        examples=(
            ("ur robots", "List the robots."),
            ("ur robots bob eve", "List these two as soon as they have answered."),
        ),
        trust=Trust(
            "announcements of the network, answers of robots",
            sends="zeroconf questions, to the network; a connection to ports 22 and 11311 of each robot found; a "
            "login by key, where the host key is known",
            writes="where each robot was seen",
        ),
    ),
    Verb(
        "robot",
        "ur.cli.robot_setup.robot",
        "Set robots up and change them, over the network.",
        _SECTION,
        arguments=("robot command", "robot", "..."),
        examples=(
            ("ur robot setup ubuntu@ubuntu.local", "Set a freshly flashed robot up."),
            ("ur robot wifi bob", "Show the wireless networks of a robot."),
        ),
        trust=Trust(
            "answers of the robot",
            starts="scripts on the robot, as root after its password",
            sends=f"settings, to {SSH}",
            writes="settings of the robot; records of it here",
        ),
        below={
            "setup": Below(
                descriptions=("Robots as they answer now; found on the network unless given.",),
                examples=(
                    ("ur robot setup ubuntu@ubuntu.local --name bob --base magni", "Set one robot up."),
                    ("ur robot setup --from robots.yaml", "Set up every robot that a file names."),
                ),
                trust=Trust(
                    "answers of the robot",
                    starts="scripts on the robot, as root after its password; ROS's packages there",
                    sends="before the host key is known or confirmed: the user name; then your public key, files, the "
                    "present and the new password, by ssh",
                    writes="settings of the robot; its record and host key here",
                ),
            ),
            "rename": Below(
                descriptions=("The robot's present name.", "Its new name."),
                examples=(
                    ("ur robot rename bob alice", "Rename a robot."),
                    ("ur robot rename bob alice --dry-run", "Show what that would change."),
                ),
            ),
            "wifi": Below(
                descriptions=(_ROBOT,),
                examples=(
                    ("ur robot wifi bob", "Show the wireless networks of a robot."),
                    ("ur robot wifi bob --ssid Lab", "Join a network."),
                ),
            ),
            "network": Below(
                descriptions=(_ROBOT,),
                examples=(
                    ("ur robot network bob", "Show the network devices of a robot."),
                    ("ur robot network bob --address 192.168.1.7/24", "Give it a fixed address."),
                ),
            ),
            "calibrate": Below(
                descriptions=(_ROBOT,),
                examples=(
                    ("ur robot calibrate bob", "Correct the yaw of a robot's lidar and its wheels."),
                    ("ur robot calibrate bob --dry-run", "Show what its driving has shown."),
                ),
            ),
        },
    ),
    Verb(
        "image",
        "ur.cli.robot_setup.image",
        "Prepare images for the first boot of robots.",
        _SECTION,
        arguments=("image command", "files"),
        examples=(
            ("ur image prepare ubuntu.img --name bob", "Prepare an image file."),
            ("ur help image prepare", "Describe every option."),
        ),
        trust=Trust(
            "an image, as its partitions and file systems",
            writes="an image that only you can read, or a device after a question; the robot's record and host key",
        ),
        below={
            "prepare": Below(
                descriptions=("An image file, or the device of a flashed card.",),
                examples=(
                    ("ur image prepare ubuntu.img.xz --output bob.img --name bob", "Prepare a compressed image."),
                    ("ur image prepare /dev/sdb --name bob --ssid Lab", "Prepare a card that is flashed already."),
                ),
            )
        },
    ),
    Verb(
        "doctor",
        "ur.cli.computer.doctor",
        "Find problems of this computer, of a robot and of their connection.",
        _SECTION,
        arguments=("robot", "..."),
        descriptions=("Robots: names, HOST or USER@HOST; the selected robot unless given.",),
        examples=(
            ("ur doctor", "Check the selected robot and this computer."),
            ("ur doctor bob eve", "Check two other robots, in parallel."),
            ("ur doctor --all", "Check every robot that was set up from this computer."),
            ("ur doctor bob --wireless", "Measure the connection: signal of both, latency, loss."),
        ),
        trust=Trust(
            "settings of both computers, answers of the robot",
            starts="scripts that inspect, here and on the robot; with `--fix`, commands that are marked safe; `ping`",
            sends=f"scripts, to {SSH}; a connection to the ROS master; with `--wireless`, pings",
            writes="with `--log`, a file",
        ),
    ),
    Verb(
        "devices",
        "ur.cli.robots.devices",
        "List the devices of this computer or a robot.",
        _SECTION,
        examples=(
            ("ur devices", "List what is plugged into this computer."),
            ("ur devices --robot bob", "List the robot's, and what its base lacks."),
        ),
        trust=Trust("`/sys` and `/dev`", sends=f"with `--robot`, a script, to {SSH}"),
    ),
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
