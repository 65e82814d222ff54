"""Verbs that set this computer up."""

from ur.cli.verbs.verb import PLUMBING, Below, Trust, Verb

_SECTION = "This computer"


COMPUTER = (
    Verb(
        "setup",
        "ur.cli.computer.set_up",
        "Set this computer up: shells, keys, workspace, names.",
        _SECTION,
        examples=(("ur setup", "Set this computer up."), ("ur setup --dry-run", "Show what that would change.")),
        trust=Trust(
            "your shells' files, ssh keys, the system's packages",
            starts="`apt-get`, `usermod` and others by `sudo`, after a question",
            sends="requests for packages, to their servers",
            writes="a block in your shells' files, an ssh key, a workspace",
        ),
        arguments=("setup command",),
        below={
            "debian": Below(
                descriptions=(
                    "status: its location and size; shell: open a shell in it; install: add packages; update: install "
                    "newer versions; remove: delete it.",
                    "Of shell: a program with its arguments; of install: names of packages of Debian 13.",
                ),
                examples=(
                    ("ur setup debian", "Print the location and size of the root."),
                    ("ur setup debian shell rosbag info drive.bag", "Run one command there."),
                    ("ur setup debian install gdb", "Install a debugger in the root."),
                    ("ur setup debian remove", "Delete it."),
                ),
                trust=Trust(
                    "the Debian root",
                    starts="programs of the Debian root; `install`, `update` and `remove` by `sudo`",
                    sends="requests for packages, to their servers",
                    writes="the Debian root",
                ),
            )
        },
    ),
    Verb(
        "get",
        "ur.cli.files.get",
        "Install what launch files need.",
        _SECTION,
        arguments=("files", "..."),
        descriptions=(
            "Launch files, packages, or folders with launch files (a path with a /), and arguments of a launch file.",
        ),
        examples=(
            ("ur get my_robot bringup.launch", "Install what a launch file needs."),
            ("ur get xacro --yes", "Install a package without a question."),
            ("ur get --missing --dry-run", "Show what the workspace needs."),
        ),
        trust=Trust(
            "launch files and manifests of a folder, as text; the indexes of ROS",
            starts="`apt-get` and pip, after a question each",
            sends="requests for indexes and packages, to their servers",
            writes="packages",
        ),
    ),
    Verb(
        "completion",
        "ur.cli.computer.completion",
        "Print the lines that let a shell complete `ur` with Tab.",
        PLUMBING,
        arguments=("shell",),
        descriptions=("bash, zsh or fish; this user's shell unless given.",),
        examples=(
            ('eval "$(ur completion bash)"', "Complete in this shell."),
            ("ur completion fish", "Print the lines for another shell."),
        ),
        trust=Trust("the name of your shell"),
        needs_ros=False,
    ),
    Verb(
        "env",
        "ur.cli.computer.env",
        "Print the lines that let a shell follow the selection.",
        PLUMBING,
        examples=(
            ('eval "$(ur env)"', "Make this shell follow the selection."),
            ("ur env", "Print what that sets."),
            ('eval "$(ur env --graph)"', "Let RViz 2 of this computer see the nodes of a robot with ROS 2."),
        ),
        trust=Trust("the selection, /etc/ubiquity/robot.yaml of the robot", starts="ssh"),
        needs_ros=False,
    ),
)
